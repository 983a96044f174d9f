// `position`: a robot, with drive, localization and controller.
#include "worldfile/models/types/position_type.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>
#include <utility>
#include <vector>

#include "troupe/random.h"
#include "worldfile/models/types/model_types.h"
#include "worldfile/text/text_file.h"

namespace troupe {
namespace {

// [xmin xmax ymin ymax zmin zmax amin amax]; z is never moved.
TwistBounds ReadBounds(PropertyReader& reader, std::string_view name) {
  const Units& units = reader.units();
  TwistBounds bounds{{-1.0, 1.0}, {-1.0, 1.0}, {-0.5 * kPi, 0.5 * kPi}};
  const auto n = reader.Numbers(name, 8);
  if (!n) return bounds;
  bounds.x = {(*n)[0] * units.length, (*n)[1] * units.length};
  bounds.y = {(*n)[2] * units.length, (*n)[3] * units.length};
  bounds.heading = {units.Angle((*n)[6]), units.Angle((*n)[7])};
  for (Interval* const interval : {&bounds.x, &bounds.y, &bounds.heading}) {
    if (interval->min <= 0.0 && interval->max >= 0.0) continue;
    if (interval->min > interval->max) std::swap(interval->min, interval->max);
    // A robot must be able to stand: every bound includes 0, or a stop would be impossible.
    *interval = {std::min(interval->min, 0.0), std::max(interval->max, 0.0)};
    reader.diagnostics().Warn(
        reader.Where(name),
        "found bounds in " + Quoted(name) +
            " that leave out 0, expected min <= 0 <= max for each pair; they are exchanged or extended");
  }
  return bounds;
}

DriveDescription ReadDrive(PropertyReader& reader) {
  DriveDescription drive;
  drive.type = reader.Choice<DriveType>("drive");
  constexpr double kMinLength = 1e-6;  // m
  const double wheelbase = reader.Length("wheelbase", 1.0);
  drive.wheelbase = std::fabs(wheelbase) > kMinLength ? std::fabs(wheelbase) : 1.0;
  if (drive.wheelbase != wheelbase) {
    reader.WarnOfValue(*reader.Use("wheelbase"), NumberText(wheelbase) + " m", "more than 0",
                       NumberText(drive.wheelbase) + " m");
  }
  drive.velocity = ReadBounds(reader, "velocity_bounds");
  drive.acceleration = ReadBounds(reader, "acceleration_bounds");
  return drive;
}

// `X_WR`: the robot at load; `robot` and `seed` pick its random numbers.
LocalizationDescription ReadLocalization(PropertyReader& reader, const Pose& X_WR, RobotId robot, std::uint64_t seed) {
  LocalizationDescription localization;
  localization.type = reader.Choice<LocalizationType>("localization");
  const std::optional<Pose> X_WO = reader.ReadPose("localization_origin");
  const auto error = reader.Numbers("odom_error", 4);
  if (localization.type == LocalizationType::kGps) {
    for (const char* name : {"localization_origin", "odom_error"}) {
      if (const Property* property = reader.node().Find(name)) {
        reader.diagnostics().Warn(property->where,
                                  "property " + Quoted(name) + " has no effect with localization \"gps\"");
      }
    }
    return localization;
  }
  localization.origin = X_WO ? Inverse(*X_WO) * X_WR : Pose{};
  // An odometry counts in the plane.
  localization.origin.z = 0.0;
  if (!IsWithinReach(localization.origin)) {
    reader.diagnostics().Fail(reader.Where("localization_origin"),
                              "found an origin beyond 1000 km from the robot, expected it nearer");
  }
  if (error) {
    localization.error_x = (*error)[0];
    localization.error_y = (*error)[1];
    localization.error_heading = (*error)[3];
    return localization;
  }
  // Stage's defaults: each robot has an error of its own, within half of these to both sides.
  const auto draw = [&](double spread, std::uint64_t axis) {
    constexpr std::uint64_t kStream = 0x6f646f6d;  // "odom"
    return spread * (RandomUniform({seed, kStream, robot.index(), axis}) - 0.5);
  };
  localization.error_x = draw(0.03, 0);
  localization.error_y = draw(0.03, 1);
  localization.error_heading = draw(0.05, 2);
  return localization;
}

// Robots made from one macro share their text.
const std::optional<StageController>& FindController(const std::string& text, BuildContext& context) {
  const auto [entry, is_new] = context.controllers.try_emplace(text);
  if (is_new) entry->second = ReadStageController(text, context.check_controller);
  return entry->second;
}

// The controller of the property `ctrl`; nothing if there is none, or none that is known and can be used.
std::optional<ControllerDescription> ReadController(PropertyReader& reader, BuildContext& context) {
  std::optional<ControllerDescription> controller;
  const SourceLocation& where = reader.Where("ctrl");
  for (const std::string& text : reader.Texts("ctrl")) {
    const std::string name = text.substr(0, text.find(' '));
    const std::optional<StageController>& read = FindController(text, context);
    if (!read) {
      reader.diagnostics().Warn(where, "controller " + Quoted(name) + " is not known; the robot has none");
    } else if (controller) {
      reader.diagnostics().Warn(where, "controller " + Quoted(name) + " is ignored: a robot has one controller");
    } else {
      for (const std::string& warning : read->warnings) reader.diagnostics().Warn(where, warning);
      controller = read->description;
    }
  }
  return controller;
}

class PositionReader : public ModelReader {
 public:
  void ReadProperties(PropertyReader& reader, ModelDraft& draft, BuildContext& context) override {
    if (draft.robot) {
      ReadPartOfRobot(reader, draft);
    } else {
      draft.robot = AddRobot(reader, draft, context);
    }
  }

