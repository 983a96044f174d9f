// fetch: picks objects up at some places and puts them down at others, step by step.
//
// The parameters are a list of steps that users think in ("take" from a place, "put" at another). They are translated
// once into small actions, each with an end that can be observed: a pose reached, fingers open or closed, a lift at
// rest, a time. The controller executes one action after another; several that end at once take no time.
//
// Motions are planned by braking distances, with half of the drive's deceleration as a reserve, so that a robot arrives
// exactly, to a micrometre, for any length of ticks: the next step begins from there, and grippers need it.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/base/json_reader.h"
#include "common/geometry/limits.h"
#include "robot-agent/controller/built_in.h"
#include "robot-agent/navigation/steering.h"
#include "troupe/deterministic_math.h"
#include "troupe/result.h"

namespace troupe {
namespace {

// The plan of a `fetch` controller: its parameters as a sequence of actions.

enum class FetchAction : std::uint8_t {
  kGoTo,    // turn to the point, then drive there
  kTurnTo,  // heading
  kDrive,   // straight on, or back
  kPush,    // the same, but a contact ends it
  kOpen,    // the fingers
  kClose,
  kLift,       // to a percentage
  kWait,       // seconds
  kWaitUntil,  // simulated time
};

struct FetchStep {
  FetchAction action = FetchAction::kWait;
  double value = 0.0;  // rad, m, percent or s
  double x = 0.0;      // m, in the frame of the pose estimate
  double y = 0.0;
};

struct FetchPlan {
  std::vector<FetchStep> steps;
  double speed = 0.4;      // m/s
  double turn_rate = 1.0;  // rad/s
  bool repeats = false;    // begins again after the last step
  bool needs_gripper = false;
  bool needs_lift = false;
};

constexpr const char* kPlaceText = "[x, y, heading, lift] with a lift of 0 to 100 percent";
constexpr double kInfinity = std::numeric_limits<double>::infinity();

// The place of an object: its centre, and the robot's heading and the gripper's height at the approach.
struct Place {
  double x = 0.0;  // m
  double y = 0.0;
  double heading = 0.0;  // rad, of the robot
  double lift = 0.0;     // percent
};

// Translates steps into actions.
class Planner {
 public:
  explicit Planner(const JsonReader& reader) : reader_(reader) {}

  // The plan is complete unless the reader has an error.
  FetchPlan Read() {
    plan_.speed = reader_.Number("speed", 0.0, kInfinity).value_or(plan_.speed);
    plan_.turn_rate = reader_.Number("turn_rate", 0.0, kInfinity).value_or(plan_.turn_rate);
    reach_ = reader_.Number("reach", 0.0, kInfinity).value_or(reach_);
    approach_ = reader_.Number("approach", 0.0, kInfinity).value_or(approach_);
    raise_ = reader_.Number("raise", 0.0, 100.0).value_or(raise_);
    travel_ = reader_.Number("travel", 0.0, 100.0).value_or(travel_);
    reader_.Read("repeat", plan_.repeats);
    if (const std::optional<JsonReader> places = reader_.Find("places")) {
      for (const JsonReader& place : places->Items()) ReadPlace(place);
    }
    const std::optional<JsonReader> steps = reader_.Find("steps");
    const std::vector<JsonReader> items = steps ? steps->Items() : std::vector<JsonReader>();
    if (items.empty()) reader_.FailWithout("steps", "a list of steps");
    for (const JsonReader& step : items) {
      if (reader_.ok()) AddStep(step);
    }
    return std::move(plan_);
  }

 private:
  void ReadPlace(const JsonReader& entry) {
    const auto name = entry.Get<std::string>("name");
    if (const std::optional<JsonReader> at = entry.Find("at")) {
      places_[name] = PlaceOf(*at);
    } else {
      entry.FailWithout("at", kPlaceText);
    }
    entry.RefuseOthers();
  }

  static Place PlaceOf(const JsonReader& value) {
    const std::vector<double> n = value.Numbers(4, kMaxMagnitude).value_or(std::vector<double>(4));
    if (n[3] < 0.0 || n[3] > 100.0) value.Fail(kPlaceText);
    return {n[0], n[1], n[2], n[3]};
  }

