// Feeds any bytes to the reader of Stage worlds. Includes find a few files in memory; no file is read.
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>

#include "common/worldfile/build/build_world.h"
#include "common/worldfile/stage/stage_parser.h"

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
void CheckMessage(const troupe::SourceLocation& where, const std::string& message) {
  if (message.empty() || where.file.empty() || where.line < 1 || where.column < 1) __builtin_trap();
  if (message.find('\n') != std::string::npos) __builtin_trap();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  troupe::ParseOptions parse;
  parse.memory_files = &MemoryFiles();
  parse.max_items = 500;
  const troupe::Result<troupe::WorldTree> tree = troupe::ParseStageText(text, "w.world", parse);
  if (!tree.ok()) {
    CheckMessage(tree.error().where, tree.error().message);
    return 0;
  }
  troupe::BuildOptions build;
  build.without_bitmaps = true;
  const troupe::Result<troupe::LoadedWorld> loaded = troupe::BuildWorld(tree.value(), {}, build);
  if (!loaded.ok()) {
    CheckMessage(loaded.error().where, loaded.error().message);
    return 0;
  }
  for (const troupe::Warning& warning : loaded.value().warnings) CheckMessage(warning.where, warning.message);
  if (!troupe::Validate(loaded.value().world).ok()) __builtin_trap();  // a loaded world is valid
  return 0;
}
