#include "common/picture/solids.h"

#include <algorithm>

#include "common/model/states.h"
#include "common/picture/rectangle_outline.h"

namespace troupe {
namespace {

Solid MakeSolid(const std::vector<Polygon>& loops_M, const ZRange& z_M, const Pose& X_WM) {
  const Transform2 transform(X_WM);
  Solid solid;
  solid.z = z_M + X_WM.z;
  solid.box = Rectangle::Nothing();
  for (const Polygon& loop_M : loops_M) {
    Polygon loop;
    for (const Vec2& p : loop_M) {
      loop.push_back(transform * p);
      solid.box.Extend(loop.back());
    }
    solid.loops.push_back(std::move(loop));
  }
  return solid;
}

Rectangle BoxAround(const Rectangle& r, const Transform2& X_WM) {
  Rectangle box = Rectangle::Nothing();
  for (const Vec2& corner : Corners(r)) box.Extend(X_WM * corner);
  return box;
}

Solid MakeSolid(const PixelArea& area, const ZRange& z_M, const Pose& X_WM) {
  const Transform2 model(X_WM);
  const Transform2 lines(area.X_MA());
  Solid solid;
  solid.z = z_M + X_WM.z;
  solid.box = Rectangle::Nothing();
  for (const Vec2& corner : Corners(area.bounds())) solid.box.Extend(model * (lines * corner));
  solid.area = &area;
  solid.X_WM = X_WM;
  return solid;
}

constexpr double kFloor = 0.01;  // m: floors and marks on them, which are no lower than what stands there

bool IsFloor(const Solid& solid) {
  return !solid.robot && solid.z.max <= kFloor;
}

// A solid's height is relative to the solids that it is compared with by eye: its robot's parts, or all objects.
void SetHeights(std::vector<Solid>& solids, std::size_t robots) {
  std::vector<ZRange> span(robots + 1, ZRange{0.0, 0.0});
  std::vector<bool> seen(robots, false);
  const auto group = [&](const Solid& solid) { return solid.robot ? solid.robot->index() : robots; };
  for (const Solid& solid : solids) {
    if (solid.kind == SolidKind::kMap || IsFloor(solid)) continue;
    ZRange& z = span[group(solid)];
    if (solid.robot && !seen[solid.robot->index()]) {
      seen[solid.robot->index()] = true;
      z = solid.z;
    }
    z = {std::min(z.min, solid.z.min), std::max(z.max, solid.z.max)};
  }
  for (Solid& solid : solids) {
    if (solid.kind == SolidKind::kMap) continue;
    const ZRange& z = span[group(solid)];
    solid.height = !IsFloor(solid) && z.max > z.min ? (solid.z.max - z.min) / (z.max - z.min) : 1.0;
  }
}

}  // namespace

std::vector<Solid> CollectSolids(const WorldDescription& world, const WorldState& state) {
  std::vector<std::optional<RobotId>> robot_of(world.models.size());
  for (std::size_t i = 0; i < world.robots.size(); ++i) robot_of[world.robots[i].root.index()] = RobotId(i);

  const std::vector<Pose> X_WM = ModelPoses(world, state);
  std::vector<Solid> solids;
  for (std::size_t i = 0; i < world.models.size(); ++i) {
    const ModelDescription& model = world.models[i];
    if (IsAway(X_WM[i])) continue;
    if (model.parent) robot_of[i] = robot_of[model.parent->index()];
    const Shape& shape = world.shape(model.shape);
    const bool map = !robot_of[i] && (!shape.rectangles.empty() || shape.area) && !model.gripper_return;
    const auto add = [&](Solid solid) {
      solid.kind = map ? SolidKind::kMap : robot_of[i] ? SolidKind::kRobot : SolidKind::kObject;
      solid.model = ModelId(i);
      solid.robot = robot_of[i];
      if (!solid.loops.empty() || solid.area != nullptr) solids.push_back(std::move(solid));
    };
    Solid bitmap = MakeSolid(OutlineOf(shape.rectangles), shape.rectangles_z, X_WM[i]);
    for (const Rectangle& r : shape.rectangles) bitmap.cover.push_back(BoxAround(r, Transform2(X_WM[i])));
    add(std::move(bitmap));
    if (shape.area) add(MakeSolid(*shape.area, shape.rectangles_z, X_WM[i]));
    for (const Block& block : shape.blocks) add(MakeSolid({block.outline}, block.z, X_WM[i]));
  }
  SetHeights(solids, world.robots.size());
  return solids;
}

std::vector<RobotExtent> RobotExtents(const std::vector<Solid>& solids, const WorldDescription& world,
                                      const WorldState& state) {
  std::vector<RobotExtent> extents;
  for (const RobotState& robot : state.robots) {
    const bool exists = RobotExists(world, RobotId(extents.size()));
    RobotExtent extent{Rectangle::Nothing(), {robot.X_WR.z, robot.X_WR.z}, exists};
    extent.box.Extend(robot.X_WR.translation());
    extents.push_back(extent);
  }
  for (const Solid& solid : solids) {
    if (!solid.robot) continue;
    RobotExtent& extent = extents[solid.robot->index()];
    extent.box.Extend(solid.box);
    extent.z = {std::min(extent.z.min, solid.z.min), std::max(extent.z.max, solid.z.max)};
  }
  return extents;
}

}  // namespace troupe
