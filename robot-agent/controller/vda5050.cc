// vda5050: a vehicle that a fleet control drives by VDA 5050 (docs/vda5050.md).
//
// Messages of the fleet control are inputs of ticks (Observation::fleet), and its own leave with its commands
// (Command::fleet): with headers and simulated timestamps, so that they repeat with the run. The order logic is
// fleet/vehicle.h; this controller tells it what happens, drives (vehicle_driver.h) and works on actions
// (vehicle_actions.h) as its memory says.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/geometry/limits.h"
#include "common/spatial/scene.h"
#include "fleet/vehicle.h"
#include "fleet/vehicle_news.h"
#include "fleet/vehicle_settings.h"
#include "robot-agent/controller/built_in.h"
#include "robot-agent/controller/vehicle_actions.h"
#include "robot-agent/controller/vehicle_driver.h"
#include "robot-agent/controller/vehicle_readings.h"
#include "robot-agent/controller/vehicle_site.h"
#include "robot-agent/controller/vehicle_zones.h"
#include "robot-agent/navigation/lane_traffic.h"
#include "robot-agent/navigation/surroundings.h"

namespace troupe {
namespace {

constexpr double kManualSeconds = 2.0;     // after the last command of a user
constexpr double kJump = 0.3;              // m in a tick, beyond its motion: the vehicle was moved
constexpr double kShortBase = 2.0;         // s to the end of the base: more of it is asked for
constexpr std::size_t kMostReached = 100;  // nodes in a tick
constexpr char kBlocked[] = "pathBlocked";
constexpr char kBatteryEmpty[] = "batteryEmpty";
constexpr char kUnknownPlace[] = "nodePositionUnknown";
constexpr char kUnreachableMap[] = "mapNotReachable";
constexpr char kTooHigh[] = "vehicleTooHigh";

class Vda5050 final : public Controller, public RobotWatcher {
 public:
  Vda5050(const RobotInfo& info, fleet::VehicleSettings settings)
      : info_(info), settings_(std::move(settings)), driver_(info, settings_), actions_(info, settings_), site_(info) {}

  void WatchRobots(const Surroundings& around) override { around_.emplace(around); }

  Command Update(const Observation& observation) override {
    Command command;
    said_.clear();
    if (!profile_) Begin(observation);
    readings_ = MakeReadings(*around_, observation, info_.id, settings_);
    site_.Begin(observation, *around_, command);
    FollowMode(observation);
    WatchBattery(observation);
    for (const FleetMessage& message : observation.fleet) Receive(message);
    Move(observation, command);
    for (const fleet::ActionProgress& progress : actions_.Work(memory_, observation, *around_, command)) {
      Apply(progress);
    }
    const bool moves = command.twist != Twist{} || command.speed != 0.0 || observation.twist != Twist{};
    if (moves != memory_.is_driving) Apply(fleet::DrivingChanged{moves});
    Publish(observation, command);
    if (memory_ != told_) {
      for (std::string& text : fleet::NewsOf(told_, memory_)) said_.push_back(std::move(text));
      told_ = memory_;
    }
    for (const std::string& text : said_) command.say += (command.say.empty() ? "" : "; ") + text;
    around_.reset();
    return command;
  }

  std::unique_ptr<Controller> Clone() const override { return std::make_unique<Vda5050>(*this); }

 private:
  void Begin(const Observation& observation) {
    profile_ = MakeProfile(*around_, info_, settings_, observation.energy.has_value());
    must_send_factsheet_ = true;
    for (const std::string& map : MapsOf(settings_.map, around_->world())) {
      memory_.maps.push_back({map, "1", {}, fleet::StoredStatus::kEnabled});
    }
    // It knows where it is, if that has a name.
    const Vec2 at = observation.pose_estimate.translation();
    for (const LaneGraph& graph : info_.lane_graphs) {
      for (const LaneVertex& vertex : graph.vertices) {
        if (vertex.name.empty() || (vertex.position - at).norm() > settings_.tolerance) continue;
        if (std::fabs(vertex.z - observation.pose_estimate.z) >= kLevelGap) continue;
        memory_.last_node_id = vertex.name;
        memory_.is_at_last_node = true;
      }
    }
  }

