#include "common/worldfile/load_world.h"

#include <filesystem>

#include "common/worldfile/build_world.h"
#include "common/worldfile/map_yaml.h"
#include "common/worldfile/quote.h"
#include "common/worldfile/scenario.h"
#include "common/worldfile/stage_parser.h"

namespace troupe {
namespace {

Result<LoadedWorld> LoadStageWorld(const std::string& path, const LoadOverrides& overrides) {
  const Result<WorldTree> tree = ParseStageWorld(path);
  if (!tree.ok()) return tree.error();
  return BuildWorld(tree.value(), overrides);
}

}  // namespace

Result<LoadedWorld> LoadWorld(const std::string& path, const LoadOverrides& overrides) {
  const std::string ending = std::filesystem::path(path).extension().string();
  if (ending == ".world") return LoadStageWorld(path, overrides);
  if (ending == ".json") return LoadScenario(path, overrides);
  if (ending == ".yaml" || ending == ".yml") return LoadMapYaml(path, overrides);
  return Error{
      {path},
      "found a file ending in " + Quoted(ending) + ", expected .world (Stage), .json (scenario) or .yaml (ROS map)"};
}

}  // namespace troupe
