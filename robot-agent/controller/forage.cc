// fasr, fasr2 and fasr_plan: carry units from sources to sinks. Three ways to the same task: one pair of places with
// what the sensors see at present; several pairs, in turn; one pair with planned paths on a map of its own. With a
// charger, the task waits while the robot charges its store of energy.
//
// Places are points, or marks that a fiducial finder recognizes and the robot remembers where it saw them last. Loading
// and unloading are times of standing at a place: no object is moved. Stations (station.cc) are the other side: they
// show their mark while they have a unit to give.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "common/base/json_reader.h"
#include "common/geometry/limits.h"
#include "robot-agent/controller/built_in.h"
#include "robot-agent/navigation/mapped_route.h"
#include "robot-agent/navigation/steering.h"
#include "troupe/enum_names.h"

namespace troupe {
namespace {

// Where units are loaded or unloaded, or the robot is charged: a point, or a model that a fiducial finder recognizes.
struct UnitPlace {
  std::optional<Vec2> point;  // m, in the frame of the estimate
  std::int32_t id = 0;        // fiducial_return, where there is no point
};

constexpr std::size_t kMaxTasks = 1000;
constexpr double kAtCharger = 0.1;  // m: nearer to the charger's place it waits

struct Task {
  UnitPlace source;
  UnitPlace sink;
};

struct ForageParameters {
  ClearSteering::Settings motion;
  std::vector<Task> tasks;
  double reach = 1.0;      // m: the robot is at a place within it
  double load_time = 3.0;  // s, that it stands there
  double patience = 0.0;   // s: it then turns to the next task; 0: never
  std::optional<UnitPlace> charger;
  double charge_below = 0.3;  // of the capacity: it then drives to the charger
  double charge_to = 0.95;    // of the capacity: it then continues its task
  std::optional<MappedRoute::Settings> map;
};

enum class ForageVariant : std::uint8_t { kOneTask, kTasks, kPlanning };
constexpr auto NamesOf(ForageVariant) {
  return std::array{"fasr", "fasr2", "fasr_plan"};
}

// Nothing after an error.
std::optional<UnitPlace> UnitPlaceOf(const JsonReader& value) {
  std::int32_t id = 0;
  if (value.node().is_number() && value.To(id) && id >= 1 && id <= 1'000'000'000) return UnitPlace{std::nullopt, id};
  if (const auto point = value.node().is_array() ? value.Numbers(2, kMaxMagnitude) : std::nullopt) {
    return UnitPlace{Vec2((*point)[0], (*point)[1])};
  }
  value.Fail("a point [x, y] or the id of a fiducial");
  return std::nullopt;
}

// Nothing if it is missing or wrong.
std::optional<UnitPlace> ReadUnitPlace(const JsonReader& reader, const char* key) {
  const std::optional<JsonReader> value = reader.Find(key);
  return value ? UnitPlaceOf(*value) : std::nullopt;
}

UnitPlace ReadUnitPlaceOr(const JsonReader& reader, const char* key, std::int32_t otherwise) {
  return ReadUnitPlace(reader, key).value_or(UnitPlace{std::nullopt, otherwise});
}

std::vector<Task> ReadTasks(const JsonReader& reader) {
  std::vector<Task> tasks;
  const std::optional<JsonReader> list = reader.Find("tasks");
  if (!list) return tasks;
  for (const JsonReader& entry : list->Items(kMaxTasks)) {
    const std::vector<JsonReader> pair = entry.Items();
    if (pair.size() != 2) entry.Fail("a list [source, sink] of two places");
    if (!reader.ok()) return {};
    const std::optional<UnitPlace> source = UnitPlaceOf(pair[0]);
    const std::optional<UnitPlace> sink = UnitPlaceOf(pair[1]);
    if (source && sink) tasks.push_back({*source, *sink});
  }
  return tasks;
}

template <ForageVariant kVariant>
Result<ForageParameters> ParseForage(const std::string& text) {
  ForageParameters p;
  Parameters reader(NameOf(kVariant), text);
  if (kVariant == ForageVariant::kTasks) p.tasks = ReadTasks(reader.reader());
  const UnitPlace source = ReadUnitPlaceOr(reader.reader(), "source", 1);
  const UnitPlace sink = ReadUnitPlaceOr(reader.reader(), "sink", 2);
  if (p.tasks.empty()) p.tasks.push_back({source, sink});
  p.reach = reader.ReadNumber("reach", {0.05, 100.0}).value_or(p.reach);
  p.load_time = reader.ReadNumber("load_time", {0.0, 3600.0}).value_or(p.load_time);
  p.motion.steer.speed = reader.ReadNumber("speed", {0.0, 100.0}).value_or(p.motion.steer.speed);
  p.motion.steer.turn_rate = reader.ReadNumber("turn_rate", {0.0, 100.0}).value_or(p.motion.steer.turn_rate);
  p.motion.clearance = reader.ReadNumber("clearance", {0.0, 100.0}).value_or(p.motion.clearance);
  p.charger = ReadUnitPlace(reader.reader(), "charger");
  p.charge_below = reader.ReadNumber("charge_below", {0.0, 1.0}).value_or(p.charge_below);
  p.charge_to = reader.ReadNumber("charge_to", {0.0, 1.0}).value_or(p.charge_to);
  if (p.charge_to < p.charge_below) {
    reader.Fail(fmt::format("'charge_to' is {}, expected a number from 'charge_below', which is {}, to 1", p.charge_to,
                            p.charge_below));
  }
  if (kVariant == ForageVariant::kTasks) p.patience = reader.ReadNumber("patience", {0.0, 1e6}).value_or(60.0);
  if (kVariant == ForageVariant::kPlanning) p.map = ReadMapSettings(reader, p.motion.clearance);
  if (Status status = reader.Finish(); !status.ok()) return status.error();
  return p;
}

bool NeedsFinder(const UnitPlace& place) {
  return !place.point;
}

class ForageController final : public Controller {
 public:
  ForageController(const RobotInfo& info, ForageParameters parameters, std::optional<std::size_t> ranger,
                   std::optional<std::size_t> finder)
      : parameters_(std::move(parameters)),
        drive_(info.robot->drive),
        ranger_(ranger),
        finder_(finder),
        steering_(info, ranger, parameters_.motion) {
    if (parameters_.map && ranger) route_.emplace(info, *ranger, *parameters_.map);
  }

  std::vector<std::size_t> Subscriptions() const override {
    std::vector<std::size_t> sensors;
    if (ranger_) sensors.push_back(*ranger_);
    if (finder_) sensors.push_back(*finder_);
    return sensors;
  }

  Command Update(const Observation& observation) override {
    NotePlaces(observation);
    if (route_) route_->Observe(observation);
    if (NeedsCharge(observation)) return Charge(observation);
    if (parameters_.patience > 0.0 && !carries_ && observation.time - task_since_ > parameters_.patience) {
      BeginTask((task_ + 1) % parameters_.tasks.size(), observation.time);
    }
    const UnitPlace& place = carries_ ? task().sink : task().source;
    const std::optional<Vec2> goal = GoalOf(place);
    if (!goal) {
      handling_since_.reset();
      return Search(observation);
    }
    if (DistanceTo(observation, *goal) <= parameters_.reach) return HandleUnit(observation, place);
    handling_since_.reset();
    // Half of the reach farther, so that it does not end at the very rim.
    return DriveTo(observation, *goal, 0.5 * parameters_.reach);
  }

  std::unique_ptr<Controller> Clone() const override { return std::make_unique<ForageController>(*this); }

 private:
  const Task& task() const { return parameters_.tasks[task_]; }

  void BeginTask(std::size_t task, double now) {
    task_ = task;
    task_since_ = now;
  }

  // Remembers where recognized places were.
  void NotePlaces(const Observation& observation) {
    if (!finder_) return;
    const SensorReading& reading = observation.sensors[*finder_];
    const auto* const found = reading.As<FiducialReading>();
    if (found == nullptr || reading.tick != observation.tick) return;
    const Transform2 sensor(observation.pose_estimate * found->X_RS);
    for (const Fiducial& fiducial : found->fiducials) {
      if (fiducial.id != 0) places_[fiducial.id] = sensor * fiducial.X_SF.translation();
    }
  }

  std::optional<Vec2> GoalOf(const UnitPlace& place) const {
    if (place.point) return place.point;
    const auto known = places_.find(place.id);
    return known != places_.end() ? std::optional(known->second) : std::nullopt;
  }

  static double DistanceTo(const Observation& observation, const Vec2& goal) {
    return std::sqrt(Transform2(observation.pose_estimate).InverseTransform(goal).squaredNorm());
  }

  // To within `reach` m of the goal.
  Command DriveTo(const Observation& observation, const Vec2& goal, double reach) {
    const double rest = std::max(DistanceTo(observation, goal) - reach, 0.0);
    const Vec2 next = route_ ? route_->NextPoint(observation, goal, reach).value_or(goal) : goal;
    return steering_.Towards(observation, Transform2(observation.pose_estimate).InverseTransform(next),
                             BrakingSpeed(drive_, rest));
  }

  // From a low store until a full one. The time of the task does not count meanwhile.
  bool NeedsCharge(const Observation& observation) {
    const std::optional<EnergyReading>& energy = observation.energy;
    if (!parameters_.charger || !energy || energy->capacity <= 0.0) return false;
    if (energy->joules < parameters_.charge_below * energy->capacity) charges_ = true;
    if (!charges_) return false;
    if (energy->joules >= parameters_.charge_to * energy->capacity) {
      charges_ = false;
    } else {
      task_since_ += observation.interval;
      handling_since_.reset();
    }
    return charges_;
  }

  // Drives to the charger, and stands where it is charged.
  Command Charge(const Observation& observation) {
    const std::optional<Vec2> goal = GoalOf(*parameters_.charger);
    const bool is_charged = observation.energy->charge_watts > 0.0;
    if (!goal) return is_charged ? Command() : Search(observation);
    const double distance = DistanceTo(observation, *goal);
    if (distance <= kAtCharger || (is_charged && distance <= parameters_.reach)) return {};
    return DriveTo(observation, *goal, 0.5 * kAtCharger);
  }

  Command Search(const Observation& observation) {
    if (route_) {
      if (const std::optional<Vec2> next = route_->NextUnknown(observation)) {
        return steering_.Towards(observation, Transform2(observation.pose_estimate).InverseTransform(*next),
                                 parameters_.motion.steer.speed);
      }
    }
    return steering_.Roam(observation);
  }

  bool Sees(const Observation& observation, std::int32_t id) const {
    const auto* const found = observation.sensors[*finder_].As<FiducialReading>();
    return found != nullptr && std::any_of(found->fiducials.begin(), found->fiducials.end(),
                                           [&](const Fiducial& fiducial) { return fiducial.id == id; });
  }

  // Stands while the unit is loaded or unloaded, which a recognized place allows as long as it shows its mark.
  Command HandleUnit(const Observation& observation, const UnitPlace& place) {
    Command command;
    if (!place.point && !Sees(observation, place.id)) {
      handling_since_.reset();
      return steering_.LookAround(observation);
    }
    if (!handling_since_) handling_since_ = observation.time;
    if (observation.time - *handling_since_ < parameters_.load_time) return command;
    handling_since_.reset();
    carries_ = !carries_;
    if (carries_) return command;
    ++delivered_;
    command.report = fmt::format("{} unit{} delivered", delivered_, delivered_ == 1 ? "" : "s");
    BeginTask((task_ + 1) % parameters_.tasks.size(), observation.time);
    return command;
  }

  ForageParameters parameters_;
  DriveDescription drive_;
  std::optional<std::size_t> ranger_;
  std::optional<std::size_t> finder_;
  ClearSteering steering_;
  std::optional<MappedRoute> route_;     // for planning
  std::map<std::int32_t, Vec2> places_;  // by fiducial, in the frame of the estimate
  std::size_t task_ = 0;
  double task_since_ = 0.0;  // s, simulated
  bool carries_ = false;
  bool charges_ = false;                  // it is at the charger, or on the way to it
  std::optional<double> handling_since_;  // s, simulated
  std::uint64_t delivered_ = 0;
};

template <ForageVariant kVariant>
Status CheckForage(const std::string& parameters) {
  const Result<ForageParameters> parsed = ParseForage<kVariant>(parameters);
  return parsed.ok() ? Status() : parsed.error();
}

template <ForageVariant kVariant>
Result<std::unique_ptr<Controller>> CreateForage(const RobotInfo& info) {
  Result<ForageParameters> parsed = ParseForage<kVariant>(info.parameters);
  if (!parsed.ok()) return parsed.error();
  ForageParameters& parameters = parsed.value();
  const std::optional<std::size_t> ranger = FindBestRanger(info);
  if (kVariant == ForageVariant::kPlanning && !ranger)
    return Error{{}, "fasr_plan: the robot has no ranger, expected one"};
  const std::optional<std::size_t> finder = FindFinder(info);
  const bool needs_finder = std::any_of(parameters.tasks.begin(), parameters.tasks.end(), [](const Task& task) {
    return NeedsFinder(task.source) || NeedsFinder(task.sink);
  });
  if (parameters.charger && NeedsFinder(*parameters.charger) && !finder) {
    return Error{{},
                 fmt::format("{}: the robot has no fiducial finder to look for its charger, expected one, or a point "
                             "[x, y]",
                             NameOf(kVariant))};
  }
  if (needs_finder && !finder) {
    return Error{{},
                 fmt::format("{}: the robot has no fiducial finder to look for its source and its sink, expected one, "
                             "or a point [x, y] for each of them",
                             NameOf(kVariant))};
  }
  return std::unique_ptr<Controller>(std::make_unique<ForageController>(info, std::move(parameters), ranger, finder));
}

}  // namespace

BuiltInController Fasr() {
  return {"fasr", CheckForage<ForageVariant::kOneTask>, CreateForage<ForageVariant::kOneTask>};
}

BuiltInController Fasr2() {
  return {"fasr2", CheckForage<ForageVariant::kTasks>, CreateForage<ForageVariant::kTasks>};
}

BuiltInController FasrPlan() {
  return {"fasr_plan", CheckForage<ForageVariant::kPlanning>, CreateForage<ForageVariant::kPlanning>};
}

}  // namespace troupe
