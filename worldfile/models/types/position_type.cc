// `position`: a robot, with drive, localization and controller.
#include <algorithm>
#include <cmath>
#include <utility>

#include "troupe/random.h"
#include "worldfile/models/types/built_in_types.h"
#include "worldfile/models/types/stage_controllers.h"
#include "worldfile/text/quote.h"

namespace troupe {
namespace {

// [xmin xmax ymin ymax zmin zmax amin amax]; z is never moved.
TwistBounds ReadBounds(PropertyReader& reader, const std::string& name) {
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
  constexpr std::string_view kTypes[] = {"diff", "omni", "car"};
  const std::string type = reader.Word("drive", kTypes);
  drive.type = type == "omni" ? DriveType::kOmni : type == "car" ? DriveType::kCar : DriveType::kDifferential;
  constexpr double kShortest = 1e-6;  // m
  const double wheelbase = reader.Length("wheelbase", 1.0);
  drive.wheelbase = std::fabs(wheelbase) > kShortest ? std::fabs(wheelbase) : 1.0;
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
  constexpr std::string_view kTypes[] = {"gps", "odom"};
  const std::string type = reader.Word("localization", kTypes);
  const std::optional<Pose> X_WO = reader.ReadPose("localization_origin");
  const auto error = reader.Numbers("odom_error", 4);
  if (type != "odom") {
    for (const char* name : {"localization_origin", "odom_error"}) {
      if (const Property* property = reader.node().Find(name)) {
        reader.diagnostics().Warn(property->where,
                                  "property " + Quoted(name) + " has no effect with localization \"gps\"");
      }
    }
    return localization;
  }
  localization.type = LocalizationType::kOdometry;
  localization.origin = X_WO ? Inverse(*X_WO) * X_WR : Pose{};
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
    if (const std::optional<ControllerDescription> controller = ReadController(reader, context)) {
      robot.controller = *controller;
      own_ = id;
    } else if (context.default_controller) {
      robot.controller.name = *context.default_controller;
    }
    robots.push_back(std::move(robot));
    return id;
  }

  std::optional<RobotId> own_;  // that has a controller of the file
};

}  // namespace

ModelType PositionType() {
  return {.name = "position", .has_drive = true, .make_reader = MakeReader<PositionReader>};
}

}  // namespace troupe
