#include "robot-agent/controller/giving_way.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

namespace troupe {
namespace {

constexpr double kAsking = 0.6;          // m, between bodies of which one may wait for the other
constexpr double kGiveWaySeconds = 6.0;  // behind another robot; twice that for the one of the smaller id
constexpr double kAsideSeconds = 4.0;    // beside the way of another robot, and up to as many more
constexpr double kAtVertex = 0.3;        // m

// A robot that is parked at a charger.
bool IsParked(const LaneGraph& graph, const SeenRobot& robot) {
  const std::optional<NearVertex> at = FindNearestVertex(graph, robot.position, robot.z, kOnOneLevel);
  return at && at->distance < kAtVertex && graph.vertices[at->vertex].is_charger;
}

}  // namespace

std::optional<BlockEnd> GivingWay::OnBlocked(const LanePlace& place, RobotId other, const Leg& leg, bool is_away) {
  const double time = place.now.time;
  if (!blocked_since_) {
    blocked_since_ = time;
    // Drawn once for each block: a time that changed in each tick would be the shortest of all draws.
    give_way_seconds_ = kGiveWaySeconds * ((other < own_ ? 1.0 : 2.0) + 0.5 * place.now.Random(0));
  }
  if (time - *blocked_since_ < give_way_seconds_) return std::nullopt;
  // Also without a way: the robot then waits anew.
  blocked_since_.reset();
  LanePlace start = place;
  start.vertex = leg.from;  // also while it drives back to the vertex that it left
  if (graph_->vertices[start.vertex].lift || !leg.lane) return std::nullopt;  // the others make room
  const ClosedLanes::Block block = closed_.Count(*leg.lane);
  BlockEnd end;
  // A robot in traffic has moved on by then: only a second block in a row is worth a word.
  if (block.is_longer && block.seconds > ClosedLanes::kFirstSeconds) end.closed = block.seconds;
  // Away from the vertex it has to drive back first, which a lane of one direction forbids.
  if (is_away && !graph_->LaneBetween(leg.to, leg.from)) return end;
  end.way = FindDetour(start, leg, block.seconds);
  if (!end.way) end.way = StepAside(start, leg.to);
  if (end.way && is_away) end.way = BackFirst(*std::move(end.way), leg);
  return end;
}

std::optional<BlockEnd> GivingWay::OnObstacle(const LanePlace& place, const Leg& leg, bool is_away, bool is_back_free) {
  const double time = place.now.time;
  if (!obstacle_wait_) obstacle_wait_ = ObstacleWait{.until = time + kObstacleSeconds};
  ObstacleWait& wait = *obstacle_wait_;
  wait.seen_at = time;
  BlockEnd end;
  if (time >= wait.until) {
    end.closed = closed_.Count(*leg.lane).seconds;
    closed_.Close(*leg.lane, time);
    wait.until = time + *end.closed;
    wait.is_closed = true;
  } else if (!wait.is_closed || wait.target == place.target) {
    return std::nullopt;
  }
  wait.target = place.target;
  if (is_away && (!is_back_free || !graph_->LaneBetween(leg.to, leg.from))) return end;
  std::optional<LaneRoute> route = LaneRoute();
  if (place.target) route = FastestRoute(*graph_, leg.from, *place.target, speed_, ClosedAt(time));
  if (!route) return end;
  end.way = WayAround{.legs = std::move(route->legs)};
  if (is_away) end.way = BackFirst(*std::move(end.way), leg);
  obstacle_wait_.reset();
  return end;
}

WayAround GivingWay::BackFirst(WayAround way, const Leg& leg) const {
  way.is_on_first = true;
  way.legs.insert(way.legs.begin(), {leg.to, leg.from, graph_->LaneBetween(leg.to, leg.from)});
  return way;
}

// A detour is worth `worth` s more than the way that it would take.
std::optional<WayAround> GivingWay::FindDetour(const LanePlace& place, const Leg& leg, double worth) {
  if (!place.target) return std::nullopt;
  std::vector<std::size_t> closed = ClosedAt(place.now.time);
  const std::optional<LaneRoute> route = FastestRoute(*graph_, place.vertex, *place.target, speed_, closed);
  closed.push_back(*leg.lane);
  std::optional<LaneRoute> around = FastestRoute(*graph_, place.vertex, *place.target, speed_, closed);
  if (!around || (route && around->seconds > route->seconds + worth)) return std::nullopt;
  closed_.Close(*leg.lane, place.now.time);
  return WayAround{.legs = std::move(around->legs)};
}

std::optional<LaneRoute> GivingWay::FindRoute(std::size_t from, std::size_t to, double time) const {
  const std::vector<std::size_t> closed = ClosedAt(time);
  std::optional<LaneRoute> route = FastestRoute(*graph_, from, to, speed_, closed);
  if (route || closed.size() == barred_.size()) return route;
  return FastestRoute(*graph_, from, to, speed_, barred_);
}

std::vector<std::size_t> GivingWay::ClosedAt(double time) const {
  std::vector<std::size_t> closed = closed_.At(time);
  if (barred_.empty()) return closed;
  std::vector<std::size_t> all;
  std::set_union(closed.begin(), closed.end(), barred_.begin(), barred_.end(), std::back_inserter(all));
  return all;
}

bool GivingWay::StandsNear(const LanePlace& place, const SeenRobot& other) {
  const Pose& own = place.now.pose_estimate;
  return !other.moves && std::fabs(other.z - own.z) < kLevelGap &&
         (other.position - own.translation()).norm() < place.radius + other.radius + kAsking;
}

bool GivingWay::IsAskedForRoom(const LanePlace& place, const Vec2& towards) {
  return std::any_of(place.others.begin(), place.others.end(), [&](const SeenRobot& other) {
    return StandsNear(place, other) && (other.position - place.now.pose_estimate.translation()).dot(towards) >= 0.0;
  });
}

bool GivingWay::IsInTheWay(const LanePlace& place) const {
  const Pose& own = place.now.pose_estimate;
  return std::any_of(place.others.begin(), place.others.end(), [&](const SeenRobot& other) {
    if (!StandsNear(place, other)) return false;
    bool is_on_lane = false;
    for (const LaneGraph& graph : graphs_) {
      if (IsParked(graph, other)) return false;
      for (const Lane& lane : graph.lanes) {
        is_on_lane = is_on_lane || (std::fabs(graph.vertices[lane.start].z - own.z) < kLevelGap &&
                                    graph.DistanceTo(lane, own.translation()) < kAtVertex &&
                                    graph.DistanceTo(lane, other.position) < kLaneHalfWidth);
      }
    }
    return is_on_lane;
  });
}

std::optional<WayAround> GivingWay::StepAside(const LanePlace& place, std::optional<std::size_t> not_to) const {
  std::vector<Leg> ways = FreeLegs(*graph_, place.vertex, place.others, place.radius, place.half_width);
  const std::vector<std::size_t> closed = ClosedAt(place.now.time);
  std::erase_if(ways, [&](const Leg& way) {
    return way.to == not_to || std::binary_search(closed.begin(), closed.end(), *way.lane);
  });
  if (ways.empty()) return std::nullopt;
  // At random, so that two robots that make room for each other do not choose in step.
  const auto chosen = static_cast<std::size_t>(place.now.Random(1) * static_cast<double>(ways.size()));
  return WayAround{.legs = {ways[chosen]}, .seconds_aside = kAsideSeconds * (1.0 + place.now.Random(2))};
}

}  // namespace troupe
