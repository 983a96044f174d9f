// Feeds any bytes to the reader of Stage worlds. Includes find a few files in memory; no file is read.
#include <map>
#include <string>

#include "fuzz/check.h"
#include "fuzz/targets.h"
#include "worldfile/models/build_world.h"
#include "worldfile/stage/stage_world.h"

namespace troupe::fuzz {
namespace {

const std::map<std::string, std::string>& MemoryFiles() {
  static const auto* const files = new std::map<std::string, std::string>{
      {"a.inc", "define bot position( eye( ) )\ndefine eye ranger( sensor( samples 3 ) )\n"},
      {"b.inc", "include \"a.inc\"\ncolor \"blue\""},
      {"c.inc", "include \"c.inc\"\n"},
      {"d.inc", "model(\n"},
  };
  return *files;
}

// Every message to a user has a text, of one line, and a place.
void CheckMessage(const SourceLocation& where, const std::string& message) {
  Check(!message.empty() && !where.file.empty() && where.line >= 1 && where.column >= 1);
  Check(message.find('\n') == std::string::npos);
}

}  // namespace

void World(Bytes bytes) {
  ParseOptions parse;
  parse.memory_files = &MemoryFiles();
  parse.max_items = 500;
  const Result<WorldTree> tree = ParseStageText(TextOf(bytes), "w.world", parse);
  if (!tree.ok()) return CheckMessage(tree.error().where, tree.error().message);
  BuildOptions build;
  build.without_bitmaps = true;
  const Result<LoadedWorld> loaded = BuildWorld(tree.value(), {}, build);
  if (!loaded.ok()) return CheckMessage(loaded.error().where, loaded.error().message);
  for (const Warning& warning : loaded.value().warnings) CheckMessage(warning.where, warning.message);
  Check(Validate(loaded.value().world).ok());  // a loaded world is valid
}

}  // namespace troupe::fuzz
