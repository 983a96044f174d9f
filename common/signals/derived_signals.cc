// The signals that follow from the fields of a row. One that is added here is in all users' views.
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "common/model/states.h"
#include "common/model/zones.h"
#include "common/signals/state_tables.h"

namespace troupe {
namespace {

// The level of a height, by its number and by its name.
template <typename Height>
void AddLevel(StateTable& table, Height height) {
  Signal signal{"level", "", "the level of the building nearest to its height", ValueType::kText, {}};
  signal.number = [height](const SignalView& view, std::size_t row) {
    if (IsAway(Pose{0.0, 0.0, height(view.state, row), 0.0})) return kNoNumber;
    return static_cast<double>(LevelNumberAt(view.world.levels, height(view.state, row)));
  };
  signal.text = [height](const SignalView& view, std::size_t row) {
    if (IsAway(Pose{0.0, 0.0, height(view.state, row), 0.0})) return std::string();
    return LevelAt(view.world.levels, height(view.state, row));
  };
  signal.possible = [](const WorldDescription& world) {
    std::vector<std::string> names;
    for (const LevelDescription& level : world.levels) names.push_back(level.name);
    if (names.empty()) names.push_back(LevelAt({}, 0.0));
    return names;
  };
  table.Add(std::move(signal));
}

double SumOfStores(const SignalView& view, std::size_t robot, double StoreState::*part) {
  const std::vector<std::size_t>& stores = view.things.stores_of(RobotId(robot));
  if (stores.empty()) return kNoNumber;
  double sum = 0.0;
  for (const std::size_t store : stores) sum += view.state.stores[store].*part;
  return sum;
}

const PowerDescription& PowerOf(const SignalView& view, std::size_t store) {
  static const std::size_t kStores = KindOf("stores");
  const ThingId thing = view.things.first(kStores) + static_cast<ThingId>(store);
  return view.world.model(view.things.model(thing).value()).power;
}

double Capacity(const SignalView& view, std::size_t robot) {
  const std::vector<std::size_t>& stores = view.things.stores_of(RobotId(robot));
  if (stores.empty()) return kNoNumber;
  double sum = 0.0;
  for (const std::size_t store : stores) sum += PowerOf(view, store).capacity;
  return sum;
}

void AddOfStores(StateTable& table) {
  table.AddNumber("capacity", "J", "the most that it can have; none of an endless store",
                  [](const SignalView& view, std::size_t row) {
                    const PowerDescription& power = PowerOf(view, row);
                    return power.endless ? kNoNumber : power.capacity;
                  });
}

const TrafficRobot* TrafficOf(const SignalView& view, std::size_t robot) {
  const std::vector<TrafficRobot>& rows = view.state.traffic_robots;
  const auto row = std::lower_bound(rows.begin(), rows.end(), RobotId(robot),
                                    [](const TrafficRobot& a, RobotId b) { return a.robot < b; });
  return row != rows.end() && row->robot == RobotId(robot) ? &*row : nullptr;
}

// Of robots that take no part, too, which do not wait and have not arrived.
void AddOfTraffic(StateTable& table) {
  table.AddNumber("waiting", "s", "since it stands on its way in the planned traffic of lanes",
                  [](const SignalView& view, std::size_t row) {
                    const TrafficRobot* const robot = TrafficOf(view, row);
                    return robot ? static_cast<double>(robot->waiting) * view.world.interval_seconds() : 0.0;
                  });
  table.AddNumber("arrivals", "", "goals that it has reached in the planned traffic of lanes",
                  [](const SignalView& view, std::size_t row) {
                    const TrafficRobot* const robot = TrafficOf(view, row);
                    return robot ? static_cast<double>(robot->arrivals) : 0.0;
                  });
  Signal waits_for{
      "waits_for", "", "the robot after which it goes on in the planned traffic of lanes", ValueType::kText, {}};
  waits_for.number = [](const SignalView& view, std::size_t row) {
    const TrafficRobot* const robot = TrafficOf(view, row);
    return robot && robot->waits_for ? static_cast<double>(robot->waits_for->index()) : kNoNumber;
  };
  waits_for.text = [](const SignalView& view, std::size_t row) {
    const TrafficRobot* const robot = TrafficOf(view, row);
    return robot && robot->waits_for ? view.world.robot(*robot->waits_for).name : std::string();
  };
  table.Add(std::move(waits_for));
}

void AddOfRobots(StateTable& table) {
  table.AddNumber("speed", "m/s", "over the ground during the tick that ended, never negative",
                  [](const SignalView& view, std::size_t row) {
                    const Twist& twist = view.state.robots[row].twist;
                    return std::sqrt(twist.vx * twist.vx + twist.vy * twist.vy);
                  });
  AddLevel(table, [](const WorldState& state, std::size_t row) { return state.robots[row].X_WR.z; });
  table.AddNumber("energy", "J", "in its stores of energy that can become empty",
                  [](const SignalView& view, std::size_t row) { return SumOfStores(view, row, &StoreState::joules); });
  table.AddNumber("capacity", "J", "the most that its stores can have", Capacity);
  table.AddNumber(
      "charging", "W", "power that its stores have received during the tick that ended",
      [](const SignalView& view, std::size_t row) { return SumOfStores(view, row, &StoreState::charge_watts); });
  AddOfTraffic(table);
}

void AddOfObjects(StateTable& table) {
  const auto add_mode = [&](const char* name, const char* documentation, ObjectMode mode) {
    table.AddTruth(name, documentation,
                   [mode](const SignalView& view, std::size_t row) { return view.state.objects[row].mode == mode; });
  };
  add_mode("falling", "it falls", ObjectMode::kFalling);
  add_mode("resting", "it has come to rest on a support or on the ground after a fall or a motion",
           ObjectMode::kResting);
  AddLevel(table, [](const WorldState& state, std::size_t row) { return state.objects[row].X_WO.z; });
  Signal on{"on", "", "the model that supports or holds it", ValueType::kText, {}};
  on.number = [](const SignalView& view, std::size_t row) {
    const std::optional<ModelId> carrier = CarrierOf(view.world, view.state.objects[row]);
    return carrier ? static_cast<double>(carrier->index()) : kNoNumber;
  };
  on.text = [](const SignalView& view, std::size_t row) {
    const std::optional<ModelId> carrier = CarrierOf(view.world, view.state.objects[row]);
    return carrier ? view.world.model(*carrier).name : std::string();
  };
  table.Add(std::move(on));
}

void AddOfDoors(StateTable& table) {
  table.AddTruth("open", "it is as far open as it can be",
                 [](const SignalView& view, std::size_t row) { return view.state.doors[row].opening == 1.0; });
  table.AddTruth("closed", "it is closed",
                 [](const SignalView& view, std::size_t row) { return view.state.doors[row].opening == 0.0; });
}

// The name of a floor of a lift, and its number: `lift` is from 1 on; 0: none.
Signal FloorSignal(const char* documentation,
                   std::function<std::pair<std::size_t, std::uint32_t>(const WorldState&, std::size_t)> find) {
  Signal signal{"floor", "", documentation, ValueType::kText, {}};
  signal.number = [find](const SignalView& view, std::size_t row) {
    const auto [lift, floor] = find(view.state, row);
    return lift == 0 ? kNoNumber : static_cast<double>(floor);
  };
  signal.text = [find](const SignalView& view, std::size_t row) {
    const auto [lift, floor] = find(view.state, row);
    return lift == 0 ? std::string() : view.world.lifts[lift - 1].floors[floor].name;
  };
  signal.possible = [](const WorldDescription& world) {
    std::vector<std::string> names;
    for (const LiftDescription& lift : world.lifts) {
      for (const LiftFloor& floor : lift.floors) names.push_back(floor.name);
    }
    return names;
  };
  return signal;
}

bool StandsAtFloor(const SignalView& view, std::size_t row) {
  const LiftState& lift = view.state.lifts[row];
  return lift.z == view.world.lifts[row].floors[lift.floor].z;
}

void AddOfLifts(StateTable& table) {
  table.Add(FloorSignal("the floor that it moves to or stands at", [](const WorldState& state, std::size_t row) {
    return std::pair(row + 1, state.lifts[row].floor);
  }));
  table.AddTruth("stands", "its cabin stands at its floor", StandsAtFloor);
  table.AddTruth("open", "its cabin stands at its floor, and all doors there are open",
                 [](const SignalView& view, std::size_t row) {
                   if (!StandsAtFloor(view, row)) return false;
                   const LiftFloor& floor = view.world.lifts[row].floors[view.state.lifts[row].floor];
                   return std::all_of(floor.doors.begin(), floor.doors.end(),
                                      [&](std::size_t door) { return view.state.doors[door].opening == 1.0; });
                 });
  AddLevel(table, [](const WorldState& state, std::size_t row) { return state.lifts[row].z; });
}

void AddOfPeople(StateTable& table) {
  table.AddNumber("speed", "m/s", "over the ground during the tick that ended, never negative",
                  [](const SignalView& view, std::size_t row) {
                    const PersonState& person = view.state.people[row];
                    return std::sqrt(person.vx * person.vx + person.vy * person.vy);
                  });
  table.AddTruth("present", "it is in the world; false for a visitor that is away",
                 [](const SignalView& view, std::size_t row) { return !IsAway(view.state.people[row]); });
  AddLevel(table, [](const WorldState& state, std::size_t row) { return state.people[row].X_WP.z; });
  table.Add(FloorSignal("the floor to which it rides", [](const WorldState& state, std::size_t row) {
    return std::pair(std::size_t{state.people[row].lift}, state.people[row].floor);
  }));
  // The field counts from 1 on.
  const auto add_part = [&](const char* name, const char* documentation, std::uint32_t PersonState::*part,
                            const auto& model_of) {
    Signal signal{name, "", documentation, ValueType::kText, {}};
    signal.number = [part](const SignalView& view, std::size_t row) {
      const std::uint32_t number = view.state.people[row].*part;
      return number == 0 ? kNoNumber : static_cast<double>(number - 1);
    };
    signal.text = [part, model_of](const SignalView& view, std::size_t row) {
      const std::uint32_t number = view.state.people[row].*part;
      return number == 0 ? std::string() : view.world.model(model_of(view.world, number - 1)).name;
    };
    table.Add(std::move(signal));
  };
  add_part("door", "the door that it asks for", &PersonState::door,
           [](const WorldDescription& world, std::size_t door) { return world.doors[door].model; });
  add_part("lift", "the lift that it has called or rides", &PersonState::lift,
           [](const WorldDescription& world, std::size_t lift) { return world.lifts[lift].model; });
}

void AddOfZones(StateTable& table) {
  table.AddNumber("share", "",
                  "of the cells of a cleaning zone on which robots were, from 0 to 1; none of another zone",
                  [](const SignalView& view, std::size_t row) {
                    const std::size_t cells = view.things.cells_of(row);
                    if (cells == 0) return kNoNumber;
                    return static_cast<double>(view.state.zones[row].covered) / static_cast<double>(cells);
                  });
  table.AddNumber("people", "", "in its area, on its level", [](const SignalView& view, std::size_t row) {
    const ZoneDescription& zone = view.world.zones[row];
    std::size_t inside = 0;
    for (std::size_t i = 0; i < view.state.people.size(); ++i) {
      const Pose& X_WP = view.state.people[i].X_WP;
      const bool is_there = !IsAway(X_WP) && !view.world.model(view.world.people[i].root).removed;
      if (is_there && IsInZone(view.world, zone, X_WP.translation(), X_WP.z)) ++inside;
    }
    return static_cast<double>(inside);
  });
}

void AddOfFlows(StateTable& table) {
  table.AddNumber("waiting", "", "goods that no robot has loaded yet", [](const SignalView& view, std::size_t row) {
    return static_cast<double>(std::count_if(view.state.jobs.begin(), view.state.jobs.end(),
                                             [&](const Job& job) { return job.flow == row && !job.is_loaded; }));
  });
  table.AddNumber("per_hour", "", "goods delivered so far in an hour of simulated time",
                  [](const SignalView& view, std::size_t row) {
                    const double seconds = static_cast<double>(view.state.tick) * view.world.interval_seconds();
                    return seconds > 0.0 ? 3600.0 * view.state.flows[row].delivered / seconds : 0.0;
                  });
  table.AddNumber("mean_lateness", "s", "of the late ones of the delivered goods, 0 without any",
                  [](const SignalView& view, std::size_t row) {
                    const FlowState& flow = view.state.flows[row];
                    if (flow.late == 0) return 0.0;
                    return static_cast<double>(flow.lateness) * view.world.interval_seconds() / flow.late;
                  });
}

// The flow of the goods that a robot is to bring, and whether it has them.
void AddOfGoods(StateTable& table) {
  const auto job_of = [](const SignalView& view, std::size_t robot) -> const Job* {
    for (const Job& job : view.state.jobs) {
      if (job.robot == RobotId(robot)) return &job;
    }
    return nullptr;
  };
  Signal goods{"goods", "", "the flow of the goods that it is to bring", ValueType::kText, {}};
  goods.number = [job_of](const SignalView& view, std::size_t row) {
    const Job* const job = job_of(view, row);
    return job != nullptr ? static_cast<double>(job->flow) : kNoNumber;
  };
  goods.text = [job_of](const SignalView& view, std::size_t row) {
    const Job* const job = job_of(view, row);
    return job != nullptr ? view.world.flows[job->flow].name : std::string();
  };
  table.Add(std::move(goods));
  table.AddTruth("loaded", "it has goods of a flow", [job_of](const SignalView& view, std::size_t row) {
    const Job* const job = job_of(view, row);
    return job != nullptr && job->is_loaded;
  });
  table.AddTruth("wants_charge", "it goes to a charger on its lanes, is at one, or waits for one",
                 [](const SignalView& view, std::size_t row) {
                   const std::vector<ChargingRobot>& rows = view.state.charging_robots;
                   return std::any_of(rows.begin(), rows.end(),
                                      [&](const ChargingRobot& robot) { return robot.robot == RobotId(row); });
                 });
}

}  // namespace

void AddDerivedSignals(StateTable& table) {
  if (table.name == "robots") AddOfRobots(table);
  if (table.name == "robots") AddOfGoods(table);
  if (table.name == "zones") AddOfZones(table);
  if (table.name == "flows") AddOfFlows(table);
  if (table.name == "objects") AddOfObjects(table);
  if (table.name == "stores") AddOfStores(table);
  if (table.name == "doors") AddOfDoors(table);
  if (table.name == "lifts") AddOfLifts(table);
  if (table.name == "people") AddOfPeople(table);
  AddWaitSignals(table);
}

}  // namespace troupe