  void AddStep(const JsonReader& step) {
    const std::vector<JsonReader> members = step.Members();
    if (members.size() != 1) return void(step.Fail("an object with one key"));
    const JsonReader& value = members.front();
    const std::string& key = value.key();
    if (key == "take" || key == "put") return AddTrip(key == "take", value);
    if (key == "go_to") {
      if (const auto point = value.Numbers(2, kMaxMagnitude)) {
        plan_.steps.push_back({FetchAction::kGoTo, 0.0, (*point)[0], (*point)[1]});
      }
    } else if (key == "gripper") {
      const std::optional<double> open = value.Number(1.0, 0.0, {{"open", 1.0}, {"close", 0.0}});
      if (open) AddFingers(*open != 0.0);
    } else {
      AddNumberStep(value);
    }
  }

  // A step whose value is a number.
  void AddNumberStep(const JsonReader& value) {
    struct Kind {
      FetchAction action;
      Interval allowed;
    };
    static const std::map<std::string, Kind> kinds{{"drive", {FetchAction::kDrive, {-kMaxMagnitude, kMaxMagnitude}}},
                                                   {"push", {FetchAction::kPush, {-kMaxMagnitude, kMaxMagnitude}}},
                                                   {"lift", {FetchAction::kLift, {0.0, 100.0}}},
                                                   {"turn_to", {FetchAction::kTurnTo, {-kMaxMagnitude, kMaxMagnitude}}},
                                                   {"wait", {FetchAction::kWait, {0.0, 1e9}}},
                                                   {"wait_until", {FetchAction::kWaitUntil, {0.0, 1e9}}}};
    const auto found = kinds.find(value.key());
    if (found == kinds.end()) {
      std::vector<std::string> known{"go_to", "gripper", "put", "take"};
      for (const auto& [key, kind] : kinds) known.push_back(key);
      value.FailWith(UnknownKeyText(value.key(), std::move(known)));
      return;
    }
    const auto& [action, allowed] = found->second;
    if (const std::optional<double> number = value.Number(allowed.min, allowed.max)) Add(action, *number);
  }

  // The place named by `value`, or given as numbers.
  Place FindPlace(const JsonReader& value) const {
    if (!value.node().is_string()) return PlaceOf(value);
    const auto found = places_.find(value.node().text);
    if (found != places_.end()) return found->second;
    value.Fail("the name of one of 'places'");
    return {};
  }

  // To a place and away from it again, with a straight approach and retreat.
  void AddTrip(bool take, const JsonReader& value) {
    const Place place = FindPlace(value);
    const SinCosResult direction = SinCos(place.heading);
    const double away = reach_ + approach_;
    plan_.steps.push_back({FetchAction::kGoTo, 0.0, place.x - away * direction.cos, place.y - away * direction.sin});
    Add(FetchAction::kTurnTo, place.heading);
    const double raised = std::min(100.0, place.lift + raise_);
    Add(FetchAction::kLift, take ? place.lift : raised);
    if (take) AddFingers(true);
    Add(FetchAction::kDrive, approach_);
    if (take) {
      AddFingers(false);
      Add(FetchAction::kLift, raised);
    } else {
      Add(FetchAction::kLift, place.lift);
      AddFingers(true);
    }
    Add(FetchAction::kDrive, -approach_);
    Add(FetchAction::kLift, travel_);
  }

  void AddFingers(bool open) {
    Add(open ? FetchAction::kOpen : FetchAction::kClose, 0.0);
    plan_.needs_gripper = true;
  }
  void Add(FetchAction action, double value) {
    plan_.steps.push_back({action, value, 0.0, 0.0});
    if (action == FetchAction::kLift) plan_.needs_lift = true;
  }