  // A robot that carries units finds the models "source" and "sink" of its world, as in Stage.
  void Complete(BuildContext& context) override {
    if (body_ != nullptr) AddFrames(context.world);
    if (!own_) return;
    RobotDescription& robot = context.world.robots[own_->index()];
    const Pose X_WR = context.world.models[robot.root.index()].X_PM;
    const bool odometry = robot.localization.type == LocalizationType::kOdometry;
    const Pose X_EW = odometry ? robot.localization.origin * Inverse(X_WR) : Pose{};
    AddPlaces(context.world, X_EW, robot.controller);
  }

 private:
  // Checks the properties, which have no effect.
  static void ReadPartOfRobot(PropertyReader& reader, const ModelDraft& draft) {
    reader.diagnostics().Warn(draft.node.where,
                              "a 'position' on a robot moves with it; its own drive is not simulated");
    ReadDrive(reader);
    ReadLocalization(reader, draft.X_WM, *draft.robot, 0);
    reader.Use("ctrl");
  }

  RobotId AddRobot(PropertyReader& reader, const ModelDraft& draft, BuildContext& context) {
    std::vector<RobotDescription>& robots = context.world.robots;
    const RobotId id(robots.size());
    RobotDescription robot;
    robot.name = draft.model.name;
    robot.root = draft.id;
    robot.drive = ReadDrive(reader);
    robot.localization = ReadLocalization(reader, draft.model.X_PM, id, context.world.seed);
    if (draft.node.draft != nullptr) body_ = std::get_if<BodyDraft>(draft.node.draft.get());
    robot_ = id;
    if (const std::optional<ControllerDescription> controller = ReadController(reader, context)) {
      robot.controller = *controller;
      own_ = id;
    } else if (context.default_controller) {
      robot.controller.name = *context.default_controller;
    }
    robots.push_back(std::move(robot));
    return id;
  }

  // The frames of the robot's URDF or SDF, on its models.
  void AddFrames(WorldDescription& world) const {
    RobotDescription& robot = world.robots[robot_.index()];
    for (const BodyDraft::Frame& frame : body_->frames) {
      ModelId model = robot.root;
      for (std::size_t i = robot.root.index(); i < world.models.size() && !frame.part.empty(); ++i) {
        if (world.models[i].name == robot.name + "." + frame.part) model = ModelId(i);
      }
      robot.frames.push_back({frame.name, model, frame.X_MF, frame.roll, frame.pitch});
    }
  }