  fleet::VehicleOutcome Apply(const fleet::VehicleInput& input) {
    const fleet::VehicleOutcome outcome = fleet::Apply(memory_, input, *profile_, readings_);
    must_send_state_ = must_send_state_ || outcome.must_send_state;
    must_send_factsheet_ = must_send_factsheet_ || outcome.must_send_factsheet;
    return outcome;
  }

  // A user who drives it, or moves it to another place, takes it over.
  void FollowMode(const Observation& observation) {
    const Vec2 at = observation.pose_estimate.translation();
    const Twist& twist = observation.twist;
    const double motion = std::sqrt(twist.vx * twist.vx + twist.vy * twist.vy) * observation.interval;
    const bool was_moved = last_place_ && (at - *last_place_).norm() > motion + kJump;
    last_place_ = at;
    if (was_moved || observation.is_overridden) manual_until_ = observation.time + kManualSeconds;
    const bool is_manual = manual_until_ && observation.time < *manual_until_;
    const fleet::OperatingMode mode = is_manual ? fleet::OperatingMode::kManual : fleet::OperatingMode::kAutomatic;
    if (memory_.mode != mode && memory_.wanted_mode != mode) Apply(fleet::ModeChanged{mode});
    if (was_moved) Apply(fleet::LastNodeLost{});
    if (is_manual) driver_.Forget();
  }

  // Without energy it does nothing, until a person brings it to a charger.
  void WatchBattery(const Observation& observation) {
    const bool is_empty = observation.energy && observation.energy->capacity > 0.0 && observation.energy->joules <= 0.0;
    if (std::exchange(is_battery_empty_, is_empty) == is_empty) return;
    fleet::VehicleError error;
    error.type = ErrorName(kBatteryEmpty, settings_.version);
    if (!is_empty) {
      Apply(fleet::ErrorCleared{error.type});
      return;
    }
    error.level = fleet::ErrorLevel::kFatal;
    error.description = "the battery is empty";
    Apply(fleet::ErrorRaised{error});
  }

  // A message of another major version is not understood.
  void CheckVersion(const fleet::Header& header, std::vector<fleet::MessageFault>& faults) const {
    const std::optional<fleet::Version> version = fleet::FindVersion(header.version);
    if (version && fleet::IsBefore3(*version) == fleet::IsBefore3(settings_.version)) return;
    faults.push_back({"/version", "found '" + header.version + "', expected " + fleet::VersionText(settings_.version)});
  }

  // A place beyond all worlds is none.
  static void CheckPlaces(const fleet::Order& order, std::vector<fleet::MessageFault>& faults) {
    const auto check = [&](double x, double y, const std::string& pointer) {
      if (std::fabs(x) <= kMaxMagnitude && std::fabs(y) <= kMaxMagnitude) return;
      if (faults.empty()) faults.push_back({pointer, "found a place beyond 1000 km, expected one nearer"});
    };
    for (std::size_t i = 0; i < order.nodes.size(); ++i) {
      const std::optional<fleet::NodePosition>& position = order.nodes[i].position;
      if (position) check(position->x, position->y, fmt::format("/nodes/{}/nodePosition", i));
    }
    for (std::size_t i = 0; i < order.edges.size(); ++i) {
      if (!order.edges[i].trajectory) continue;
      for (const fleet::ControlPoint& point : order.edges[i].trajectory->control_points) {
        check(point.x, point.y, fmt::format("/edges/{}/trajectory/controlPoints", i));
      }
    }
  }