  const JsonReader& reader_;
  FetchPlan plan_;
  std::map<std::string, Place> places_;
  double reach_ = 0.4;     // m, from the robot's origin to the centre of the object
  double approach_ = 0.5;  // m, straight before a place
  double raise_ = 5.0;     // percent, above a place
  double travel_ = 5.0;    // percent, between places
};

// `parameters`: a JSON object. The error names the controller.
Result<FetchPlan> ParseFetchPlan(const std::string& parameters) {
  const JsonReader reader = JsonReader::OfText(parameters, "fetch");
  FetchPlan plan = Planner(reader).Read();
  if (Status status = reader.Finish(); !status.ok()) return status.error();
  return plan;
}

constexpr double kDistanceReached = 1e-6;  // m
constexpr double kAngleReached = 1e-9;     // rad
constexpr double kSteeringDistance = 0.1;  // m: nearer to its point, it drives straight on
constexpr double kSteeringGain = 2.0;      // 1/s
constexpr double kBlockedTime = 10.0;      // s blocked on its way, before a recovery

// The fastest speed (m/s or rad/s) that allows a stop after `way` at `deceleration`; the last one ends there exactly.
// The last tick covers the rest of the way exactly, whatever it is.
double Approach(double way, double speed, double deceleration, double interval) {
  const double size = std::abs(way);
  const double allowed = std::min({speed, std::sqrt(2.0 * deceleration * size), size / interval});
  return way < 0.0 ? -allowed : allowed;
}

// Half of the strongest deceleration of the drive, as a reserve.
double Deceleration(const Interval& bounds) {
  return 0.5 * std::min(-bounds.min, bounds.max);
}

class FetchController final : public Controller {
 public:
  FetchController(const RobotInfo& info, FetchPlan plan)
      : plan_(std::move(plan)), recovery_(info.robot->drive, {plan_.speed, plan_.turn_rate}) {
    const DriveDescription& drive = info.robot->drive;
    plan_.speed = std::min({plan_.speed, drive.velocity.x.max, -drive.velocity.x.min});
    plan_.turn_rate = std::min({plan_.turn_rate, drive.velocity.heading.max, -drive.velocity.heading.min});
    // The bounds of the drive are used once more here than in the drive: a speed that the drive would cut would end the
    // motion too late.
    deceleration_ = Deceleration(drive.acceleration.x);
    turn_deceleration_ = Deceleration(drive.acceleration.heading);
  }

  Command Update(const Observation& observation) override {
    const bool is_stuck = observation.stalled && IsOnItsWay();
    const double patience = is_stuck ? kBlockedTime : Recovery::kNever;
    if (std::optional<Command> recovery = recovery_.Update(observation, patience)) {
      RestartWay();
      return *std::move(recovery);
    }
    Command command;
    // In the next tick: a round may take no time.
    if (plan_.repeats && next_ == plan_.steps.size()) next_ = 0;
    // Several steps may end in one tick; the first that does not commands the motion.
    while (next_ < plan_.steps.size() && IsDone(plan_.steps[next_], observation, command)) {
      ++next_;
      began_ = false;
      facing_ = false;
    }
    return command;
  }

  std::unique_ptr<Controller> Clone() const override { return std::make_unique<FetchController>(*this); }

 private:
  // Between places, where no place demands its exact pose.
  bool IsOnItsWay() const {
    if (next_ == plan_.steps.size()) return false;
    const FetchAction action = plan_.steps[next_].action;
    return action == FetchAction::kGoTo || action == FetchAction::kTurnTo;
  }

  // From the point to which it drove last: a recovery leads away from it.
  void RestartWay() {
    for (std::size_t i = next_ + 1; i-- > 0;) {
      if (plan_.steps[i].action != FetchAction::kGoTo) continue;
      next_ = i;
      break;
    }
    began_ = false;
    facing_ = false;
  }

  // Commands the next part of a step; true if the step is complete.
  bool IsDone(const FetchStep& step, const Observation& observation, Command& command) {
    const bool begins = !began_;
    began_ = true;
    switch (step.action) {
      case FetchAction::kGoTo:
        return GoTo(step, observation, command);
      case FetchAction::kTurnTo:
        return TurnTo(step.value, observation, command);
      case FetchAction::kDrive:
        if (begins) start_ = observation.pose_estimate;
        return DriveFromStart(step.value, observation, command);
      case FetchAction::kPush:
        if (begins) start_ = observation.pose_estimate;
        return (!begins && observation.stalled) || DriveFromStart(step.value, observation, command);
      case FetchAction::kOpen:
        if (begins) command.grippers.push_back({.fingers = FingerCommand::kOpen});
        return !begins && observation.grippers[0].fingers == FingerState::kOpen;
      case FetchAction::kClose:
        if (begins) command.grippers.push_back({.fingers = FingerCommand::kClose});
        return !begins && observation.grippers[0].fingers == FingerState::kClosed;
      case FetchAction::kLift:
        if (begins) command.grippers.push_back({.lift = step.value});
        return !begins && !observation.grippers[0].lift_moving;
      case FetchAction::kWait:
        if (begins) until_ = observation.time + step.value;
        return observation.time >= until_ - 0.5 * observation.interval;
      case FetchAction::kWaitUntil:
        return observation.time >= step.value - 0.5 * observation.interval;
    }
    return true;
  }

