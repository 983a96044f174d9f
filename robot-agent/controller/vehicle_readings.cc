#include "robot-agent/controller/vehicle_readings.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/spatial/body_index.h"
#include "common/spatial/scene.h"
#include "robot-agent/controller/vehicle_site.h"
#include "troupe/deterministic_math.h"

namespace troupe {
namespace {

constexpr std::uint32_t kMostNodes = 1000;
constexpr std::uint32_t kMostActions = 1000;
constexpr std::size_t kMostPoints = 100;  // of a way that is told

// Without the last bits of motions, which would make each state another one.
double Rounded(double value) {
  constexpr double kUnits = 1e6;  // of m, rad and their quotients
  return std::round(value * kUnits) / kUnits + 0.0;
}

// Within half a turn: messages have no angles beyond.
double RoundedAngle(double angle) {
  return std::clamp(Rounded(WrapAngle(angle)), -kPi, kPi);
}

VehicleLoad LoadAt(const Surroundings& around, ObjectId object) {
  const ModelId root = around.world().objects[object.index()];
  return {root, object, around.world().model(root).name, around.state.objects[object.index()].X_WO.translation()};
}

// The robot that holds the object, or on which it rests, perhaps on others.
std::optional<RobotId> CarrierOf(const Surroundings& around, ObjectId object) {
  for (std::size_t depth = 0; depth < around.state.objects.size(); ++depth) {
    const ObjectState& state = around.state.objects[object.index()];
    if (state.holder) return around.world().gripper(*state.holder).robot;
    if (!state.support) return std::nullopt;
    if (const std::optional<RobotId> robot = around.scene.robot_of(*state.support)) return robot;
    const std::optional<ObjectId> below = around.scene.object_of(*state.support);
    if (!below) return std::nullopt;
    object = *below;
  }
  return std::nullopt;
}

bool IsBelowAnother(const Surroundings& around, ObjectId object) {
  return std::any_of(around.state.objects.begin(), around.state.objects.end(), [&](const ObjectState& other) {
    return other.support && around.scene.object_of(*other.support) == object;
  });
}

fleet::Load ToLoad(const Surroundings& around, RobotId robot, const VehicleLoad& load) {
  const Rectangle box = BoxOf(around, around.scene.body_of(load.object));
  const ZRange& z = around.scene.body(around.scene.body_of(load.object)).z;
  const Pose& X_WO = around.state.objects[load.object.index()].X_WO;
  const Pose X_RO = Inverse(around.PoseOf(robot)) * X_WO;
  fleet::Load result;
  result.id = load.name;
  result.type = around.world().model(load.model).type;
  result.position = "load";
  result.bounding_box_reference = {Rounded(X_RO.x), Rounded(X_RO.y), Rounded(X_RO.z + z.min),
                                   RoundedAngle(X_RO.heading)};
  if (!box.empty()) {
    result.dimensions =
        fleet::LoadDimensions{Rounded(box.max_x - box.min_x), Rounded(box.max_y - box.min_y), Rounded(z.max - z.min)};
  }
  return result;
}

// The texts of the version for kinds that the standard leaves open.
std::string KinematicsOf(DriveType type, fleet::Version version) {
  const bool is_3 = !fleet::IsBefore3(version);
  if (type == DriveType::kOmni) return is_3 ? "OMNIDIRECTIONAL" : "OMNI";
  if (type == DriveType::kCar) return is_3 ? "THREE_WHEEL" : "THREEWHEEL";
  return is_3 ? "DIFFERENTIAL" : "DIFF";
}

fleet::ParameterSpecification TextParameter(const char* key) {
  return {key, "STRING", {}, true};
}

fleet::ActionSpecification ActionOf(const char* type, const char* description, std::vector<fleet::ActionScope> scopes,
                                    std::vector<fleet::ParameterSpecification> parameters = {}) {
  fleet::ActionSpecification action;
  action.type = type;
  action.description = description;
  action.scopes = std::move(scopes);
  if (!parameters.empty()) action.parameters = std::move(parameters);
  action.pause_allowed = true;
  action.cancel_allowed = true;
  return action;
}

fleet::ActionSpecification AlsoInZones(fleet::ActionSpecification action, bool is_3) {
  if (is_3) action.scopes.push_back(fleet::ActionScope::kZone);
  return action;
}

std::vector<fleet::ActionSpecification> ActionsOf(fleet::Version version, bool has_battery) {
  using Scope = fleet::ActionScope;
  const std::vector<fleet::ParameterSpecification> load = {TextParameter("stationName"), TextParameter("loadId"),
                                                           TextParameter("loadType")};
  const bool is_3 = !fleet::IsBefore3(version);
  std::vector<fleet::ActionSpecification> actions = {
      ActionOf("startPause", "stands, and pauses its actions", {Scope::kInstant}),
      ActionOf("stopPause", "ends a pause", {Scope::kInstant}),
      ActionOf("cancelOrder", "stops, and clears the order", {Scope::kInstant}),
      ActionOf("stateRequest", "sends the state", {Scope::kInstant}),
      ActionOf("factsheetRequest", "sends the factsheet", {Scope::kInstant}),
      ActionOf(is_3 ? "initializePosition" : "initPosition",
               "takes over the last node, if it is where it is said to be", {Scope::kInstant, Scope::kNode},
               {{"x", "NUMBER", {}, {}},
                {"y", "NUMBER", {}, {}},
                {"theta", "NUMBER", {}, {}},
                {"mapId", "STRING", {}, {}},
                TextParameter("lastNodeId")}),
      ActionOf("pick", "takes a load within reach", {Scope::kNode}, load),
      ActionOf("drop", "puts its load down", {Scope::kNode}, load),
      AlsoInZones(
          ActionOf("detectObject", "looks for a load within reach", {Scope::kNode}, {TextParameter("objectType")}),
          is_3),
      AlsoInZones(ActionOf("waitForTrigger", "waits for the instant action trigger", {Scope::kNode}), is_3),
      ActionOf("trigger", "ends a wait for a trigger", {Scope::kInstant}),
  };
  const std::vector<fleet::ParameterSpecification> map = {{"mapId", "STRING", {}, {}},
                                                          {"mapVersion", "STRING", {}, {}}};
  actions.push_back(ActionOf("enableMap", "uses that version of a map", {Scope::kInstant, Scope::kNode}, map));
  actions.push_back(ActionOf("deleteMap", "forgets a map that is not enabled", {Scope::kInstant}, map));
  actions.push_back(ActionOf("downloadMap", "stores a map, which is not enabled then", {Scope::kInstant},
                             {map[0], map[1], TextParameter("mapDownloadLink")}));
  if (is_3) {
    actions.push_back(ActionOf("retry", "tries an action again", {Scope::kInstant}, {{"actionId", "STRING", {}, {}}}));
    actions.push_back(ActionOf("skipRetry", "gives an action up", {Scope::kInstant}, {{"actionId", "STRING", {}, {}}}));
    actions.push_back(ActionOf("clearInstantActions", "forgets those that have ended", {Scope::kInstant}));
    actions.push_back(ActionOf("clearZoneActions", "forgets those that have ended", {Scope::kInstant, Scope::kNode}));
    actions.push_back(ActionOf("enableZoneSet", "uses that set of zones of its map", {Scope::kInstant, Scope::kNode},
                               {{"zoneSetId", "STRING", {}, {}}}));
    actions.push_back(ActionOf("deleteZoneSet", "forgets a set of zones that is not enabled", {Scope::kInstant},
                               {{"zoneSetId", "STRING", {}, {}}}));
  }
  if (has_battery) {
    actions.push_back(
        ActionOf("startCharging", "is done when the charger gives energy", {Scope::kInstant, Scope::kNode}));
    actions.push_back(ActionOf("stopCharging", "ends charging", {Scope::kInstant, Scope::kNode}));
  }
  return actions;
}

}  // namespace

Rectangle BoxOf(const Surroundings& around, BodyId body) {
  Rectangle box = Rectangle::Nothing();
  const Body& shape = around.scene.body(body);
  for (std::size_t i = 0; i < shape.pieces.size(); ++i) {
    if (shape.piece_links[i] != 0) continue;
    for (const Vec2& vertex : shape.pieces[i].vertices) box.Extend(vertex);
  }
  return box;
}

std::vector<VehicleLoad> LoadsOf(const Surroundings& around, RobotId robot) {
  std::vector<VehicleLoad> loads;
  for (std::size_t i = 0; i < around.state.objects.size(); ++i) {
    const ObjectState& state = around.state.objects[i];
    if (state.mode == ObjectMode::kMounted || (!state.holder && !state.support)) continue;
    if (CarrierOf(around, ObjectId(i)) == robot) loads.push_back(LoadAt(around, ObjectId(i)));
  }
  return loads;
}

std::optional<VehicleLoad> FindLoad(const Surroundings& around, RobotId robot, const Vec2& place,
                                    const std::string& name) {
  constexpr double kLevel = 2.0;  // m: loads on other levels are out of reach
  const Pose& X_WR = around.PoseOf(robot);
  std::optional<VehicleLoad> nearest;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < around.state.objects.size(); ++i) {
    const ObjectState& state = around.state.objects[i];
    const bool is_loose = state.mode != ObjectMode::kMounted && state.mode != ObjectMode::kHeld;
    if (!is_loose || around.world().model(around.world().objects[i]).removed) continue;
    const VehicleLoad load = LoadAt(around, ObjectId(i));
    if (!name.empty() && load.name != name) continue;
    if ((load.position - X_WR.translation()).norm() > kLoadReach || std::abs(state.X_WO.z - X_WR.z) > kLevel) continue;
    const double distance = (load.position - place).norm();
    if (distance >= least || CarrierOf(around, ObjectId(i)) || IsBelowAnother(around, ObjectId(i))) continue;
    least = distance;
    nearest = load;
  }
  return nearest;
}

