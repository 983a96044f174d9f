#include "robot-agent/controller/giving_way.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace troupe {
namespace {

constexpr double kAsking = 0.6;          // m, between bodies of which one may wait for the other
constexpr double kGiveWaySeconds = 6.0;  // behind another robot; twice that for the one of the smaller id
constexpr double kDetourSeconds = 60.0;  // a longer way round another robot is worth it
constexpr double kAsideSeconds = 4.0;    // beside the way of another robot, and up to as many more
constexpr double kAtVertex = 0.3;        // m

double DistanceTo(const LaneGraph& graph, const Lane& lane, const Vec2& point) {
  const Vec2& start = graph.vertices[lane.start].position;
  const Vec2 way = graph.Way(lane.start, lane.end);
  const double square = way.squaredNorm();
  const double at = square > 0.0 ? std::clamp((point - start).dot(way) / square, 0.0, 1.0) : 0.0;
  return (start + at * way - point).norm();
}

// A robot that is parked at a charger.
bool IsParked(const LaneGraph& graph, const SeenRobot& robot) {
  const std::optional<NearVertex> at = FindNearestVertex(graph, robot.position, robot.z, kOnOneLevel);
  return at && at->distance < kAtVertex && graph.vertices[at->vertex].is_charger;
}

}  // namespace

std::optional<WayAround> GivingWay::OnBlocked(const LanePlace& place, RobotId other, const Leg& leg, bool is_away) {
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
  // Away from the vertex it has to drive back first, which a lane of one direction forbids.
  const std::optional<std::size_t> back = graph_->LaneBetween(leg.to, leg.from);
  if (is_away && !back) return std::nullopt;
  std::optional<WayAround> way = FindDetour(start, leg);
  if (!way) way = StepAside(start, leg.to);
  if (way && is_away) {
    way->is_on_first = true;
    way->legs.insert(way->legs.begin(), {leg.to, leg.from, back});
  }
  return way;
}

std::optional<WayAround> GivingWay::FindDetour(const LanePlace& place, const Leg& leg) const {
  if (!place.target) return std::nullopt;
  // Against the way that it would take: a detour is worth its extra time only up to a limit.
  const std::optional<LaneRoute> route = FastestRoute(*graph_, place.vertex, *place.target, speed_);
  std::optional<LaneRoute> around = FastestRoute(*graph_, place.vertex, *place.target, speed_, {*leg.lane});
  if (!route || !around || around->seconds > route->seconds + kDetourSeconds) return std::nullopt;
  return WayAround{.legs = std::move(around->legs)};
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
                                    DistanceTo(graph, lane, own.translation()) < kAtVertex &&
                                    DistanceTo(graph, lane, other.position) < kLaneHalfWidth);
      }
    }
    return is_on_lane;
  });
}

std::optional<WayAround> GivingWay::StepAside(const LanePlace& place, std::optional<std::size_t> not_to) const {
  std::vector<Leg> ways = FreeLegs(*graph_, place.vertex, place.others, place.radius, place.half_width);
  std::erase_if(ways, [&](const Leg& way) { return way.to == not_to; });
  if (ways.empty()) return std::nullopt;
  // At random, so that two robots that make room for each other do not choose in step.
  const auto chosen = static_cast<std::size_t>(place.now.Random(1) * static_cast<double>(ways.size()));
  return WayAround{.legs = {ways[chosen]}, .seconds_aside = kAsideSeconds * (1.0 + place.now.Random(2))};
}

}  // namespace troupe
