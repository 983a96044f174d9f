#include "robot-agent/controller/fetch_plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "common/geometry/limits.h"
#include "robot-agent/controller/nested_parameters.h"
#include "troupe/deterministic_math.h"

namespace troupe {
namespace {

using nlohmann::json;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// The place of an object: its centre, and the robot's heading and the gripper's height at the approach.
struct Place {
  double x = 0.0;  // m
  double y = 0.0;
  double heading = 0.0;  // rad, of the robot
  double lift = 0.0;     // percent
};

Error PlanError(std::string message) {
  return {{}, std::move(message)};
}

// Translates steps into actions.
class Planner {
 public:
  explicit Planner(NestedParameters& reader) : reader_(reader) {}

  // The plan is complete unless the reader has an error.
  FetchPlan Read() {
    const Interval positive{0.0, kInfinity};
    const Interval percent{0.0, 100.0};
    plan_.speed = reader_.ReadNumber("speed", positive).value_or(plan_.speed);
    plan_.turn_rate = reader_.ReadNumber("turn_rate", positive).value_or(plan_.turn_rate);
    reach_ = reader_.ReadNumber("reach", positive).value_or(reach_);
    approach_ = reader_.ReadNumber("approach", positive).value_or(approach_);
    raise_ = reader_.ReadNumber("raise", percent).value_or(raise_);
    travel_ = reader_.ReadNumber("travel", percent).value_or(travel_);
    ReadPlaces();
    const std::vector<json> steps = reader_.ReadArray("steps");
    if (steps.empty()) reader_.Fail("'steps' is missing or empty, expected a list of steps");
    for (std::size_t i = 0; i < steps.size() && reader_.status().ok(); ++i) {
      if (const Status status = AddStep(steps[i]); !status.ok()) {
        reader_.Fail(fmt::format("step {}: {}", i + 1, status.error().message));
      }
    }
    return std::move(plan_);
  }

 private:
  void ReadPlaces() {
    const std::vector<json> places = reader_.ReadArray("places");
    for (std::size_t i = 0; i < places.size(); ++i) {
      const json& entry = places[i];
      const bool has_form = entry.is_object() && entry.size() == 2 && entry.contains("name") &&
                            entry["name"].is_string() && entry.contains("at");
      const std::optional<Place> place = has_form ? ReadPlace(entry["at"]) : std::nullopt;
      if (!place) {
        reader_.Fail(
            fmt::format("place {}: expected {{\"name\": \"...\", \"at\": [x, y, heading, lift]}}, with a lift of 0 "
                        "to 100 percent",
                        i + 1));
        return;
      }
      places_[entry["name"].get<std::string>()] = *place;
    }
  }

  // Nothing unless `value` is a list of `count` numbers within +-1e6.
  static std::optional<std::vector<double>> ReadNumbers(const json& value, std::size_t count) {
    if (!value.is_array() || value.size() != count) return std::nullopt;
    std::vector<double> numbers;
    for (const json& element : value) {
      if (!element.is_number() || std::abs(element.get<double>()) > kMaxMagnitude) return std::nullopt;
      numbers.push_back(element.get<double>());
    }
    return numbers;
  }

  static std::optional<Place> ReadPlace(const json& value) {
    const std::optional<std::vector<double>> n = ReadNumbers(value, 4);
    if (!n || (*n)[3] < 0.0 || (*n)[3] > 100.0) return std::nullopt;
    return Place{(*n)[0], (*n)[1], (*n)[2], (*n)[3]};
  }

  Status AddStep(const json& step) {
    if (!step.is_object() || step.size() != 1) return PlanError("expected an object with one key");
    const std::string key = step.begin().key();
    const json& value = step.begin().value();
    if (key == "take" || key == "put") return AddTrip(key == "take", value);
    if (key == "go_to") {
      const std::optional<std::vector<double>> point = ReadNumbers(value, 2);
      if (!point) return PlanError("'go_to' expects [x, y]");
      plan_.steps.push_back({FetchAction::kGoTo, 0.0, (*point)[0], (*point)[1]});
      return {};
    }
    if (key == "gripper") {
      if (value != "open" && value != "close") return PlanError("'gripper' expects \"open\" or \"close\"");
      AddFingers(value == "open");
      return {};
    }
    return AddNumberStep(key, value);
  }

  // A step whose value is a number.
  Status AddNumberStep(const std::string& key, const json& value) {
    struct Kind {
      FetchAction action;
      Interval allowed;
    };
    const std::map<std::string, Kind> kinds{{"drive", {FetchAction::kDrive, {-kMaxMagnitude, kMaxMagnitude}}},
                                            {"push", {FetchAction::kPush, {-kMaxMagnitude, kMaxMagnitude}}},
                                            {"lift", {FetchAction::kLift, {0.0, 100.0}}},
                                            {"turn_to", {FetchAction::kTurnTo, {-kMaxMagnitude, kMaxMagnitude}}},
                                            {"wait", {FetchAction::kWait, {0.0, 1e9}}},
                                            {"wait_until", {FetchAction::kWaitUntil, {0.0, 1e9}}}};
    const auto found = kinds.find(key);
    if (found == kinds.end()) {
      return PlanError(
          "found another key, expected one of: drive, go_to, gripper, lift, push, put, take, turn_to, wait, "
          "wait_until");
    }
    const auto& [action, allowed] = found->second;
    const double number = value.is_number() ? value.get<double>() : std::nan("");
    if (!(number >= allowed.min && number <= allowed.max)) {
      return PlanError(fmt::format("'{}' expects a number from {} to {}", key, allowed.min, allowed.max));
    }
    Add(action, number);
    return {};
  }

  // The place named by `value`, or given as numbers.
  Result<Place> FindPlace(const json& value) const {
    if (value.is_string()) {
      const auto found = places_.find(value.get<std::string>());
      if (found == places_.end()) return PlanError("names a place that is not in 'places'");
      return found->second;
    }
    if (const std::optional<Place> place = ReadPlace(value)) return *place;
    return PlanError("expected the name of a place, or [x, y, heading, lift] with a lift of 0 to 100 percent");
  }

  // To a place and away from it again, with a straight approach and retreat.
  Status AddTrip(bool take, const json& value) {
    const Result<Place> found = FindPlace(value);
    if (!found.ok()) return found.error();
    const Place& place = found.value();
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
    return {};
  }

  void AddFingers(bool open) {
    Add(open ? FetchAction::kOpen : FetchAction::kClose, 0.0);
    plan_.needs_gripper = true;
  }
  void Add(FetchAction action, double value) {
    plan_.steps.push_back({action, value, 0.0, 0.0});
    if (action == FetchAction::kLift) plan_.needs_lift = true;
  }

  NestedParameters& reader_;
  FetchPlan plan_;
  std::map<std::string, Place> places_;
  double reach_ = 0.4;     // m, from the robot's origin to the centre of the object
  double approach_ = 0.5;  // m, straight before a place
  double raise_ = 5.0;     // percent, above a place
  double travel_ = 5.0;    // percent, between places
};

}  // namespace

Result<FetchPlan> ParseFetchPlan(const std::string& parameters) {
  NestedParameters reader("fetch", parameters);
  FetchPlan plan = Planner(reader).Read();
  if (Status status = reader.Finish(); !status.ok()) return status.error();
  return plan;
}

}  // namespace troupe
