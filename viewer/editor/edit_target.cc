#include "viewer/editor/edit_target.h"

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string_view>
#include <utility>

#include "common/base/json_tree.h"
#include "common/base/source_text.h"
#include "worldfile/load_world.h"
#include "worldfile/text/text_file.h"

namespace troupe {
namespace {

namespace fs = std::filesystem;

// hotel.building.yaml: hotel.json; hall.lif.json: hall.json; hall.json, a layout: hall.scenario.json.
std::string ScenarioBeside(const std::string& path) {
  std::string bare = fs::path(path).replace_extension().string();
  for (const char* const ending : {".building", ".lif"}) {
    if (bare.ends_with(ending)) bare.resize(bare.size() - std::string_view(ending).size());
  }
  const std::string beside = bare + ".json";
  return beside != path ? beside : bare + ".scenario.json";
}

// Whether the text of a scenario names the file as its world.
bool IsScenarioOf(const std::string& world, const std::string& text, const std::string& path) {
  const Result<JsonTree> read = JsonTree::Parse(text, path);
  if (!read.ok()) return false;
  const JsonNode* const named = read.value().root().Find("world");
  std::error_code ignored;
  return named != nullptr && fs::equivalent(FindFile(named->text, DirectoryOf(path), path), world, ignored);
}

}  // namespace

Result<EditTarget> TargetOf(const std::string& path) {
  const std::string ending = fs::path(path).extension().string();
  if (ending == ".inc") return EditTarget{path, EditedKind::kInclude, ""};
  if (!fs::exists(path) || !IsForeignWorld(path)) {
    if (ending == ".world") return EditTarget{path, EditedKind::kWorld, ""};
    if (ending == ".json") return EditTarget{path, EditedKind::kScenario, "{\n}\n"};
    return Error{{path},
                 "found " + std::string(fs::exists(path) ? "a file ending in " + Quoted(ending) : "no such file") +
                     ", expected a world, .inc (models) or .json (scenario); .world, .inc and .json may be new"};
  }
  const std::string beside = ScenarioBeside(path);
  if (fs::exists(beside)) {
    const Result<std::string> text = ReadTextFile(beside, {path});
    if (!text.ok()) return text.error();
    if (!IsScenarioOf(path, text.value(), beside)) {
      return Error{{beside},
                   "found a file that is no scenario of " + QuotedPath(path) +
                       ", expected one to keep its edits; name another scenario with that \"world\""};
    }
  }
  const nlohmann::json world = fs::path(path).filename().string();
  return EditTarget{beside, EditedKind::kScenario, "{\n  \"world\": " + world.dump() + "\n}\n"};
}

}  // namespace troupe
