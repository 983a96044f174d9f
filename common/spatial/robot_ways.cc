#include "common/spatial/robot_ways.h"

#include <algorithm>
#include <cmath>

#include "common/spatial/scene.h"
#include "common/spatial/walk_routes.h"
#include "common/spatial/way_search.h"
#include "common/spatial/zone_ways.h"

namespace troupe {
namespace {

constexpr double kMarginOfWays = 0.1;  // m, to both sides of a robot that turns

double HalfWidth(const Body& body) {
  double width = 0.0;
  for (std::size_t i = 0; i < body.pieces.size(); ++i) {
    if (!body.pieces[i].obstacle || body.piece_links[i] != 0) continue;
    for (const Vec2& vertex : body.pieces[i].vertices) width = std::max(width, std::fabs(vertex.y()));
  }
  return width;
}

}  // namespace

bool SearchesWays(const RobotDescription& robot) {
  return robot.controller.name == "go_to" || robot.controller.name == "patrol";
}

std::array<double, 3> RadiiOfWays(const Scene& scene, RobotId robot) {
  const Body& body = scene.body(scene.body_of(robot));
  return {body.radius + kMarginOfWays, body.radius, HalfWidth(body)};
}

std::shared_ptr<const WalkGrid> GridOfRobot(const Scene& scene, RobotId robot, double z, double radius) {
  return scene.walk_routes().RobotGrid(scene, scene.body(scene.body_of(robot)).z + z, radius);
}

Status CheckWays(const Scene& scene, RobotId robot, const Pose& X_WR, std::span<const Vec2> points) {
  const auto grid = GridOfRobot(scene, robot, X_WR.z, RadiiOfWays(scene, robot).back());
  return CheckWays(*grid, X_WR.translation(), points);
}

std::vector<Vec2> FindWays(const Scene& scene, const WorldState& state, RobotId robot, std::span<const Vec2> points) {
  const Pose& X_WR = state.robots[robot.index()].X_WR;
  std::vector<Vec2> ways;
  Vec2 here = X_WR.translation();
  for (const Vec2& point : points) {
    std::vector<Vec2> way = {point};
    for (const double radius : RadiiOfWays(scene, robot)) {
      const auto grid = GridOfRobot(scene, robot, X_WR.z, radius);
      const ZoneWays zones(scene.world(), state, X_WR.z, *grid);
      Result<Way> found = FindWay(*grid, here, point, {}, &zones);
      if (!found.ok()) continue;
      way = std::move(found.value().points);
      break;
    }
    ways.insert(ways.end(), way.begin(), way.end());
    here = point;
  }
  return ways;
}

}  // namespace troupe