  void Receive(const FleetMessage& message) {
    if (message.topic == FleetTopic::kOrder) {
      fleet::Decoded<fleet::Order> decoded = fleet::Decode<fleet::Order>(message.text, settings_.version);
      if (decoded.ok()) CheckVersion(decoded.message.header, decoded.faults);
      if (decoded.ok()) CheckPlaces(decoded.message, decoded.faults);
      const fleet::OrderReceived received{std::move(decoded.message), std::move(decoded.faults)};
      const fleet::OrderRow* const row = Apply(received).row;
      if (row == nullptr || row->verdict != fleet::OrderVerdict::kReject) return;
      said_.push_back(
          fmt::format("order {} {} rejected: {}", received.order.order_id, received.order.order_update_id, row->name));
    } else if (message.topic == FleetTopic::kInstantActions) {
      fleet::Decoded<fleet::InstantActions> decoded =
          fleet::Decode<fleet::InstantActions>(message.text, settings_.version);
      if (decoded.ok()) CheckVersion(decoded.message.header, decoded.faults);
      Apply(fleet::InstantActionsReceived{std::move(decoded.message), std::move(decoded.faults)});
    } else if (!fleet::IsBefore3(settings_.version) && message.topic == FleetTopic::kZoneSet) {
      fleet::Decoded<fleet::ZoneSet> decoded = fleet::Decode<fleet::ZoneSet>(message.text, settings_.version);
      if (decoded.ok()) CheckVersion(decoded.message.header, decoded.faults);
      Apply(fleet::ZoneSetReceived{std::move(decoded.message), std::move(decoded.faults)});
    } else if (!fleet::IsBefore3(settings_.version) && message.topic == FleetTopic::kResponses) {
      fleet::Decoded<fleet::Responses> decoded = fleet::Decode<fleet::Responses>(message.text, settings_.version);
      if (decoded.ok()) CheckVersion(decoded.message.header, decoded.faults);
      Apply(fleet::ResponsesReceived{std::move(decoded.message), std::move(decoded.faults)});
    }
  }

  std::int64_t TimeOf(const Observation& observation) const {
    return settings_.epoch_ms + std::llround(observation.time * 1000.0);
  }

  // Zones that it meets on the way; null: it does not drive.
  VehicleZones::Limit HeedZones(const Observation& observation, const VehicleWay* way) {
    if (memory_.zone_sets.empty()) return {};
    VehicleZones::Place place;
    place.at = observation.pose_estimate.translation();
    place.map = readings_.position->map_id;
    place.radius = RadiusOf(around_->world(), info_.id);
    place.braking = std::max(-info_.robot->drive.acceleration.x.min, 1e-3);
    place.now_ms = TimeOf(observation);
    VehicleZones::Limit limit = zones_.Look(memory_, place, way);
    for (const fleet::VehicleInput& input : limit.inputs) Apply(input);
    return limit;
  }

  // An edge that is too low for the vehicle with its load: it stands before it.
  bool IsTooHigh() {
    const fleet::Edge* const edge = memory_.edges.empty() ? nullptr : &memory_.edges.front();
    const bool is_too_high = edge != nullptr && edge->released && edge->maximum_robot_height &&
                             HeightOf(*around_, info_.id) > *edge->maximum_robot_height;
    if (std::exchange(has_told_height_, is_too_high) == is_too_high) return is_too_high;
    const std::string type = ErrorName(kTooHigh, settings_.version);
    if (!is_too_high) {
      Apply(fleet::ErrorCleared{type});
      return false;
    }
    fleet::VehicleError error;
    error.type = type;
    error.description = fmt::format("the vehicle is {:.3f} m high, the edge lets {:g} m pass",
                                    HeightOf(*around_, info_.id), *edge->maximum_robot_height);
    error.references = {{{"edgeId", edge->id}, {"nodeId", memory_.nodes.front().id}}};
    Apply(fleet::ErrorRaised{error});
    return true;
  }

