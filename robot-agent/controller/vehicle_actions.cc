#include "robot-agent/controller/vehicle_actions.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/spatial/scene.h"

namespace troupe {
namespace {

constexpr double kChargerPatience = 3.0;   // s, until a charger has to give energy
constexpr double kGripperPatience = 30.0;  // s, until fingers and lift have to be where they are to be
constexpr double kSameplace = 1.0;         // m, of a position that is told to the vehicle
constexpr double kBeside = 0.1;            // m, between the vehicle and a load that it puts down
constexpr double kLiftUp = 100.0;          // percent

bool WorksOn(const fleet::TrackedAction& tracked) {
  return tracked.status == fleet::ActionStatus::kInitializing || tracked.status == fleet::ActionStatus::kRunning;
}

}  // namespace

std::string ErrorName(const std::string& name, fleet::Version version) {
  if (fleet::IsBefore3(version)) return name;
  std::string upper;
  for (const char c : name) {
    const bool is_capital = c >= 'A' && c <= 'Z';
    if (is_capital) upper += '_';
    upper += is_capital ? c : static_cast<char>(c - 'a' + 'A');
  }
  return upper;
}

VehicleActions::VehicleActions(const RobotInfo& info, fleet::VehicleSettings settings)
    : id_(info.id), settings_(std::move(settings)) {
  if (!info.grippers.empty()) gripper_ = info.grippers.front();
}

VehicleActions::Ongoing& VehicleActions::OngoingOf(const std::string& id) {
  const auto found = std::find_if(ongoing_.begin(), ongoing_.end(), [&](const Ongoing& one) { return one.id == id; });
  return found != ongoing_.end() ? *found : ongoing_.emplace_back(Ongoing{.id = id});
}

std::vector<fleet::ActionProgress> VehicleActions::Work(const fleet::VehicleMemory& memory,
                                                        const Observation& observation, const Surroundings& around,
                                                        Command& command) {
  std::vector<fleet::ActionProgress> progress;
  const auto is_started = [](const std::vector<fleet::TrackedAction>& actions, const std::string& id) {
    return std::any_of(actions.begin(), actions.end(), [&](const fleet::TrackedAction& tracked) {
      return tracked.action.id == id && fleet::IsStarted(tracked.status);
    });
  };
  std::erase_if(ongoing_, [&](const Ongoing& one) {
    return !is_started(memory.actions, one.id) && !is_started(memory.instant_actions, one.id) &&
           !is_started(memory.zone_actions, one.id);
  });
  for (const std::vector<fleet::TrackedAction>* const list :
       {&memory.instant_actions, &memory.actions, &memory.zone_actions}) {
    for (const fleet::TrackedAction& tracked : *list) {
      if (!WorksOn(tracked)) continue;
      Turn turn{tracked, OngoingOf(tracked.action.id), memory, observation, around, command, progress};
      if (tracked.status == fleet::ActionStatus::kInitializing) {
        turn.own = {.id = tracked.action.id};
        progress.push_back({tracked.action.id, fleet::ActionStatus::kRunning, {}, {}});
      }
      Act(turn);
      turn.own.worked += observation.interval;
    }
  }
  return progress;
}

void VehicleActions::Act(Turn& turn) const {
  const std::string& type = turn.tracked.action.type;
  if (type == "pick") {
    gripper_ ? PickByGripper(turn) : Pick(turn);
  } else if (type == "drop") {
    gripper_ ? DropByGripper(turn) : Drop(turn);
  } else if (type == "startCharging") {
    Charge(turn);
  } else if (type == "stopCharging") {
    End(turn, fleet::ActionStatus::kFinished, "");
  } else if (type == "initPosition" || type == "initializePosition") {
    InitializePosition(turn);
  } else if (type == "detectObject") {
    Detect(turn);
  } else if (type == "downloadMap") {
    // The world is all that its maps could have: a download takes its time, and makes a name.
    if (turn.own.worked >= settings_.load_time) End(turn, fleet::ActionStatus::kFinished, "");
  } else if (type == "trigger") {
    // Before 3.0 it is an action of this vehicle's own.
    bool is_any = false;
    for (const fleet::TrackedAction& other : turn.memory.actions) {
      if (other.action.type != "waitForTrigger" || other.status != fleet::ActionStatus::kRunning) continue;
      turn.progress.push_back({other.action.id, fleet::ActionStatus::kFinished, {}, {}});
      is_any = true;
    }
    if (is_any) return End(turn, fleet::ActionStatus::kFinished, "");
    Fail(turn, "noTriggerAwaited", "no action waits for a trigger");
  }
}

void VehicleActions::End(Turn& turn, fleet::ActionStatus status, const std::string& result) const {
  turn.progress.push_back({turn.tracked.action.id, status, result.empty() ? std::nullopt : std::optional(result), {}});
}

void VehicleActions::Fail(Turn& turn, const std::string& type, const std::string& reason) const {
  fleet::VehicleError error;
  error.type = ErrorName(type, settings_.version);
  error.description = reason;
  error.references = {{{"actionId", turn.tracked.action.id}, {"actionType", turn.tracked.action.type}}};
  turn.progress.push_back({turn.tracked.action.id, fleet::ActionStatus::kFailed, reason, error});
}

void VehicleActions::Pick(Turn& turn) const {
  const fleet::Action& action = turn.tracked.action;
  const std::vector<VehicleLoad> loads = LoadsOf(turn.around, id_);
  if (turn.own.phase == 1) {
    const bool is_taken =
        std::any_of(loads.begin(), loads.end(), [&](const VehicleLoad& load) { return load.model == turn.own.load; });
    if (!is_taken) return Fail(turn, "loadNotTaken", "the load cannot be taken: it has no room on the vehicle");
    return End(turn, fleet::ActionStatus::kFinished, turn.around.world().model(*turn.own.load).name);
  }
  if (!loads.empty()) return Fail(turn, "alreadyLoaded", "the vehicle has the load " + loads.front().name);
  const std::string station = action.TextOf("stationName");
  Vec2 place = turn.around.PoseOf(id_).translation();
  if (!station.empty()) {
    const std::optional<Vec2> known = FindStation(turn.around, station);
    if (!known) return Fail(turn, "unknownStation", "there is no station " + station);
    place = *known;
  }
  const std::optional<VehicleLoad> load = FindLoad(turn.around, id_, place, action.TextOf("loadId"));
  if (!load) {
    const std::string name = action.TextOf("loadId");
    return Fail(turn, "loadNotFound",
                name.empty() ? "no load is within reach" : "the load " + name + " is not within reach");
  }
  if (turn.own.worked < settings_.load_time) return;
  turn.command.orders.emplace_back(LoadOrder{.object = load->model});
  turn.own.load = load->model;
  turn.own.phase = 1;
}

std::vector<Vec2> VehicleActions::PlacesFor(const Turn& turn, const VehicleLoad& load) const {
  std::vector<Vec2> places;
  const std::string station = turn.tracked.action.TextOf("stationName");
  if (!station.empty()) {
    if (const std::optional<Vec2> known = FindStation(turn.around, station)) places.push_back(*known);
    return places;
  }
  const Rectangle own = BoxOf(turn.around, turn.around.scene.body_of(id_));
  const Rectangle its = BoxOf(turn.around, turn.around.scene.body_of(load.object));
  // Whatever the heading of the load.
  const double reach = std::max({its.max_x, -its.min_x, its.max_y, -its.min_y, 0.0}) * std::sqrt(2.0) + kBeside;
  const Transform2 X_WR(turn.around.PoseOf(id_));
  for (const Vec2& p_R : {Vec2(own.max_x + reach, 0.0), Vec2(own.min_x - reach, 0.0), Vec2(0.0, own.max_y + reach),
                          Vec2(0.0, own.min_y - reach)}) {
    places.push_back(X_WR * p_R);
  }
  return places;
}

void VehicleActions::Drop(Turn& turn) const {
  const std::string name = turn.tracked.action.TextOf("loadId");
  std::optional<VehicleLoad> load;
  for (const VehicleLoad& carried : LoadsOf(turn.around, id_)) {
    // Of a stack the uppermost: it comes last, or is named.
    if (turn.own.load ? carried.model == turn.own.load : name.empty() || carried.name == name) load = carried;
  }
  if (turn.own.phase == 1 && !load) {
    return End(turn, fleet::ActionStatus::kFinished, turn.around.world().model(*turn.own.load).name);
  }
  if (!load) return Fail(turn, "noLoad", name.empty() ? "the vehicle has no load" : "the vehicle has no load " + name);
  if (turn.own.worked < settings_.load_time) return;
  const std::vector<Vec2> places = PlacesFor(turn, *load);
  if (turn.own.place >= places.size()) {
    const std::string station = turn.tracked.action.TextOf("stationName");
    if (places.empty()) return Fail(turn, "unknownStation", "there is no station " + station);
    return Fail(
        turn, "noRoomForLoad",
        "there is no room for the load " + (station.empty() ? "beside the vehicle" : "at the station " + station));
  }
  const Vec2& place = places[turn.own.place++];
  turn.command.orders.emplace_back(LoadOrder{.object = load->model, .takes = false, .x = place.x(), .y = place.y()});
  turn.own.load = load->model;
  turn.own.phase = 1;
}

void VehicleActions::PickByGripper(Turn& turn) const {
  const GripperReading& reading = turn.observation.grippers.front();
  const bool has_lift = gripper_->lift.has_value();
  switch (turn.own.phase) {
    case 0:
      if (reading.held) return Fail(turn, "alreadyLoaded", "the gripper holds " + std::string(reading.held->name));
      turn.command.grippers.push_back({.gripper = 0, .fingers = FingerCommand::kClose});
      turn.own.phase = 1;
      return;
    case 1:
      if (reading.held) {
        if (has_lift) turn.command.grippers.push_back({.gripper = 0, .lift = kLiftUp});
        turn.own.phase = 2;
      } else if (reading.fingers == FingerState::kClosed || turn.own.worked > kGripperPatience) {
        turn.command.grippers.push_back({.gripper = 0, .fingers = FingerCommand::kOpen});
        Fail(turn, "loadNotFound", "nothing is between the fingers");
      }
      return;
    default:
      if (!reading.held) return Fail(turn, "loadNotTaken", "the gripper has lost the load");
      if (++turn.own.phase > 3 && !reading.lift_moving) {
        End(turn, fleet::ActionStatus::kFinished, std::string(reading.held->name));
      }
      return;
  }
}

void VehicleActions::DropByGripper(Turn& turn) const {
  const GripperReading& reading = turn.observation.grippers.front();
  switch (turn.own.phase) {
    case 0:
      if (!reading.held) return Fail(turn, "noLoad", "the gripper holds nothing");
      if (gripper_->lift) turn.command.grippers.push_back({.gripper = 0, .lift = 0.0});
      turn.own.phase = 1;
      return;
    case 1:
    case 2:  // the lift begins to move in the tick after its command
      ++turn.own.phase;
      return;
    case 3:
      if (reading.lift_moving && turn.own.worked < kGripperPatience) return;
      turn.command.grippers.push_back({.gripper = 0, .fingers = FingerCommand::kOpen});
      turn.own.phase = 4;
      return;
    default:
      if (!reading.held && reading.fingers == FingerState::kOpen) return End(turn, fleet::ActionStatus::kFinished, "");
      if (turn.own.worked > 2.0 * kGripperPatience) Fail(turn, "loadNotDropped", "the fingers do not open");
      return;
  }
}

void VehicleActions::Charge(Turn& turn) const {
  if (turn.observation.energy && turn.observation.energy->charge_watts > 0.0) {
    return End(turn, fleet::ActionStatus::kFinished, "");
  }
  if (turn.own.worked >= kChargerPatience) Fail(turn, "notAtCharger", "no charger gives energy here");
}

void VehicleActions::InitializePosition(Turn& turn) const {
  const fleet::Action& action = turn.tracked.action;
  const auto number = [&](const char* key) {
    const fleet::ParameterValue* const value = action.FindParameter(key);
    return value != nullptr ? value->Number().value_or(0.0) : 0.0;
  };
  const Vec2 told(number("x"), number("y"));
  if ((told - turn.observation.pose_estimate.translation()).norm() <= kSameplace) {
    return End(turn, fleet::ActionStatus::kFinished, "");
  }
  Fail(turn, "localizationError", "the vehicle is not at this position");
}

void VehicleActions::Detect(Turn& turn) const {
  const std::optional<VehicleLoad> load = FindLoad(turn.around, id_, turn.around.PoseOf(id_).translation(), "");
  if (load) return End(turn, fleet::ActionStatus::kFinished, load->name);
  Fail(turn, "loadNotFound", "no load is within reach");
}

}  // namespace troupe
