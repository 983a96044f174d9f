// The outcome of a problem of paths, in the format of the League of Robot Runners: its visualiser draws it, and
// `troupe run --paths` follows it.
//
// A tick of the run is a tick of the League, in which a robot takes one action (agentMaxCounter 1): it moves when it
// arrives at a cell, has turned just before, and waits otherwise. So the order at each cell is that of the run.
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/base/file.h"
#include "common/model/lane_trips.h"
#include "launcher/export/run_export.h"
#include "worldfile/grids/grid_problem.h"

namespace troupe {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kSegmentTicks = 1000;

// A cell by the name of its vertex, "x5y16".
std::optional<GridCell> CellOf(std::string_view name) {
  GridCell cell;
  const char* at = name.data();
  const char* const end = at + name.size();
  for (auto [letter, number] : {std::pair('x', &cell.x), std::pair('y', &cell.y)}) {
    if (at == end || *at != letter) return std::nullopt;
    const auto read = std::from_chars(at + 1, end, *number);
    if (read.ec != std::errc()) return std::nullopt;
    at = read.ptr;
  }
  return at == end ? std::optional(cell) : std::nullopt;
}

// Row and column, as one direction of the League: 0 east, 1 south, 2 west, 3 north. Nothing: no neighbours.
std::optional<int> DirectionOf(const GridCell& from, const GridCell& to) {
  const auto dx = static_cast<std::int64_t>(to.x) - from.x;
  const auto dy = static_cast<std::int64_t>(to.y) - from.y;
  if (dx * dx + dy * dy != 1) return std::nullopt;
  return dx == 1 ? 0 : dx == -1 ? 2 : dy == 1 ? 1 : 3;
}

class LeagueExport final : public RunExport {
 public:
  LeagueExport(std::string output, std::string problem) : output_(std::move(output)), problem_(std::move(problem)) {}

  Status Add(const ReplayedWorld& world, std::uint64_t) override {
    const WorldDescription& description = world.world();
    if (robots_.empty()) {
      if (Status status = Begin(description); !status.ok()) return status;
    }
    if (!first_tick_) first_tick_ = world.state().tick;
    const Tick now = world.state().tick - *first_tick_;
    ticks_ = std::max<std::size_t>(ticks_, now);
    for (Robot& robot : robots_) {
      const TrafficRobot* const row = FindTrafficRobot(world.state().traffic_robots, robot.id);
      if (row == nullptr || row->at >= cells_.size() || cells_[row->at] == robot.last) continue;
      robot.last = cells_[row->at];
      robot.arrivals.emplace_back(now, robot.last);
      VisitGoals(robot);
    }
    return {};
  }

  Status Close() override {
    if (robots_.empty()) return Failure("found no robots of a problem of paths, expected some");
    Json json = {{"actionModel", "MAPF_T"},
                 {"version", "2026 LoRR"},
                 {"teamSize", robots_.size()},
                 {"numTaskFinished", 0},
                 {"sumOfCost", 0},
                 {"makespan", ticks_},
                 {"numPlannerErrors", 0},
                 {"numScheduleErrors", 0},
                 {"numEntryTimeouts", 0},
                 {"agentMaxCounter", 1},
                 {"outputSegmentSize", kSegmentTicks},
                 {"delayIntervals", Json::array()},
                 {"start", Json::array()},
                 {"actualPaths", Json::array()}};
    std::size_t cost = 0;
    for (const Robot& robot : robots_) {
      json["delayIntervals"].push_back(Json::array());
      json["start"].push_back(Json::array({robot.start.y, robot.start.x, "E"}));
      Result<std::string> path = PathOf(robot);
      if (!path.ok()) return path.error();
      json["actualPaths"].push_back(std::move(path).value());
      if (!robot.arrivals.empty()) cost += robot.arrivals.back().first;
    }
    json["sumOfCost"] = cost;
    AddTasks(json);
    json["plannerPaths"] = json["actualPaths"];
    json["plannerTimes"] = Json::array();
    json["errors"] = Json::array();
    json["plannerSchedule"] = json["actualSchedule"];
    json["scheduleErrors"] = Json::array();
    return WriteWholeFile(output_, json.dump() + "\n");
  }

 private:
  struct Robot {
    RobotId id;
    GridCell start;
    GridCell last;
    std::vector<std::pair<std::size_t, GridCell>> arrivals = {};  // ticks
    std::vector<GridCell> goals = {};
    std::vector<std::size_t> visits = {};  // ticks, by goal
  };

  Status Begin(const WorldDescription& world) {
    for (const LaneGraph& graph : world.lane_graphs) {
      for (const LaneVertex& vertex : graph.vertices) {
        const std::optional<GridCell> cell = CellOf(vertex.name);
        if (!cell) return BadInput("found a run without a map of cells, expected that of a problem of paths");
        cells_.push_back(*cell);
      }
    }
    if (world.lane_trips.empty()) return BadInput("found a run without agents, expected that of a problem of paths");
    for (const LaneTrip& trip : world.lane_trips) {
      Robot& robot = robots_.emplace_back();
      robot.id = trip.robot;
      for (const std::uint32_t goal : trip.goals) robot.goals.push_back(cells_[goal]);
      const Pose& X_WR = world.model(world.robot(trip.robot).root).X_PM;
      robot.start = robot.last = cells_[FindStart(world, X_WR)];
      VisitGoals(robot);
    }
    return {};
  }

  // The vertex at the place where the robot begins, by the order of all graphs.
  static std::size_t FindStart(const WorldDescription& world, const Pose& X_WR) {
    const LaneGraph* const graph = GraphAt(world.lane_graphs, X_WR);
    std::size_t first = 0;
    for (const LaneGraph& each : world.lane_graphs) {
      if (&each == graph) break;
      first += each.vertices.size();
    }
    return first + FindNearestVertex(*graph, X_WR.translation(), X_WR.z, kOnOneLevel)->vertex;
  }