std::optional<Vec2> FindStation(const Surroundings& around, const std::string& name) {
  const WorldDescription& world = around.world();
  for (std::size_t i = 0; i < world.models.size(); ++i) {
    const ModelDescription& model = world.models[i];
    if (model.name != name || model.removed || model.parent) continue;
    const std::optional<BodyId> body = around.scene.body_of(ModelId(i));
    return body ? around.bodies.X_WB(*body).translation() : model.X_PM.translation();
  }
  for (const LaneGraph& graph : world.lane_graphs) {
    for (const LaneVertex& vertex : graph.vertices) {
      if (vertex.name == name) return vertex.position;
    }
  }
  return std::nullopt;
}

fleet::VehicleReadings MakeReadings(const Surroundings& around, const Observation& observation, RobotId robot,
                                    const fleet::VehicleSettings& settings) {
  fleet::VehicleReadings readings;
  const Pose& pose = observation.pose_estimate;
  fleet::RobotPosition position;
  position.x = Rounded(pose.x);
  position.y = Rounded(pose.y);
  position.theta = RoundedAngle(pose.heading);
  position.map_id = MapAt(settings.map, around.world(), pose.z);
  position.localized = true;
  readings.position = position;
  readings.velocity =
      fleet::Velocity{Rounded(observation.twist.vx), Rounded(observation.twist.vy), Rounded(observation.twist.wz)};
  std::vector<fleet::Load> loads;
  for (const VehicleLoad& load : LoadsOf(around, robot)) loads.push_back(ToLoad(around, robot, load));
  readings.loads = std::move(loads);
  readings.power_supply.state_of_charge = 100.0;
  if (observation.energy && observation.energy->capacity > 0.0) {
    readings.power_supply.state_of_charge =
        std::clamp(100.0 * observation.energy->joules / observation.energy->capacity, 0.0, 100.0);
    readings.power_supply.charging = observation.energy->charge_watts > 0.0;
  }
  return readings;
}

