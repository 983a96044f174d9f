// The events of robots on their ways (troupe/event.h, kWaitBegan and later), found by comparing the states before and
// after a step, as those of buildings: a recording or a rewind that steps again gives the same ones.
//
// Each is told once in an episode. A wait is told when it has lasted for kLongWait, so a robot has at most one each
// kLongWait. A deadlock is a ring of robots that wait for each other, each for kLongStand at least; it is broken when
// one of them goes on, which ends its wait, so that rings cannot come and go faster than waits. A lane that is closed
// stays so for a minute at least.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include "world-service/core/step_workspace.h"

namespace troupe {
namespace {

constexpr double kLongWait = 10.0;       // s
constexpr double kLongStand = 2.0;       // s
constexpr std::size_t kNamedRobots = 8;  // of a ring

std::string SecondsText(double seconds) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1f s", seconds);
  return text;
}

const RobotWait* FindWait(const WorldState& state, RobotId robot) {
  const auto found = std::lower_bound(state.waits.begin(), state.waits.end(), robot,
                                      [](const RobotWait& wait, RobotId other) { return wait.robot < other; });
  return found != state.waits.end() && found->robot == robot ? &*found : nullptr;
}

class TrafficEvents {
 public:
  TrafficEvents(const WorldDescription& world, const WorldState& before, const WorldState& now,
                std::vector<Event>& events)
      : world_(world),
        before_(before),
        now_(now),
        events_(events),
        long_wait_(TicksOf(kLongWait)),
        long_stand_(TicksOf(kLongStand)) {}

  void AddWaits() {
    for (const RobotWait& wait : before_.waits) {
      if (before_.tick - wait.since < long_wait_) continue;
      const RobotWait* const after = FindWait(now_, wait.robot);
      if (after != nullptr && after->since == wait.since) continue;
      const double seconds = static_cast<double>(now_.tick - wait.since) * world_.interval_seconds();
      Add(EventType::kWaitEnded, wait.robot, {}, "after " + SecondsText(seconds));
    }
    for (const RobotWait& wait : now_.waits) {
      if (now_.tick - wait.since == long_wait_) AddLongWait(wait);
    }
  }

  // Rings of the state before, of which one robot goes on.
  void AddDeadlocks() {
    if (before_.waits.size() < 2) return;
    const std::vector<std::size_t> next = FindNext();
    // By row: the row from which a search came there first; a search that meets its own rows has found a ring.
    std::vector<std::size_t> seen(before_.waits.size(), kNone);
    for (std::size_t start = 0; start < next.size(); ++start) {
      std::size_t at = start;
      while (at != kNone && seen[at] == kNone) {
        seen[at] = start;
        at = next[at];
      }
      if (at != kNone && seen[at] == start) AddRing(next, at);
    }
  }

  void AddClosures() {
    auto known = before_.lane_closures.begin();
    for (const LaneClosure& closure : now_.lane_closures) {
      while (known != before_.lane_closures.end() && known->lane < closure.lane) ++known;
      const bool is_known = known != before_.lane_closures.end() && known->lane == closure.lane;
      if (closure.until <= now_.tick || (is_known && known->until == closure.until)) continue;
      AddClosure(closure);
    }
  }

 private:
  static constexpr std::size_t kNone = static_cast<std::size_t>(-1);

  Tick TicksOf(double seconds) const {
    return static_cast<Tick>(std::max(1.0, std::round(seconds / world_.interval_seconds())));
  }

  void Add(EventType type, std::optional<RobotId> robot, std::optional<ModelId> other, std::string detail) {
    events_.push_back({.tick = now_.tick, .type = type, .robot = robot, .other = other, .detail = std::move(detail)});
  }

  std::string LaneText(std::optional<std::uint32_t> number) const {
    const std::optional<GraphPlace> place = number ? FindLane(world_.lane_graphs, *number) : std::nullopt;
    return place ? "lane " + NameOfLane(world_.lane_graphs[place->graph], place->number) : std::string();
  }

  // The name of the goal of a robot that the plan has no move for, and that waits for no other one.
  std::optional<std::string> FindGoalWithoutWay(const RobotWait& wait) const {
    const auto row = std::find_if(now_.traffic_robots.begin(), now_.traffic_robots.end(),
                                  [&](const TrafficRobot& robot) { return robot.robot == wait.robot; });
    if (wait.thing || row == now_.traffic_robots.end() || !row->goal || row->waiting == 0) return std::nullopt;
    const auto has_move = [&](const TrafficMove& move) { return move.robot == wait.robot; };
    if (std::any_of(now_.traffic_moves.begin(), now_.traffic_moves.end(), has_move)) return std::nullopt;
    const std::optional<GraphPlace> place = FindVertex(world_.lane_graphs, *row->goal);
    if (!place) return std::nullopt;
    return NameOfVertex(world_.lane_graphs[place->graph], place->number);
  }

