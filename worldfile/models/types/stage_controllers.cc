#include "worldfile/models/types/stage_controllers.h"

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <sstream>
#include <utility>
#include <vector>

#include "worldfile/text/number_text.h"
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

// A JSON value, or nothing. Words that are no JSON are texts, but for numbers such as .5 and +1.
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
  const std::optional<LeadingNumber> number = ReadLeadingNumber(text);
  if (number && number->is_all) return Json(number->value);
  const bool opens = text.front() == '[' || text.front() == '{' || text.front() == '"';
  return opens ? std::nullopt : std::optional<Json>(text);
}

struct Argument {
  std::string word;  // as written
  std::string key;   // the parameter that it is
  bool is_named = false;
  Json value;
};

// The words that can be arguments; a warning for each of the others.
std::vector<Argument> ReadArguments(std::istringstream& words, const KnownController& known,
                                    std::vector<std::string>& warnings) {
  std::vector<Argument> arguments;
  std::size_t positional = 0;
  for (std::string word; words >> word;) {
    const std::size_t equal = word.find('=');
    Argument argument{word, "", equal != std::string::npos, {}};
    const std::string ignored =
        "argument " + Quoted(word) + " of controller " + Quoted(known.stage_name) + " is ignored";
    if (argument.is_named) {
      argument.key = word.substr(0, equal);
    } else if (positional < known.arguments.size()) {
      argument.key = known.arguments[positional++];
    } else {
      warnings.push_back(ignored);
      continue;
    }
    std::optional<Json> value = ParseValue(argument.is_named ? word.substr(equal + 1) : word);
    if (value && !argument.key.empty()) {
      argument.value = std::move(*value);
      arguments.push_back(std::move(argument));
    } else {
      warnings.push_back(ignored + ", expected a number, a text or a list without blanks, or parameter=value");
    }
  }
  return arguments;
}

std::string ParametersOf(const std::vector<Argument>& arguments) {
  Json parameters = Json::object();
  for (const Argument& argument : arguments) parameters[argument.key] = argument.value;
  return parameters.dump(-1, ' ', false, Json::error_handler_t::replace);
}

// Leaves out arguments until the check finds no fault, if it ever does; the others stay.
class ArgumentFilter {
 public:
  ArgumentFilter(const KnownController& known, const ControllerCheck& check, std::vector<std::string>& warnings)
      : known_(known), check_(check), warnings_(warnings) {}

  // Nothing if the controller cannot be used.
  std::optional<std::vector<Argument>> Filter(const std::vector<Argument>& arguments) {
    const Status fault = Check(arguments);
    if (fault.ok()) return arguments;
    for (std::size_t i = 0; i < arguments.size(); ++i) {  // one that spoils the others
      std::vector<Argument> others = arguments;
      others.erase(others.begin() + static_cast<std::ptrdiff_t>(i));
      if (!Check(others).ok()) continue;
      Warn(arguments[i], fault);
      return others;
    }
    if (!Check({}).ok()) {
      warnings_.push_back("controller " + Quoted(known_.stage_name) + " cannot be used, so the robot has none (" +
                          fault.error().message + ")");
      return std::nullopt;
    }
    std::vector<Argument> kept;
    for (const Argument& argument : arguments) {
      kept.push_back(argument);
      const Status wrong = Check(kept);
      if (wrong.ok()) continue;
      kept.pop_back();
      Warn(argument, wrong);
    }
    return kept;
  }

 private:
  Status Check(const std::vector<Argument>& arguments) const { return check_(known_.name, ParametersOf(arguments)); }
  void Warn(const Argument& argument, const Status& fault) {
    warnings_.push_back(
        "argument " + Quoted(argument.word) + " of controller " + Quoted(known_.stage_name) + " is ignored: " +
        (argument.is_named ? "" : "it would be parameter " + Quoted(argument.key) + ", but ") + fault.error().message);
  }

  const KnownController& known_;
  const ControllerCheck& check_;
  std::vector<std::string>& warnings_;
};

}  // namespace

std::optional<StageController> ReadStageController(const std::string& text, const ControllerCheck& check) {
  std::istringstream words(text);
  std::string name;
  words >> name;
  const std::vector<KnownController>& known = KnownControllers();
  const auto found =
      std::find_if(known.begin(), known.end(), [&](const KnownController& entry) { return name == entry.stage_name; });
  if (found == known.end()) return std::nullopt;
  StageController controller;
  std::optional<std::vector<Argument>> arguments = ReadArguments(words, *found, controller.warnings);
  if (check) arguments = ArgumentFilter(*found, check, controller.warnings).Filter(*arguments);
  if (arguments) controller.description = {found->name, ParametersOf(*arguments)};
  return controller;
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
