#include "common/spatial/lift_shafts.h"

#include <algorithm>

#include "troupe/rectangle.h"

namespace troupe {
namespace {

constexpr double kCabinRoom = 2.5;  // m above the floor of a cabin, at least

void AppendShaft(const WorldDescription& world, const LiftDescription& lift, double cabin,
                 std::vector<ConvexPiece>& parts) {
  const ModelId model = world.objects[lift.cabin.index()];
  Rectangle box = Rectangle::Nothing();  // in the frame of the cabin, like the next
  ZRange heights{0.0, 0.0};
  for (const ConvexPiece& piece : MakePieces(world, model, Pose{})) {
    box.Extend(BoundingBox(piece.vertices));
    heights = {std::min(heights.min, piece.z.min), std::max(heights.max, piece.z.max)};
  }
  if (box.empty()) return;  // a cabin without blocks
  const auto [lowest, highest] = std::minmax_element(lift.floors.begin(), lift.floors.end(),
                                                     [](const LiftFloor& a, const LiftFloor& b) { return a.z < b.z; });
  double top = cabin + std::max(heights.max, kCabinRoom);
  for (const LiftFloor& floor : lift.floors) {
    if (floor.z > cabin) top = std::min(top, std::max(floor.z, cabin + heights.max));
  }
  ConvexPiece part{.vertices = {}, .z = {}, .model = lift.model, .obstacle = true, .ranger_return = -1.0};
  const Transform2 X_WC(world.model(model).X_PM);
  for (const Vec2& corner : Corners(box)) part.vertices.push_back(X_WC * corner);
  for (const ZRange& z : {ZRange{lowest->z, cabin + heights.min}, ZRange{top, highest->z + heights.max}}) {
    if (!HasHeight(z)) continue;
    part.z = z;
    parts.push_back(part);
  }
}

}  // namespace

std::vector<ConvexPiece> EmptyShafts(const WorldDescription& world, std::span<const double> cabins) {
  std::vector<ConvexPiece> parts;
  for (std::size_t i = 0; i < world.lifts.size(); ++i) AppendShaft(world, world.lifts[i], cabins[i], parts);
  return parts;
}

std::vector<ConvexPiece> EmptyShafts(const WorldDescription& world) {
  std::vector<double> cabins;
  for (const LiftDescription& lift : world.lifts) cabins.push_back(lift.floors[lift.floor].z);
  return EmptyShafts(world, cabins);
}

}  // namespace troupe