  std::optional<RobotId> own_;  // that has a controller of the file
  RobotId robot_;
  const BodyDraft* body_ = nullptr;  // of a robot of another format; the tree outlives the build
};

using Json = nlohmann::json;

const std::vector<StageControllerName>& KnownControllers() {
  static const std::vector<StageControllerName> known = {
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
      {"lanes", "lanes", {}, "places"},
      {"lasernoise", "lasernoise", {"samples"}},
      {"patrol", "patrol", {}},
      {"pioneer_flocking", "pioneer_flocking", {"distance", "speed"}},
      {"rasterize", "rasterize", {"cell", "map_size"}},
      {"script", "script", {}},
      {"sink", "sink", {"interval", "capacity"}},
      {"slotcar", "slotcar", {"speed", "turn_rate"}},
      {"source", "source", {"interval", "capacity"}},
      {"vda5050", "vda5050", {"serial_number", "manufacturer"}},
      {"wander", "wander", {"speed", "min_distance"}},
  };
  return known;
}

constexpr std::size_t kMaxDepth = 8;  // nesting of lists; they are written by recursion

// A JSON value, or nothing. Words that are no JSON are texts, but for numbers such as .5 and +1.
std::optional<Json> ParseValue(const std::string& text) {
  if (text.empty()) return std::nullopt;
  std::size_t depth = 0;
  for (const char c : text) {
    if (c == '[' || c == '{') ++depth;
    if ((c == ']' || c == '}') && depth > 0) --depth;
    if (depth > kMaxDepth) return std::nullopt;
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

// A further item of the argument that is a list of texts.
void AddToList(const char* key, const std::string& word, std::vector<Argument>& arguments) {
  const auto list = std::find_if(arguments.begin(), arguments.end(),
                                 [&](const Argument& argument) { return !argument.is_named && argument.key == key; });
  if (list == arguments.end()) {
    arguments.push_back({word, key, false, Json::array({word})});
  } else {
    list->word += " " + word;
    list->value.push_back(word);
  }
}

// The words that can be arguments; a warning for each of the others.
std::vector<Argument> ReadArguments(std::istringstream& words, const StageControllerName& known,
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
    } else if (known.rest != nullptr) {
      AddToList(known.rest, word, arguments);
      continue;
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
  ArgumentFilter(const StageControllerName& known, const ControllerCheck& check, std::vector<std::string>& warnings)
      : known_(known), check_(check), warnings_(warnings) {}

  // Nothing if the controller cannot be used.
  std::optional<std::vector<Argument>> Filter(const std::vector<Argument>& arguments) {
    const Status fault = Check(arguments);
    if (fault.ok()) return arguments;
    // Often one bad argument makes the check refuse all of them: the fewest are left out if it is found first.
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

  const StageControllerName& known_;
  const ControllerCheck& check_;
  std::vector<std::string>& warnings_;
};

}  // namespace

ModelType PositionType() {
  return {.name = "position", .has_drive = true, .make_reader = MakeReader<PositionReader>};
}

std::span<const StageControllerName> StageControllerNames() {
  return KnownControllers();
}

std::optional<StageController> ReadStageController(const std::string& text, const ControllerCheck& check) {
  std::istringstream words(text);
  std::string name;
  words >> name;
  const std::vector<StageControllerName>& known = KnownControllers();
  const auto found = std::find_if(known.begin(), known.end(),
                                  [&](const StageControllerName& entry) { return name == entry.stage_name; });
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
    // The file's own word comes first.
    if (parameters.contains(place) || model == world.models.end() || model->parent) continue;
    const Vec2 point = Transform2(X_EW) * model->X_PM.translation();
    parameters[place] = {point.x(), point.y()};
    changed = true;
  }
  if (changed) controller.parameters = parameters.dump();
}

}  // namespace troupe
