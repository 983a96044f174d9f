#include "common/worldfile/model_shape.h"

#include <algorithm>
#include <cmath>

#include "common/worldfile/block_reader.h"
#include "common/worldfile/file_lookup.h"
#include "common/worldfile/map_yaml.h"
#include "common/worldfile/quote.h"

namespace troupe {
namespace {

constexpr double kBoundaryThickness = 0.01;  // m, as Stage's

void AddBitmap(PropertyReader& reader, const Size& size, BuildContext& context, Shape& shape) {
  const std::string name = reader.Text("bitmap", "");
  const SourceLocation& where = reader.Where("bitmap");
  if (context.options.without_bitmaps) {
    reader.diagnostics().Fail(where, "found a bitmap, which cannot be read here");
    return;
  }
  const auto bitmap = context.bitmaps.Load(FindFile(name, context.tree.directory, where.file), StagePixelRule(), where);
  if (!bitmap.ok()) {
    reader.diagnostics().Fail(bitmap.error().where, bitmap.error().message);
    return;
  }
  const BitmapRectangles& pixels = *bitmap.value();
  if (pixels.rectangles.empty()) {
    reader.diagnostics().Warn(where, "bitmap " + QuotedPath(name) + " has no occupied pixel, so it has no body");
  }
  for (const PixelRectangle& r : pixels.rectangles) {
    shape.rectangles.push_back(
        {static_cast<double>(r.x0), static_cast<double>(r.y0), static_cast<double>(r.x1), static_cast<double>(r.y1)});
  }
  shape.rectangles_z = {0.0, 1.0};
  ScaleToSize(size, shape);
}

void AddBoundary(const Size& size, Shape& shape) {
  const double x = 0.5 * size.x;
  const double y = 0.5 * size.y;
  const double tx = std::min(kBoundaryThickness, size.x);
  const double ty = std::min(kBoundaryThickness, size.y);
  const ZRange z{0.0, size.z};
  shape.blocks.push_back(BoxBlock({-x, -y, -x + tx, y}, z));
  shape.blocks.push_back(BoxBlock({x - tx, -y, x, y}, z));
  shape.blocks.push_back(BoxBlock({-x, -y, x, -y + ty}, z));
  shape.blocks.push_back(BoxBlock({-x, y - ty, x, y}, z));
}

bool IsEmpty(const Shape& shape) {
  return shape.blocks.empty() && shape.rectangles.empty();
}

// Appends the model's own blocks. The first one takes the place of the box, and of the walls around it.
void AddBlocks(PropertyReader& reader, bool has_bitmap, Shape& shape, bool& has_blocks) {
  for (const Entity& child : reader.entity().children) {
    if (child.type != "block") continue;
    if (!has_blocks && !has_bitmap) {
      if (shape.blocks.size() > 1) {
        reader.diagnostics().Warn(reader.Where("boundary"),
                                  "property 'boundary' has no effect in a model with blocks and without a bitmap");
      }
      shape = {};
    }
    has_blocks = true;
    std::optional<Block> block = ReadBlock(child, reader.units(), reader.diagnostics());
    if (!block) return;
    shape.blocks.push_back(std::move(*block));
  }
}

// Blocks without height collide with nothing and no ray sees them; a shape must not hold them.
void DropFlatBlocks(Shape& shape) {
  std::erase_if(shape.blocks, [](const Block& block) { return !(block.z.max - block.z.min > kTouchTolerance); });
}

bool IsWithinReach(const ZRange& z) {
  return std::max(std::fabs(z.min), std::fabs(z.max)) <= kMaxMagnitude;
}

bool IsUsable(const Rectangle& r) {
  return r.min_x < r.max_x && r.min_y < r.max_y &&
         std::max({std::fabs(r.min_x), std::fabs(r.min_y), std::fabs(r.max_x), std::fabs(r.max_y)}) <= kMaxMagnitude;
}

// Moves the finished body to its place in the model, and makes sure that it can be there.
void Place(PropertyReader& reader, const Pose& origin, Shape& shape) {
  const std::string culprit = reader.entity().Find("origin") != nullptr ? "origin" : "size";
  const auto fail = [&](const std::string& fault) {
    reader.diagnostics().Fail(reader.Where(culprit), "found a body that cannot be: " + fault);
  };
  MoveByOrigin(origin, shape);
  DropFlatBlocks(shape);
  for (Block& block : shape.blocks) {
    if (const std::string fault = Normalize(block.outline); !fault.empty()) return fail(fault);
    if (!IsWithinReach(block.z)) return fail("its height is beyond 1000 km");
  }
  for (const Rectangle& rectangle : shape.rectangles) {
    if (!IsUsable(rectangle)) return fail("a pixel of its bitmap has no area, or is beyond 1000 km");
  }
  if (!IsWithinReach(shape.rectangles_z)) return fail("its height is beyond 1000 km");
}

}  // namespace

std::optional<RosMap> ReadRosMap(PropertyReader& reader, BuildContext& context) {
  const Property* property = reader.Use("map_yaml");
  if (property == nullptr) return std::nullopt;
  const SourceLocation& where = property->value.where;
  if (context.options.without_bitmaps) {
    reader.diagnostics().Fail(where, "found a map, which cannot be read here");
    return std::nullopt;
  }
  const std::string path = FindFile(reader.Text("map_yaml", ""), context.tree.directory, where.file);
  const Result<MapYaml> yaml = ReadMapYaml(path, where);
  if (!yaml.ok()) {
    reader.diagnostics().Fail(yaml.error().where, yaml.error().message);
    return std::nullopt;
  }
  for (const Warning& warning : yaml.value().warnings) reader.diagnostics().Warn(warning.where, warning.message);
  const auto pixels = context.bitmaps.Load(yaml.value().image, yaml.value().rule, yaml.value().image_where);
  if (!pixels.ok()) {
    reader.diagnostics().Fail(pixels.error().where, pixels.error().message);
    return std::nullopt;
  }
  RosMap map;
  map.origin = yaml.value().origin;
  map.pixels = pixels.value();
  map.resolution = yaml.value().resolution;
  map.size = {map.pixels->width * map.resolution, map.pixels->height * map.resolution, yaml.value().wall_height};
  return map;
}

Shape RosMapShape(PropertyReader& reader, const RosMap& map, const Size& size, const Pose& origin) {
  Shape shape;
  for (const PixelRectangle& r : map.pixels->rectangles) {
    shape.rectangles.push_back(
        {r.x0 * map.resolution, r.y0 * map.resolution, r.x1 * map.resolution, r.y1 * map.resolution});
  }
  if (!shape.rectangles.empty()) shape.rectangles_z = {0.0, size.z};
  Place(reader, origin, shape);
  return shape;
}

Shape ReadModelShape(PropertyReader& reader, const TypeDefaults& type, const Size& size, const Pose& origin,
                     BuildContext& context) {
  Shape shape;
  const bool without_box = reader.Flag("noblocks", false);
  const bool has_bitmap = reader.entity().Find("bitmap") != nullptr;
  const bool has_boundary = reader.Flag("boundary", false);
  if (has_bitmap) {
    AddBitmap(reader, size, context, shape);
  } else if (type.has_body && !without_box) {
    shape.blocks.push_back(BoxBlock({-0.5 * size.x, -0.5 * size.y, 0.5 * size.x, 0.5 * size.y}, {0.0, size.z}));
  }
  if (has_boundary && !IsEmpty(shape)) AddBoundary(size, shape);
  bool has_blocks = false;
  AddBlocks(reader, has_bitmap, shape, has_blocks);
  if (reader.diagnostics().failed() || IsEmpty(shape)) return {};

  if (!(size.x > 0.0 && size.y > 0.0 && size.z > 0.0)) {
    reader.diagnostics().Warn(reader.Where("size"), "this model has a size of 0, so it has no body");
    return {};
  }
  if (has_blocks) ScaleToSize(size, shape);
  Place(reader, origin, shape);
  return shape;
}

}  // namespace troupe