  void Move(const Observation& observation, Command& command) {
    bool is_blocked = false;
    readings_.safety_state.field_violation = false;
    for (std::size_t i = 0; i < kMostReached; ++i) {
      if (!fleet::MayDrive(memory_, *profile_)) {
        driver_.Rest();
        site_.Rest(!memory_.nodes.empty());
        HeedZones(observation, nullptr);
        IsTooHigh();  // perhaps no more
        break;
      }
      if (IsTooHigh()) {
        driver_.Rest();
        site_.Rest(true);
        HeedZones(observation, nullptr);
        break;
      }
      const std::optional<VehicleWay> way = driver_.Look(memory_, observation);
      if (!way) {
        ReportNode(kUnknownPlace, "the node has no position, and no place has its name");
        break;
      }
      const VehicleSite::Limit limit = site_.Follow(*way);
      const VehicleZones::Limit zones = HeedZones(observation, &*way);
      if (!fleet::IsBefore3(settings_.version)) {
        AddPaths(*way, memory_, std::min(driver_.SpeedOf(memory_), zones.speed), TimeOf(observation), readings_);
      }
      if (limit.rides || limit.has_no_lift) {
        if (limit.has_no_lift) ReportNode(kUnreachableMap, "no lift leads from here to the map of the node");
        if (limit.thing) command.orders.emplace_back(WaitOrder{limit.thing, {}});
        break;
      }
      std::optional<double> room = limit.room;
      if (zones.room) room = std::min(room.value_or(*zones.room), *zones.room);
      const VehicleDriver::Motion motion = driver_.Drive(memory_, observation, *around_, room, zones.speed);
      readings_.distance_since_last_node = motion.driven;
      readings_.is_base_short = motion.room < kShortBase * std::max(std::fabs(observation.twist.vx), 0.1);
      if (motion.has_reached) {
        Apply(fleet::NodeReached{memory_.nodes.front().sequence_id});
        continue;
      }
      command.twist = motion.command.twist;
      command.speed = motion.command.speed;
      command.steering = motion.command.steering;
      const bool stands = command.twist.IsZero() && command.speed == 0.0;
      if (limit.thing && stands && !limit.is_stuck) {
        command.orders.emplace_back(WaitOrder{limit.thing, {}});  // of a door that opens, and of a lift that comes
        break;
      }
      const bool is_in_field = motion.obstacle.has_value() || observation.stalled;
      const std::optional<ModelId> obstacle = limit.is_stuck && stands ? limit.thing : motion.obstacle;
      is_blocked = obstacle.has_value() || observation.stalled;
      readings_.safety_state.field_violation = is_in_field;
      if (is_blocked) WaitFor(obstacle, observation, command);
      break;
    }
    if (!is_blocked) EndWait(observation);
  }

  void WaitFor(const std::optional<ModelId>& obstacle, const Observation& observation, Command& command) {
    WaitOrder wait;
    if (obstacle) wait.thing = RootOf(*around_, *obstacle);
    command.orders.emplace_back(wait);
    if (!blocked_since_) blocked_since_ = observation.time;
    if (observation.time - *blocked_since_ < settings_.blocked_after || has_told_block_) return;
    has_told_block_ = true;
    const std::string name = wait.thing ? around_->world().model(*wait.thing).name : "something";
    fleet::VehicleError error;
    error.type = ErrorName(kBlocked, settings_.version);
    error.description = name + " is in the way";
    error.references = {{{"nodeId", memory_.nodes.front().id}, {"obstacle", name}}};
    if (!memory_.edges.empty()) error.references->push_back({"edgeId", memory_.edges.front().id});
    Apply(fleet::ErrorRaised{error});
  }

  void EndWait(const Observation& observation) {
    // A contact ends in the tick after the motion; a vehicle that creeps to and fro is still blocked.
    if (!blocked_since_ || observation.stalled) return;
    blocked_since_.reset();
    if (std::exchange(has_told_block_, false)) Apply(fleet::ErrorCleared{ErrorName(kBlocked, settings_.version)});
  }

  // Once: the vehicle cannot go to the first of its nodes.
  void ReportNode(const std::string& type, const std::string& description) {
    fleet::VehicleError error;
    error.type = ErrorName(type, settings_.version);
    error.description = description;
    error.references = {{{"nodeId", memory_.nodes.front().id}}};
    const bool is_known = std::any_of(memory_.errors.begin(), memory_.errors.end(), [&](const fleet::ReportedError& e) {
      return e.error.type == error.type && e.error.references == error.references;
    });
    if (!is_known) Apply(fleet::ErrorRaised{error});
  }

