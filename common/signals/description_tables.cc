// The tables of what only the description has: levels, lanes and sensors. Their signals are functions of a state, like
// those of its own tables: how many bodies are on a level or a lane, whether a sensor measures at this tick. What a
// sensor reads is not among them: a reading is measured, which costs a search of the world, so each view measures only
// the sensors that it needs.
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <variant>

#include "common/model/lane_rules.h"
#include "common/model/states.h"
#include "common/signals/state_tables.h"

namespace troupe {
namespace {

// Adds the numbers of robots, objects and people for whose poses is_there(view, row of the table, X_WB) is true.
template <typename IsThere>
void AddCounts(StateTable& table, const char* documentation, IsThere is_there) {
  const auto add = [&](const char* name, std::size_t (*kind)(), auto bodies, auto pose) {
    table.AddNumber(name, "", documentation, [=](const SignalView& view, std::size_t row) {
      double count = 0.0;
      ThingId thing = view.things.first(kind());
      for (const auto& body : view.state.*bodies) {
        if (view.things.exists(thing++) && !IsAway(body.*pose) && is_there(view, row, body.*pose)) count += 1.0;
      }
      return count;
    });
  };
  add("robots", &RobotKind, &WorldState::robots, &RobotState::X_WR);
  add("objects", &ObjectKind, &WorldState::objects, &ObjectState::X_WO);
  add("people", &PersonKind, &WorldState::people, &PersonState::X_WP);
}

StateTable MakeLevels() {
  StateTable table{"levels", "level"};
  table.rows = [](const WorldDescription& world, const WorldState&) { return world.levels.size(); };
  table.AddNumber("z", "m", "of its floor",
                  [](const SignalView& view, std::size_t row) { return view.world.levels[row].z; });
  AddCounts(table, "number of them whose nearest level it is",
            [](const SignalView& view, std::size_t row, const Pose& X_WB) {
              return LevelNumberAt(view.world.levels, X_WB.z) == row;
            });
  return table;
}

const LaneGraph& GraphOf(const SignalView& view, std::size_t row) {
  return view.world.lane_graphs[view.things.lanes()[row].graph];
}
const WholeLane& LaneOf(const SignalView& view, std::size_t row) {
  return view.things.lanes()[row].lane;
}

bool IsOnLane(const SignalView& view, std::size_t row, const Pose& X_WB) {
  const LaneGraph& graph = GraphOf(view, row);
  const WholeLane& lane = LaneOf(view, row);
  const LaneVertex& start = graph.vertices[lane.start];
  const Vec2 way = graph.Way(lane.start, lane.end);
  const Vec2 to = X_WB.translation() - start.position;
  const double squared = way.x() * way.x() + way.y() * way.y();
  const double share = squared > 0.0 ? std::clamp((to.x() * way.x() + to.y() * way.y()) / squared, 0.0, 1.0) : 0.0;
  const double dx = to.x() - share * way.x();
  const double dy = to.y() - share * way.y();
  if (dx * dx + dy * dy > kLaneHalfWidth * kLaneHalfWidth) return false;
  return LevelNumberAt(view.world.levels, X_WB.z) == LevelNumberAt(view.world.levels, start.z);
}

StateTable MakeLanes() {
  StateTable table{"lanes", "lane"};
  table.rows = [](const WorldDescription& world, const WorldState&) {
    std::size_t rows = 0;
    for (const LaneGraph& graph : world.lane_graphs) {
      // Each waiting point makes one lane two.
      rows += graph.lanes.size() -
              static_cast<std::size_t>(std::count_if(graph.vertices.begin(), graph.vertices.end(),
                                                     [](const LaneVertex& vertex) { return vertex.is_between; }));
    }
    return rows;
  };
  table.AddNumber("length", "m", "from its start to its end", [](const SignalView& view, std::size_t row) {
    const WholeLane& lane = LaneOf(view, row);
    return GraphOf(view, row).Way(lane.start, lane.end).norm();
  });
  AddCounts(table, "number of them on its level with the origin within 0.5 m of its line", IsOnLane);
  table.AddTruth(
      "open", "all doors that it passes are as far open as they can be", [](const SignalView& view, std::size_t row) {
        const auto is_open = [&](const LaneDoor& door) { return view.state.doors[door.door].opening == 1.0; };
        const std::vector<std::uint32_t>& parts = LaneOf(view, row).parts;
        return std::all_of(parts.begin(), parts.end(), [&](std::uint32_t part) {
          const std::vector<LaneDoor>& doors = GraphOf(view, row).lanes[part].doors;
          return std::all_of(doors.begin(), doors.end(), is_open);
        });
      });
  table.AddTruth("barred", "an operator has closed it, or a keepout or release zone that is on is on it",
                 [](const SignalView& view, std::size_t row) {
                   const LaneRow& lane = view.things.lanes()[row];
                   return std::any_of(lane.lane.parts.begin(), lane.lane.parts.end(), [&](std::uint32_t part) {
                     return IsLaneClosed(view.world, view.state, static_cast<std::uint32_t>(lane.first + part));
                   });
                 });
  AddWaitSignals(table);
  return table;
}

const SensorDescription& SensorOf(const SignalView& view, std::size_t row) {
  const SensorPlace& place = view.things.sensors()[row];
  return view.world.robot(place.robot).sensors[place.sensor];
}

StateTable MakeSensors() {
  StateTable table{"sensors", "sensor"};
  table.of_robots = true;
  table.rows = [](const WorldDescription& world, const WorldState&) {
    std::size_t rows = 0;
    for (const RobotDescription& robot : world.robots) rows += robot.sensors.size();
    return rows;
  };
  Signal type{"type", "", "of sensor, such as ranger or bumper", ValueType::kText, {}};
  type.number = [](const SignalView& view, std::size_t row) {
    return static_cast<double>(SensorOf(view, row).parameters.index());
  };
  type.text = [](const SignalView& view, std::size_t row) {
    return std::string(TypeOf(SensorOf(view, row).parameters));
  };
  type.possible = [](const WorldDescription&) {
    return []<std::size_t... kIndex>(std::index_sequence<kIndex...>) {
      return std::vector<std::string>{std::string(std::variant_alternative_t<kIndex, SensorParameters>::kType)...};
    }
    (std::make_index_sequence<std::variant_size_v<SensorParameters>>());
  };
  table.signals.push_back(std::move(type));
  table.AddNumber("period", "tick", "from one measurement to the next", [](const SignalView& view, std::size_t row) {
    return static_cast<double>(SensorOf(view, row).period_ticks);
  });
  table.AddTruth("due", "it measures at this tick", [](const SignalView& view, std::size_t row) {
    return view.state.tick % SensorOf(view, row).period_ticks == 0;
  });
  return table;
}

}  // namespace

std::size_t LevelNumberAt(std::span<const LevelDescription> levels, double z) {
  std::size_t nearest = 0;
  for (std::size_t i = 1; i < levels.size(); ++i) {
    if (std::fabs(levels[i].z - z) < std::fabs(levels[nearest].z - z)) nearest = i;
  }
  return nearest;
}

std::vector<LaneRow> FindLanes(const WorldDescription& world) {
  std::vector<LaneRow> lanes;
  std::size_t first = 0;
  for (std::size_t graph = 0; graph < world.lane_graphs.size(); ++graph) {
    for (WholeLane& lane : WholeLanesOf(world.lane_graphs[graph])) lanes.push_back({graph, first, std::move(lane)});
    first += world.lane_graphs[graph].lanes.size();
  }
  return lanes;
}

std::vector<SensorPlace> FindSensors(const WorldDescription& world) {
  std::vector<SensorPlace> sensors;
  for (std::size_t robot = 0; robot < world.robots.size(); ++robot) {
    for (std::size_t i = 0; i < world.robots[robot].sensors.size(); ++i) sensors.push_back({RobotId(robot), i});
  }
  return sensors;
}

std::vector<StateTable> MakeDescriptionTables() {
  std::vector<StateTable> tables;
  tables.push_back(MakeLevels());
  tables.push_back(MakeLanes());
  tables.push_back(MakeSensors());
  return tables;
}

std::vector<std::vector<ThingName>> NameDescribedThings(const WorldDescription& world) {
  std::vector<std::vector<ThingName>> names(3);
  for (const LevelDescription& level : world.levels) names[0].push_back({level.name});
  for (const LaneRow& place : FindLanes(world)) {
    names[1].push_back({NameOfLane(world.lane_graphs[place.graph], place.lane)});
  }
  for (const SensorPlace& place : FindSensors(world)) {
    const RobotDescription& robot = world.robot(place.robot);
    names[2].push_back({robot.name + "." + robot.sensors[place.sensor].name, robot.root, place.robot});
  }
  return names;
}

}  // namespace troupe