  bool TurnTo(double heading, const Observation& observation, Command& command) const {
    const double way = WrapAngle(heading - observation.pose_estimate.heading);
    if (std::abs(way) <= kAngleReached) return true;
    command.twist.wz = Approach(way, plan_.turn_rate, turn_deceleration_, observation.interval);
    return false;
  }

  bool GoTo(const FetchStep& step, const Observation& observation, Command& command) {
    const Pose& pose = observation.pose_estimate;
    const double dx = step.x - pose.x;
    const double dy = step.y - pose.y;
    const double distance = std::sqrt(dx * dx + dy * dy);
    if (!facing_) {
      if (distance <= kSteeringDistance) return DriveStraight(dx, dy, observation, command);
      if (!TurnTo(Atan2(dy, dx), observation, command)) return false;
      facing_ = true;
    }
    if (distance > kSteeringDistance) {
      const double error = WrapAngle(Atan2(dy, dx) - pose.heading);
      command.twist.wz = std::clamp(kSteeringGain * error, -plan_.turn_rate, plan_.turn_rate);
    }
    return DriveStraight(dx, dy, observation, command);
  }

  bool DriveFromStart(double distance, const Observation& observation, Command& command) const {
    const SinCosResult direction = SinCos(start_.heading);
    return DriveStraight(start_.x + distance * direction.cos - observation.pose_estimate.x,
                         start_.y + distance * direction.sin - observation.pose_estimate.y, observation, command);
  }

  // Along the robot's heading, to the foot of the point (dx, dy) away.
  bool DriveStraight(double dx, double dy, const Observation& observation, Command& command) const {
    const SinCosResult direction = SinCos(observation.pose_estimate.heading);
    const double way = dx * direction.cos + dy * direction.sin;
    if (std::abs(way) <= kDistanceReached) {
      command.twist = {};
      return true;
    }
    command.twist.vx = Approach(way, plan_.speed, deceleration_, observation.interval);
    return false;
  }

  FetchPlan plan_;
  Recovery recovery_;
  double deceleration_ = 0.0;       // m/s^2
  double turn_deceleration_ = 0.0;  // rad/s^2
  std::size_t next_ = 0;
  bool began_ = false;   // the next step
  bool facing_ = false;  // towards its target point
  Pose start_;           // of a straight drive
  double until_ = 0.0;   // s, simulated
};

Status CheckFetch(const std::string& parameters) {
  const Result<FetchPlan> plan = ParseFetchPlan(parameters);
  return plan.ok() ? Status() : plan.error();
}

Result<std::unique_ptr<Controller>> CreateFetch(const RobotInfo& info) {
  Result<FetchPlan> parsed = ParseFetchPlan(info.parameters);
  if (!parsed.ok()) return parsed.error();
  FetchPlan plan = std::move(parsed).value();
  if (info.robot->drive.type == DriveType::kCar) {
    return Error{{}, "fetch: the robot is a car, expected one that turns on the spot"};
  }
  if ((plan.needs_gripper || plan.needs_lift) && info.grippers.empty()) {
    return Error{{}, "fetch: the robot has no gripper, expected one for the steps 'gripper', 'lift', 'take' and 'put'"};
  }
  if (plan.needs_lift && !info.grippers[0].lift) {
    return Error{{}, "fetch: the robot's gripper has no lift, expected one for the steps 'lift', 'take' and 'put'"};
  }
  return std::unique_ptr<Controller>(std::make_unique<FetchController>(info, std::move(plan)));
}

}  // namespace

BuiltInController Fetch() {
  return {"fetch", CheckFetch, CreateFetch};
}

}  // namespace troupe
