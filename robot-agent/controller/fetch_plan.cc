#include "robot-agent/controller/fetch_plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>

#include "common/base/deterministic_math.h"
#include "robot-agent/controller/parameters.h"

namespace troupe {
namespace {

using nlohmann::json;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Where an object is, or is to be: its centre, from which side a robot comes, and how high its gripper is then.
struct Place {
  double x = 0.0;        // m
  double y = 0.0;
  double heading = 0.0;  // rad, of the robot
  double lift = 0.0;     // percent
};

// Reads the steps, and writes the actions that they stand for.
class Planner {
 public:
  Planner(Parameters& reader, FetchPlan& plan) : reader_(reader), plan_(plan) {}

  void Read() {
    reader_.ReadNumber("speed", {0.0, kInfinity}, plan_.speed);
    reader_.ReadNumber("turn_rate", {0.0, kInfinity}, plan_.turn_rate);
    reader_.ReadNumber("reach", {0.0, kInfinity}, reach_);
    reader_.ReadNumber("approach", {0.0, kInfinity}, approach_);
    reader_.ReadNumber("raise", {0.0, 100.0}, raise_);
    reader_.ReadNumber("travel", {0.0, 100.0}, travel_);
    ReadPlaces();
    const std::vector<json> steps = reader_.ReadArray("steps");
    if (steps.empty()) reader_.Fail("'steps' is missing or empty, expected a list of steps");
    for (std::size_t i = 0; i < steps.size() && reader_.error().empty(); ++i) {
      if (const std::string problem = AddStep(steps[i]); !problem.empty()) {
        reader_.Fail(fmt::format("step {}: {}", i + 1, problem));
      }
    }
  }

 private:
  void ReadPlaces() {
    const std::vector<json> places = reader_.ReadArray("places");
    for (std::size_t i = 0; i < places.size(); ++i) {
      const json& entry = places[i];
      Place place;
      const bool has_form = entry.is_object() && entry.size() == 2 && entry.contains("name") &&
                            entry["name"].is_string() && entry.contains("at");
      if (!has_form || !ReadPlace(entry["at"], place)) {
        reader_.Fail(fmt::format("place {}: expected {{\"name\": \"...\", \"at\": [x, y, heading, lift]}}, with a lift of 0 "
                                 "to 100 percent",
                                 i + 1));
        return;
      }
      places_[entry["name"].get<std::string>()] = place;
    }
  }

  static bool ReadNumbers(const json& value, std::size_t count, std::vector<double>& numbers) {
    if (!value.is_array() || value.size() != count) return false;
    for (const json& element : value) {
      if (!element.is_number()) return false;
      numbers.push_back(element.get<double>());
    }
    return std::all_of(numbers.begin(), numbers.end(), [](double n) { return std::abs(n) <= 1e6; });
  }

  static bool ReadPlace(const json& value, Place& place) {
    std::vector<double> n;
    if (!ReadNumbers(value, 4, n) || n[3] < 0.0 || n[3] > 100.0) return false;
    place = {n[0], n[1], n[2], n[3]};
    return true;
  }

  // "" or what is wrong.
  std::string AddStep(const json& step) {
    if (!step.is_object() || step.size() != 1) return "expected an object with one key";
    const std::string key = step.begin().key();
    const json& value = step.begin().value();
    if (key == "take" || key == "put") return AddTrip(key == "take", value);
    if (key == "go_to") {
      std::vector<double> point;
      if (!ReadNumbers(value, 2, point)) return "'go_to' expects [x, y]";
      plan_.steps.push_back({FetchAction::kGoTo, 0.0, point[0], point[1]});
      return "";
    }
    if (key == "gripper") {
      if (value != "open" && value != "close") return "'gripper' expects \"open\" or \"close\"";
      AddFingers(value == "open");
      return "";
    }
    struct Kind {
      FetchAction action;
      double min;
      double max;
    };
    const std::map<std::string, Kind> kinds{{"drive", {FetchAction::kDrive, -1e6, 1e6}},
                                            {"push", {FetchAction::kPush, -1e6, 1e6}},
                                            {"lift", {FetchAction::kLift, 0.0, 100.0}},
                                            {"turn_to", {FetchAction::kTurnTo, -1e6, 1e6}},
                                            {"wait", {FetchAction::kWait, 0.0, 1e9}},
                                            {"wait_until", {FetchAction::kWaitUntil, 0.0, 1e9}}};
    const auto found = kinds.find(key);
    if (found == kinds.end()) {
      return "found another key, expected one of: drive, go_to, gripper, lift, push, put, take, turn_to, wait, wait_until";
    }
    const Kind& kind = found->second;
    const double number = value.is_number() ? value.get<double>() : std::nan("");
    if (!(number >= kind.min && number <= kind.max)) {
      return fmt::format("'{}' expects a number from {} to {}", key, kind.min, kind.max);
    }
    Add(kind.action, number);
    return "";
  }

  // To a place and away from it again, with a straight way in and out.
  std::string AddTrip(bool take, const json& value) {
    Place place;
    if (value.is_string()) {
      const auto found = places_.find(value.get<std::string>());
      if (found == places_.end()) return "names a place that is not in 'places'";
      place = found->second;
    } else if (!ReadPlace(value, place)) {
      return "expected the name of a place, or [x, y, heading, lift] with a lift of 0 to 100 percent";
    }
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
    return "";
  }

  void AddFingers(bool open) {
    Add(open ? FetchAction::kOpen : FetchAction::kClose, 0.0);
    plan_.needs_gripper = true;
  }
  void Add(FetchAction action, double value) {
    plan_.steps.push_back({action, value, 0.0, 0.0});
    if (action == FetchAction::kLift) plan_.needs_lift = true;
  }

  Parameters& reader_;
  FetchPlan& plan_;
  std::map<std::string, Place> places_;
  double reach_ = 0.4;      // m, from the robot's origin to the middle of what it takes
  double approach_ = 0.5;   // m, straight before a place
  double raise_ = 5.0;      // percent, above a place
  double travel_ = 5.0;     // percent, between places
};

}  // namespace

std::string ParseFetchPlan(const std::string& parameters, FetchPlan& plan) {
  Parameters reader("fetch", parameters);
  Planner(reader, plan).Read();
  return reader.Finish();
}

}  // namespace troupe