double HeightOf(const Surroundings& around, RobotId robot) {
  double height = std::max(around.scene.body(around.scene.body_of(robot)).z.max, 0.0);
  const double floor = around.PoseOf(robot).z;
  for (const VehicleLoad& load : LoadsOf(around, robot)) {
    const double top = around.scene.body(around.scene.body_of(load.object)).z.max;
    height = std::max(height, around.state.objects[load.object.index()].X_WO.z - floor + top);
  }
  return height;
}

fleet::Trajectory TrajectoryOf(const VehicleWay& way) {
  fleet::Trajectory trajectory;
  trajectory.degree = 1;
  for (std::size_t i = 0; i < way.points.size() && i < kMostPoints; ++i) {
    const Vec2& place = way.points[i].place;
    trajectory.control_points.push_back({Rounded(place.x()), Rounded(place.y()), {}});
  }
  return trajectory;
}

void AddPaths(const VehicleWay& way, const fleet::VehicleMemory& memory, double speed, std::int64_t now_ms,
              fleet::VehicleReadings& readings) {
  constexpr double kSlowest = 0.01;  // m/s, so that each time can be written
  if (way.points.size() < 2 || memory.nodes.empty()) return;
  fleet::PlannedPath planned;
  planned.trajectory = TrajectoryOf(way);
  planned.traversed_nodes.emplace();
  fleet::IntermediatePath path;
  double length = 0.0;
  Vec2 before = way.points.front().place;
  for (std::size_t i = 0; i < way.points.size() && i < kMostPoints; ++i) {
    const VehicleWay::Point& point = way.points[i];
    length += (point.place - before).norm();
    before = point.place;
    const std::int64_t eta = now_ms + std::llround(1000.0 * length / std::max(speed, kSlowest));
    path.polyline.push_back(
        {Rounded(point.place.x()), Rounded(point.place.y()), {}, fleet::FormatTimestamp(eta, fleet::Version::k3_0)});
    const std::size_t node = planned.traversed_nodes->size();
    if (point.is_node && node < memory.nodes.size()) planned.traversed_nodes->push_back(memory.nodes[node].id);
  }
  readings.planned_path = std::move(planned);
  readings.intermediate_path = std::move(path);
}

