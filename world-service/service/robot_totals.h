// RobotTotals: distance, contacts and goals of each robot in a run, its traffic, the goods of its flows and the cover
// of its cleaning zones, for the summary: an observer that adds them up.
//
// Counts begin at the newest fresh start, and at the start of a service that continues a run: totals are not
// journalled, because they matter to readers of the summary only and would grow every record. Edits move robots without
// driving, so the distance of an edited frame is left out. Costs one pass over the robots per tick, without allocation.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/signals/traffic_totals.h"
#include "common/spatial/scene.h"
#include "troupe/fields.h"
#include "world-service/service/run_observer.h"

namespace troupe {

// What one robot did.
struct RobotTotal {
  std::string robot;
  double distance = 0.0;                // m, driven; edits of users do not count
  std::uint64_t stalls = 0;             // motions that a contact cut short
  std::vector<std::string> contacts;    // the obstacles of these, the most frequent first; at most kMaxContacts
  std::uint64_t grips = 0;              // objects that it has gripped
  std::uint64_t goals = 0;              // that users sent
  std::uint64_t goals_reached = 0;      // of them
  std::optional<double> joules = {};    // J, in its stores at the end; without a store, or with an endless one: none
  std::optional<double> capacity = {};  // J; as above
  bool operator==(const RobotTotal&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"robot", &RobotTotal::robot},       Field{"distance", &RobotTotal::distance},
        Field{"stalls", &RobotTotal::stalls},     Field{"contacts", &RobotTotal::contacts},
        Field{"grips", &RobotTotal::grips},       Field{"goals", &RobotTotal::goals},
        Field{"joules", &RobotTotal::joules},     Field{"goals_reached", &RobotTotal::goals_reached},
        Field{"capacity", &RobotTotal::capacity},
    };
  }
};

// The goods of a flow, from tick 0 on.
struct FlowTotal {
  std::string flow;
  std::uint64_t arrived = 0;
  std::uint64_t refused = 0;
  std::uint64_t delivered = 0;
  std::uint64_t late = 0;     // of the delivered ones
  double lateness = 0.0;      // s, the mean of these
  double per_hour = 0.0;      // delivered in an hour of simulated time
  std::uint64_t waiting = 0;  // for a robot, at the end
  bool operator==(const FlowTotal&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"flow", &FlowTotal::flow},         Field{"arrived", &FlowTotal::arrived},
        Field{"refused", &FlowTotal::refused},   Field{"delivered", &FlowTotal::delivered},
        Field{"late", &FlowTotal::late},         Field{"lateness", &FlowTotal::lateness},
        Field{"per_hour", &FlowTotal::per_hour}, Field{"waiting", &FlowTotal::waiting},
    };
  }
};

// A cleaning zone at the end.
struct CleaningTotal {
  std::string zone;
  double share = 0.0;  // of its cells, on which robots were; from 0 to 1
  bool operator==(const CleaningTotal&) const = default;
  static constexpr auto Fields() {
    return std::tuple{Field{"zone", &CleaningTotal::zone}, Field{"share", &CleaningTotal::share}};
  }
};

class RobotTotals : public RunObserver {
 public:
  static constexpr std::size_t kMaxContacts = 5;
  static constexpr double kGoalReached = 0.3;  // m, from the last waypoint of a goal

  Status OnBegin(const RunStart& start) override;
  void OnWorldChange(const std::shared_ptr<const Scene>& scene, Edition edition) override;
  Status OnTick(const CommittedTick& tick) override;

  // Of the first robots that exist, in id order; after the run.
  std::vector<RobotTotal> Collect(std::size_t most) const;
  std::vector<FlowTotal> CollectFlows() const;
  std::vector<CleaningTotal> CollectCleaning() const;
  TrafficTotal traffic() const { return traffic_.total(); }
  // The places with the most waiting, so many of each kind; after the run.
  std::vector<PlaceWaits> FindWaits(std::size_t most_of_kind) const;
  // The tick at which they begin: that of the newest start, or at which a service continued the run.
  Tick since() const { return since_.value_or(0); }

 private:
  struct Counts {
    double distance = 0.0;
    std::uint64_t stalls = 0;
    std::uint64_t grips = 0;
    std::map<ModelId, std::uint64_t> contacts;  // by the root of the obstacle
    std::uint32_t goal = 0;                     // number of the newest
    std::uint64_t goals = 0;
    std::uint64_t goals_reached = 0;
    bool is_reached = false;  // the newest
    Vec2 position = {};       // m, W, at the newest tick
  };

  void Count(const Event& event);
  void Count(const RobotCommand& command);

  std::shared_ptr<const Scene> scene_;
  std::optional<Tick> since_;
  std::vector<Counts> robots_;  // by RobotId
  // At the newest tick.
  Tick tick_ = 0;
  std::vector<StoreState> stores_;
  std::vector<FlowState> flows_;
  std::vector<std::uint64_t> waiting_;  // goods, by flow
  std::vector<ZoneState> zones_;
  TrafficTotals traffic_;
};

}  // namespace troupe