  fleet::Header NextHeader(std::uint32_t& count, std::int64_t now) {
    return {count++, fleet::FormatTimestamp(now, settings_.version), fleet::VersionText(settings_.version),
            settings_.manufacturer, settings_.serial_number};
  }

  void Publish(const Observation& observation, Command& command) {
    const fleet::Version version = settings_.version;
    const std::int64_t now = TimeOf(observation);
    if (std::exchange(must_send_factsheet_, false)) {
      fleet::Factsheet sheet = profile_->factsheet;
      sheet.header = NextHeader(factsheets_, now);
      command.fleet.push_back({FleetTopic::kFactsheet, fleet::Encode(sheet, version)});
    }
    fleet::State state = fleet::MakeState(memory_, *profile_, readings_);
    const bool is_due = std::exchange(must_send_state_, false) || !last_state_ ||
                        fleet::IsStateDue(*last_state_, last_state_at_, state, now, profile_->factsheet.limits.timing);
    if (is_due) {
      last_state_ = state;
      last_state_at_ = now;
      state.header = NextHeader(states_, now);
      Add(FleetTopic::kState, fleet::Encode(state, version), command);
    }
    const auto interval = std::llround(settings_.visualization_interval * 1000.0);
    if (interval > 0 && (!last_view_at_ || now - *last_view_at_ >= interval)) {
      last_view_at_ = now;
      fleet::Visualization view;
      view.header = NextHeader(views_, now);
      view.reference_state_header_id = states_ > 0 ? states_ - 1 : 0;
      view.planned_path = readings_.planned_path;
      view.intermediate_path = readings_.intermediate_path;
      view.position = readings_.position;
      view.velocity = readings_.velocity;
      Add(FleetTopic::kVisualization, fleet::Encode(view, version), command);
    }
  }

  static void Add(FleetTopic topic, std::string text, Command& command) {
    if (text.size() <= kMaxFleetBytes) {
      command.fleet.push_back({topic, std::move(text)});
    } else {
      command.report =
          fmt::format("a message of {} bytes on the topic {} is too long, and is not sent", text.size(), NameOf(topic));
    }
  }

  RobotInfo info_;
  fleet::VehicleSettings settings_;
  VehicleDriver driver_;
  VehicleActions actions_;
  VehicleSite site_;
  VehicleZones zones_;
  fleet::VehicleMemory memory_;
  fleet::VehicleMemory told_;  // of the tick before, for the news
  std::optional<fleet::VehicleProfile> profile_;
  fleet::VehicleReadings readings_;
  std::optional<Surroundings> around_;  // of the tick

  std::optional<double> manual_until_;  // s, simulated, as all times
  std::optional<Vec2> last_place_;      // m
  std::optional<double> blocked_since_;
  bool has_told_block_ = false;
  bool has_told_height_ = false;
  bool is_battery_empty_ = false;

  bool must_send_state_ = false;
  bool must_send_factsheet_ = false;
  std::optional<fleet::State> last_state_;  // without its header
  std::int64_t last_state_at_ = 0;          // ms since 1970, as the next one
  std::optional<std::int64_t> last_view_at_;
  // The header ids that come next, by topic.
  std::uint32_t states_ = 0;
  std::uint32_t views_ = 0;
  std::uint32_t factsheets_ = 0;
  std::vector<std::string> said_;  // in the tick
};

}  // namespace

BuiltInController Vda5050Controller() {
  return {"vda5050",
          [](const std::string& parameters) -> Status {
            const Result<fleet::VehicleSettings> settings = fleet::ReadVehicleSettings(parameters, "robot");
            return settings.ok() ? Status() : Status(settings.error());
          },
          [](const RobotInfo& info) -> Result<std::unique_ptr<Controller>> {
            Result<fleet::VehicleSettings> settings = fleet::ReadVehicleSettings(info.parameters, info.robot->name);
            if (!settings.ok()) return settings.error();
            return std::unique_ptr<Controller>(std::make_unique<Vda5050>(info, std::move(settings).value()));
          }};
}

}  // namespace troupe