  void AddLongWait(const RobotWait& wait) {
    const std::string lane = LaneText(wait.lane);
    if (const std::optional<std::string> goal = FindGoalWithoutWay(wait)) {
      return Add(EventType::kNoWay, wait.robot, {}, *goal + (lane.empty() ? "" : "; " + lane + " is closed"));
    }
    Add(EventType::kWaitBegan, wait.robot, wait.thing, lane);
  }

  // By row of the waits before: the row of the robot that it waits for.
  std::vector<std::size_t> FindNext() const {
    std::vector<std::pair<ModelId, std::size_t>> rows;  // ascending
    for (std::size_t i = 0; i < before_.waits.size(); ++i) {
      rows.emplace_back(world_.robot(before_.waits[i].robot).root, i);
    }
    std::sort(rows.begin(), rows.end());
    std::vector<std::size_t> next(before_.waits.size(), kNone);
    for (std::size_t i = 0; i < next.size(); ++i) {
      const std::optional<ModelId>& thing = before_.waits[i].thing;
      if (!thing) continue;
      const auto found = std::lower_bound(rows.begin(), rows.end(), std::pair(*thing, std::size_t{0}));
      if (found != rows.end() && found->first == *thing) next[i] = found->second;
    }
    return next;
  }

  bool GoesOn(std::size_t row) const {
    const RobotWait* const after = FindWait(now_, before_.waits[row].robot);
    return after == nullptr || after->since != before_.waits[row].since;
  }

  void AddRing(const std::vector<std::size_t>& next, std::size_t first) {
    std::vector<std::size_t> ring;
    std::size_t at = first;
    do {
      ring.push_back(at);
      if (before_.tick - before_.waits[at].since < long_stand_) return;
      at = next[at];
    } while (at != first);
    // From the robot with the least number on, whichever row the search met first.
    std::rotate(ring.begin(), std::min_element(ring.begin(), ring.end()), ring.end());
    const auto freed = std::find_if(ring.begin(), ring.end(), [&](std::size_t row) { return GoesOn(row); });
    if (freed == ring.end()) return;
    std::string names;
    for (std::size_t i = 0; i < std::min(ring.size(), kNamedRobots); ++i) {
      names += (i == 0 ? "" : ", ") + world_.robot(before_.waits[ring[i]].robot).name;
    }
    if (ring.size() > kNamedRobots) names += " and " + std::to_string(ring.size() - kNamedRobots) + " more";
    Add(EventType::kDeadlockBroken, before_.waits[*freed].robot, {}, names);
  }

  // Of the robots that were on the lane, the one that waited there met what is in the way.
  void AddClosure(const LaneClosure& closure) {
    const auto waits_there = std::find_if(before_.waits.begin(), before_.waits.end(),
                                          [&](const RobotWait& wait) { return wait.lane == closure.lane; });
    std::optional<RobotId> robot;
    std::optional<ModelId> thing;
    if (waits_there != before_.waits.end()) {
      robot = waits_there->robot;
      thing = waits_there->thing;
    } else {
      for (const TrafficMove& move : before_.traffic_moves) {
        if (move.lane == closure.lane && move.granted && !robot) robot = move.robot;
      }
    }
    const double seconds = static_cast<double>(closure.ticks) * world_.interval_seconds();
    Add(EventType::kReplanned, robot, thing, LaneText(closure.lane) + " is closed for " + SecondsText(seconds));
  }

  const WorldDescription& world_;
  const WorldState& before_;
  const WorldState& now_;
  std::vector<Event>& events_;
  const Tick long_wait_;
  const Tick long_stand_;
};

}  // namespace

void AddTrafficEvents(const WorldDescription& world, const WorldState& before, const WorldState& now,
                      std::vector<Event>& events) {
  if (before.waits.empty() && now.waits.empty() && now.lane_closures.empty()) return;
  TrafficEvents traffic(world, before, now, events);
  traffic.AddWaits();
  traffic.AddDeadlocks();
  traffic.AddClosures();
}

}  // namespace troupe