fleet::VehicleProfile MakeProfile(const Surroundings& around, const RobotInfo& info,
                                  const fleet::VehicleSettings& settings, bool has_battery) {
  fleet::VehicleProfile profile;
  profile.version = settings.version;
  profile.node_tolerance = settings.tolerance;
  fleet::Factsheet& sheet = profile.factsheet;
  const DriveDescription& drive = info.robot->drive;
  const bool is_3 = !fleet::IsBefore3(settings.version);

  sheet.type.series_name = around.world().model(info.robot->root).type;
  sheet.type.series_description = "simulated by Troupe";
  sheet.type.kinematics = KinematicsOf(drive.type, settings.version);
  sheet.type.robot_class = "CARRIER";
  sheet.type.localization_types = {"NATURAL"};
  sheet.type.navigation_types = {"VIRTUAL_LINE_GUIDED"};
  if (is_3) {
    // PRIORITY and PENALTY weigh ways of a vehicle that plans its own.
    sheet.type.supported_zones = {"BLOCKED",     "LINE_GUIDED", "RELEASE",  "COORDINATED_REPLANNING",
                                  "SPEED_LIMIT", "ACTION",      "DIRECTED", "BIDIRECTED"};
  }

  constexpr double kMost = 1e3;  // for drives without bounds
  const Rectangle box = BoxOf(around, around.scene.body_of(info.id));
  const ZRange& z = around.scene.body(around.scene.body_of(info.id)).z;
  sheet.physical.minimum_speed = 0.0;
  sheet.physical.maximum_speed = std::min(settings.speed, drive.velocity.x.max);
  sheet.physical.maximum_angular_speed = std::min(settings.turn_rate, drive.velocity.heading.max);
  sheet.physical.maximum_acceleration = std::min(drive.acceleration.x.max, kMost);
  sheet.physical.maximum_deceleration = std::min(-drive.acceleration.x.min, kMost);
  sheet.physical.minimum_height = std::max(z.max, 0.0);
  sheet.physical.maximum_height = std::max(z.max, 0.0);
  if (!box.empty()) {
    sheet.physical.width = box.max_y - box.min_y;
    sheet.physical.length = box.max_x - box.min_x;
    fleet::Envelope envelope;
    envelope.id = "body";
    envelope.vertices = {
        {box.min_x, box.min_y}, {box.max_x, box.min_y}, {box.max_x, box.max_y}, {box.min_x, box.max_y}};
    sheet.geometry.envelopes = {envelope};
  }

  sheet.limits.arrays.order_nodes = kMostNodes;
  sheet.limits.arrays.order_edges = kMostNodes;
  sheet.limits.arrays.action_states = kMostActions;
  if (is_3) sheet.limits.arrays.instant_action_states = kMostActions;
  if (is_3) sheet.limits.arrays.zone_action_states = kMostActions;
  sheet.limits.strings.message = static_cast<std::uint32_t>(kMaxFleetBytes);
  sheet.limits.timing.minimum_order_interval = around.world().interval_seconds();
  sheet.limits.timing.minimum_state_interval = settings.minimum_state_interval;
  sheet.limits.timing.default_state_interval = settings.state_interval;
  if (settings.visualization_interval > 0.0) {
    sheet.limits.timing.visualization_interval = settings.visualization_interval;
  }

  for (const char* const parameter :
       {"order.nodes.nodePosition.theta", "order.nodes.nodePosition.allowedDeviationXY",
        "order.nodes.nodePosition.allowedDeviationTheta", "order.edges.orientation", "order.edges.trajectory",
        "order.edges.corridor", "order.edges.rotationAllowed",
        is_3 ? "order.edges.maximumSpeed" : "order.edges.maxSpeed",
        is_3 ? "order.edges.maximumMobileRobotHeight" : "order.edges.maxHeight", "order.edges.maxRotationSpeed"}) {
    sheet.features.optional_parameters.push_back({parameter, fleet::Support::kSupported, {}});
  }
  sheet.features.actions = ActionsOf(settings.version, has_battery);
  sheet.load.load_positions = {"load"};
  return profile;
}

}  // namespace troupe
