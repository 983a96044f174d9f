#include "viewer/editor/model_picture.h"

#include <cmath>

#include "viewer/editor/editable_world.h"

namespace troupe {
namespace {

using Json = nlohmann::json;

constexpr std::size_t kMostPictureBlocks = 200;
constexpr std::size_t kMostPictureCorners = 200;

// Tenths of a millimetre: fewer bytes.
double Rounded(double value) {
  return std::round(value * 1e4) / 1e4;
}

void Add(Json& blocks, const Polygon& outline, const ZRange& z, const Pose& X_WM, const Color& color) {
  if (blocks.size() >= kMostPictureBlocks || outline.size() > kMostPictureCorners) return;
  const Transform2 to_world(X_WM);
  Json corners = Json::array();
  for (const Vec2& corner : outline) {
    const Vec2 p = to_world * corner;
    corners.push_back({Rounded(p.x()), Rounded(p.y())});
  }
  blocks.push_back({{"outline", std::move(corners)},
                    {"z", {Rounded(X_WM.z + z.min), Rounded(X_WM.z + z.max)}},
                    {"color", {Rounded(color.r), Rounded(color.g), Rounded(color.b)}}});
}

}  // namespace

Json PictureOf(const WorldDescription& world) {
  std::vector<ModelId> all;
  for (std::size_t i = 0; i < world.models.size(); ++i) all.emplace_back(i);
  return PictureOf(world, all);
}

Json PictureOf(const WorldDescription& world, const std::vector<ModelId>& models) {
  Json blocks = Json::array();
  for (const ModelId id : models) {
    const ModelDescription& model = world.model(id);
    if (model.removed) continue;
    const Pose X_WM = PoseInWorld(world, id);
    const Shape& shape = world.shape(model.shape);
    for (const Block& block : shape.blocks) Add(blocks, block.outline, block.z, X_WM, model.color);
    for (const Rectangle& r : shape.rectangles) {
      const Polygon outline{{r.min_x, r.min_y}, {r.max_x, r.min_y}, {r.max_x, r.max_y}, {r.min_x, r.max_y}};
      Add(blocks, outline, shape.rectangles_z, X_WM, model.color);
    }
  }
  return blocks;
}

}  // namespace troupe