  // Those that follow each other at one cell, too.
  void VisitGoals(Robot& robot) const {
    while (robot.visits.size() < robot.goals.size() && robot.goals[robot.visits.size()] == robot.last) {
      robot.visits.push_back(ticks_);
    }
  }

  // The error is that of a robot that has been moved by a tool.
  Result<std::string> PathOf(const Robot& robot) const {
    std::string actions(ticks_, 'W');
    std::size_t next = 0;  // the first free tick
    int direction = 0;
    GridCell at = robot.start;
    for (const auto& [tick, cell] : robot.arrivals) {
      const std::optional<int> wanted = DirectionOf(at, cell);
      if (!wanted) {
        return BadInput(fmt::format("found a robot that is at {} and then at {}, expected moves from cell to cell",
                                    ToString(at), ToString(cell)));
      }
      const int turn = (*wanted - direction + 4) % 4;
      const std::size_t turns = turn == 2 ? 2 : turn == 0 ? 0 : 1;
      const std::size_t move = std::max(next + turns, tick - 1);
      if (move >= actions.size()) actions.resize(move + 1, 'W');
      for (std::size_t i = 0; i < turns; ++i) actions[move - turns + i] = turn == 3 ? 'C' : 'R';
      actions[move] = 'F';
      next = move + 1;
      direction = *wanted;
      at = cell;
    }
    return Segments(robot.start, actions);
  }

  static std::string Segments(const GridCell& start, std::string_view actions) {
    auto x = static_cast<std::int64_t>(start.x);
    auto y = static_cast<std::int64_t>(start.y);
    int direction = 0;
    std::string text;
    for (std::size_t begin = 0; begin < actions.size() || begin == 0; begin += kSegmentTicks) {
      const std::size_t end = std::min(begin + kSegmentTicks, actions.size());
      text += fmt::format("[({},{},{},{},0):(", begin, y, x, direction);
      for (std::size_t i = begin; i < end;) {
        const char action = actions[i];
        const std::size_t first = i;
        for (; i < end && actions[i] == action; ++i) {
          if (action == 'R') direction = (direction + 1) % 4;
          if (action == 'C') direction = (direction + 3) % 4;
          if (action != 'F') continue;
          x += direction == 0 ? 1 : direction == 2 ? -1 : 0;
          y += direction == 1 ? 1 : direction == 3 ? -1 : 0;
        }
        text += fmt::format("{}{} {}", first > begin ? "," : "", action, i - first);
      }
      text += ")]";
    }
    return text;
  }

  // The tasks of the problem, if its file is there and is one of the League; else one for each robot.
  void AddTasks(Json& json) const {
    std::vector<GridTask> tasks;
    const auto agents = static_cast<std::uint32_t>(robots_.size());
    const Result<GridProblem> problem =
        IsGridPath(problem_) ? ReadGridProblem(problem_, {.agents = agents}) : Result<GridProblem>(Failure(""));
    if (problem.ok()) tasks = problem.value().tasks;
    const bool has_tasks = problem.ok() && problem.value().has_tasks;
    for (std::size_t robot = 0; !has_tasks && robot < robots_.size(); ++robot) {
      GridTask& task = tasks.emplace_back();
      task.agent = robot;
      task.places = robots_[robot].goals;
      for (std::size_t goal = 0; goal < task.places.size(); ++goal) task.goals.push_back(goal);
    }
    Json list = Json::array();
    std::vector<std::vector<std::size_t>> events;  // tick, agent, task, errands done
    std::vector<std::string> schedules(robots_.size());
    std::vector<std::size_t> free_at(robots_.size(), 0);
    std::size_t finished = 0;
    for (std::size_t id = 0; id < tasks.size(); ++id) {
      const GridTask& task = tasks[id];
      Json places = Json::array();
      for (const GridCell& place : task.places) {
        places.push_back(place.y);
        places.push_back(place.x);
      }
      list.push_back(Json::array({id, 0, std::move(places)}));
      if (task.agent >= robots_.size()) continue;
      const Robot& robot = robots_[task.agent];
      const bool has_begun = task.goals.empty() || task.goals[0] <= robot.visits.size();
      if (!has_begun) continue;
      std::string& schedule = schedules[task.agent];
      schedule += fmt::format("{}{}:{}", schedule.empty() ? "" : ",", free_at[task.agent], id);
      std::size_t done = 0;
      for (const std::size_t goal : task.goals) {
        if (goal >= robot.visits.size()) break;
        free_at[task.agent] = robot.visits[goal];
        events.push_back({robot.visits[goal], task.agent, id, ++done});
      }
      finished += done == task.goals.size() ? 1 : 0;
    }
    std::stable_sort(events.begin(), events.end(), [](const auto& a, const auto& b) { return a[0] < b[0]; });
    json["numTaskFinished"] = finished;
    json["events"] = events;
    json["tasks"] = std::move(list);
    json["actualSchedule"] = schedules;
  }

  std::string output_;
  std::string problem_;               // the file of the run
  std::vector<GridCell> cells_ = {};  // by vertex
  std::vector<Robot> robots_ = {};    // by trip
  std::optional<Tick> first_tick_ = {};
  std::size_t ticks_ = 0;
};

}  // namespace

Result<std::unique_ptr<RunExport>> MakeLeagueExport(const std::string& file, const std::string& problem) {
  return std::unique_ptr<RunExport>(std::make_unique<LeagueExport>(file, problem));
}

}  // namespace troupe
