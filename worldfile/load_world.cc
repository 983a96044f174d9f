#include "worldfile/load_world.h"

#include <filesystem>
#include <string>

#include "worldfile/map/map_yaml.h"
#include "worldfile/models/build_world.h"
#include "worldfile/models/start_overlap.h"
#include "worldfile/scenario/scenario.h"
#include "worldfile/stage/stage_world.h"
#include "worldfile/text/quote.h"

namespace troupe {
namespace {

Result<LoadedWorld> LoadStageWorld(const std::string& path, const LoadOverrides& overrides) {
  const Result<WorldTree> tree = ParseStageWorld(path, overrides.allowed);
  if (!tree.ok()) return tree.error();
  return BuildWorld(tree.value(), overrides);
}

Result<LoadedWorld> LoadByEnding(const std::string& path, const LoadOverrides& overrides) {
  const std::string ending = std::filesystem::path(path).extension().string();
  if (ending == ".world") return LoadStageWorld(path, overrides);
  if (ending == ".json") return LoadScenario(path, overrides);
  if (ending == ".yaml" || ending == ".yml") return BuildWorld(MapYamlTree(path), overrides);
  return Error{
      {path},
      "found a file ending in " + Quoted(ending) + ", expected .world (Stage), .json (scenario) or .yaml (ROS map)"};
}

}  // namespace

Result<LoadedWorld> LoadWorld(const std::string& path, const LoadOverrides& overrides) {
  Result<LoadedWorld> loaded = LoadByEnding(path, overrides);
  if (loaded.ok()) {
    for (const std::string& message : FindStartOverlaps(loaded.value().world)) {
      loaded.value().warnings.push_back({{path}, message});
    }
  }
  return loaded;
}

}  // namespace troupe
