#include "worldfile/models/types/stage_controllers.h"

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <sstream>

#include "worldfile/text/quote.h"

namespace troupe {
namespace {

using Json = nlohmann::json;

struct KnownController {
  const char* stage_name;
  const char* name;
  std::vector<const char*> arguments;  // parameters, in order
};

const std::vector<KnownController>& KnownControllers() {
  static const std::vector<KnownController> known = {
      {"dynamic", "dynamic", {"distance", "speed"}},
      {"expand", "expand", {"speed"}},
      {"expand_pioneer", "expand", {"speed"}},
      {"expand_swarm", "expand", {"speed"}},
      {"fasr", "fasr", {"source", "sink"}},
      {"fasr2", "fasr2", {"source", "sink"}},
      {"fasr_plan", "fasr_plan", {"source", "sink"}},
      {"fetch", "fetch", {}},
      {"flock", "flock", {"distance", "speed"}},
      {"follow", "follow", {"id", "distance"}},
      {"go_to", "go_to", {}},
      {"idle", "idle", {}},
      {"lasernoise", "lasernoise", {"samples"}},
      {"patrol", "patrol", {}},
      {"pioneer_flocking", "pioneer_flocking", {"distance", "speed"}},
      {"rasterize", "rasterize", {"cell", "map_size"}},
      {"script", "script", {}},
      {"sink", "sink", {"interval", "capacity"}},
      {"source", "source", {"interval", "capacity"}},
      {"wander", "wander", {"speed", "min_distance"}},
  };
  return known;
}

constexpr std::size_t kDeepest = 8;  // nesting of lists; they are written by recursion

// A JSON value, or nothing. Words that are no JSON are texts.
std::optional<Json> ParseValue(const std::string& text) {
  if (text.empty()) return std::nullopt;
  std::size_t depth = 0;
  for (const char c : text) {
    if (c == '[' || c == '{') ++depth;
    if ((c == ']' || c == '}') && depth > 0) --depth;
    if (depth > kDeepest) return std::nullopt;
  }
  const Json value = Json::parse(text, nullptr, false);
  if (!value.is_discarded()) return value;
  const bool opens = text.front() == '[' || text.front() == '{' || text.front() == '"';
  return opens ? std::nullopt : std::optional<Json>(text);
}

}  // namespace

Result<std::optional<StageController>> ReadStageController(const std::string& text) {
  std::istringstream words(text);
  std::string name;
  words >> name;
  const std::vector<KnownController>& known = KnownControllers();
  const auto found =
      std::find_if(known.begin(), known.end(), [&](const KnownController& entry) { return name == entry.stage_name; });
  if (found == known.end()) return std::optional<StageController>();
  StageController controller;
  Json parameters = Json::object();
  std::size_t positional = 0;
  for (std::string word; words >> word;) {
    const std::size_t equal = word.find('=');
    std::string key;
    if (equal != std::string::npos) {
      key = word.substr(0, equal);
    } else if (positional < found->arguments.size()) {
      key = found->arguments[positional++];
    } else {
      controller.warnings.push_back("argument " + Quoted(word) + " of controller " + Quoted(name) + " is ignored");
      continue;
    }
    const std::optional<Json> value = ParseValue(equal != std::string::npos ? word.substr(equal + 1) : word);
    if (!value || key.empty()) {
      return Error{{},
                   "found argument " + Quoted(word) + " of controller " + Quoted(name) +
                       ", expected a number, a text or a list without blanks, or parameter=value"};
    }
    parameters[key] = *value;
  }
  controller.description = {found->name, parameters.dump()};
  return std::optional<StageController>(std::move(controller));
}

void AddPlaces(const WorldDescription& world, const Pose& X_EW, ControllerDescription& controller) {
  if (controller.name != "fasr" && controller.name != "fasr2" && controller.name != "fasr_plan") return;
  Json parameters = Json::parse(controller.parameters, nullptr, false);
  if (!parameters.is_object() || parameters.contains("tasks")) return;
  bool changed = false;
  for (const char* place : {"source", "sink"}) {
    const auto model = std::find_if(world.models.begin(), world.models.end(),
                                    [&](const ModelDescription& candidate) { return candidate.name == place; });
    if (parameters.contains(place) || model == world.models.end() || model->parent) continue;
    const Vec2 point = Transform2(X_EW) * model->X_PM.translation();
    parameters[place] = {point.x(), point.y()};
    changed = true;
  }
  if (changed) controller.parameters = parameters.dump();
}

}  // namespace troupe
