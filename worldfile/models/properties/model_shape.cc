#include "worldfile/models/properties/model_shape.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>

#include "worldfile/grids/grid_problem.h"
#include "worldfile/map/map_yaml.h"
#include "worldfile/text/text_file.h"

namespace troupe {
namespace {

constexpr std::size_t kMaxPoints = 1'000;

// The i of "point[i]", if the name is one.
std::optional<std::size_t> PointIndex(const std::string& name) {
  constexpr std::string_view kStart = "point[";
  if (name.compare(0, kStart.size(), kStart) != 0) return std::nullopt;
  std::size_t index = 0;
  const std::from_chars_result read = std::from_chars(name.data() + kStart.size(), name.data() + name.size(), index);
  if (read.ec != std::errc() || std::string_view(read.ptr) != "]") return std::nullopt;
  return index;
}

// The corners by their indices, in any order in the file; one that is missing is (0, 0), as in Stage. Nothing after an
// error.
std::optional<Polygon> ReadPoints(PropertyReader& reader) {
  const auto count = static_cast<std::size_t>(reader.Integer("points", 0, 0, 1'000'000));
  if (count > kMaxPoints) {
    reader.diagnostics().Fail(reader.Where("points"), "found a block of " + std::to_string(count) +
                                                          " points, expected at most " + std::to_string(kMaxPoints));
    return std::nullopt;
  }
  std::vector<std::string> names(count);
  for (const Property& property : reader.node().properties) {
    const std::optional<std::size_t> index = PointIndex(property.name);
    if (index && *index < count) names[*index] = property.name;
  }
  Polygon outline;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (names[i].empty()) {
      reader.diagnostics().Warn(reader.node().where, "found a block of " + std::to_string(count) +
                                                         " points without 'point[" + std::to_string(i) +
                                                         "]', expected all of them; it is [0 0]");
      outline.push_back({0.0, 0.0});
      continue;
    }
    const std::optional<std::vector<double>> numbers = reader.Numbers(names[i], 2);
    if (!numbers) return std::nullopt;
    outline.push_back({(*numbers)[0] * reader.units().length, (*numbers)[1] * reader.units().length});
  }
  return outline;
}

// Counter-clockwise (Andrew's monotone chain).
Polygon ConvexHull(Polygon points) {
  std::sort(points.begin(), points.end(),
            [](const Vec2& a, const Vec2& b) { return a.x() != b.x() ? a.x() < b.x() : a.y() < b.y(); });
  Polygon hull;
  for (int side = 0; side < 2; ++side) {
    const std::size_t first = hull.size();
    for (const Vec2& p : points) {
      // Not above 0: collinear points go, too.
      while (hull.size() >= first + 2 && !(Cross(hull.back() - hull[hull.size() - 2], p - hull.back()) > 0.0)) {
        hull.pop_back();
      }
      hull.push_back(p);
    }
    hull.pop_back();  // the first of the other side
    std::reverse(points.begin(), points.end());
  }
  return hull;
}

// The block in the file's coordinates, its outline normalized; nothing for one that is no body, or after an error.
std::optional<Block> ReadBlock(const WorldNode& node, const Units& units, Diagnostics& diagnostics) {
  PropertyReader reader(node, units, diagnostics);
  const std::optional<Polygon> outline = ReadPoints(reader);
  Block block;
  if (const auto z = reader.Numbers("z", 2)) {
    block.z = {(*z)[0] * units.length, (*z)[1] * units.length};
    if (block.z.min > block.z.max) {
      std::swap(block.z.min, block.z.max);
      diagnostics.Warn(reader.Where("z"), "found z from " + NumberText((*z)[0]) + " to " + NumberText((*z)[1]) +
                                              ", expected [min max]; they are exchanged");
    }
  }
  WarnOfUnusedInBlock(reader);
  if (!node.children.empty()) {
    diagnostics.Fail(node.children.front().where,
                     "found " + Quoted(node.children.front().type) + " inside a block, expected only properties");
  }
  if (!outline || diagnostics.failed()) return std::nullopt;
  Result<Polygon> normalized = Normalized(*outline);
  if (!normalized.ok()) {
    const std::string fault = "found a block that is no simple polygon: " + normalized.error().message;
    // The hull contains every outline that its author may have meant.
    normalized = outline->size() < 3 ? std::move(normalized) : Normalized(ConvexHull(*outline));
    diagnostics.Warn(node.where, fault + (normalized.ok() ? "; its convex hull is used" : "; it is left out"));
    if (!normalized.ok()) return std::nullopt;
  }
  block.outline = std::move(normalized).value();
  if (!(block.z.max > block.z.min)) {
    diagnostics.Warn(reader.Where("z"),
                     "this block has no height (its 'z' is missing or empty), so nothing can touch it");
  }
  return block;
}

constexpr double kBoundaryThickness = 0.01;  // m, as Stage's

// Warns if the margin around the occupied pixels is more than this part of the picture's side: then the body is larger
// than the person who measured the picture expects.
constexpr double kNoticeableMargin = 0.02;

void WarnOfMargin(PropertyReader& reader, const std::string& name, const BitmapRectangles& pixels) {
  const PixelRectangle bounds = pixels.bounds();
  const int width = bounds.x1 - bounds.x0;
  const int height = bounds.y1 - bounds.y0;
  if (width >= (1.0 - kNoticeableMargin) * pixels.width && height >= (1.0 - kNoticeableMargin) * pixels.height) return;
  const auto text = [](int x, int y) { return std::to_string(x) + " x " + std::to_string(y) + " pixels"; };
  reader.diagnostics().Warn(reader.Where("bitmap"),
                            "bitmap " + QuotedPath(name) + " has a blank margin: it is " +
                                text(pixels.width, pixels.height) + ", but " + text(width, height) +
                                " without its margin, and those are stretched to the model's size, as in Stage");
}

// The rectangles of the property `bitmap`, scaled to the model's size; nothing after an error.
std::optional<Shape> ReadBitmapShape(PropertyReader& reader, const Size& size, BuildContext& context) {
  const std::string name = reader.Text("bitmap", "");
  const SourceLocation& where = reader.Where("bitmap");
  if (context.without_bitmaps) {
    reader.diagnostics().Fail(where, "found a bitmap, which cannot be read here");
    return std::nullopt;
  }
  const auto bitmap = context.bitmaps.Load(FindFile(name, context.tree.directory, where.file), StagePixelRule(), where);
  if (!bitmap.ok()) {
    reader.diagnostics().Fail(bitmap.error().where, bitmap.error().message);
    return std::nullopt;
  }
  const BitmapRectangles& pixels = *bitmap.value();
  if (pixels.empty()) {
    reader.diagnostics().Warn(where, "bitmap " + QuotedPath(name) + " has no occupied pixel, so it has no body");
  } else {
    WarnOfMargin(reader, name, pixels);
  }
  Shape shape;
  for (const PixelRectangle& r : pixels.rectangles) {
    shape.rectangles.push_back(
        {static_cast<double>(r.x0), static_cast<double>(r.y0), static_cast<double>(r.x1), static_cast<double>(r.y1)});
  }
  if (pixels.dense != nullptr) shape.area = PixelArea(pixels.dense, {}, {});
  shape.rectangles_z = {0.0, 1.0};
  return ScaledToSize(std::move(shape), size);
}

// Walls along the inside of the model's outline.
std::vector<Block> BoundaryBlocks(const Size& size) {
  const double x = 0.5 * size.x;
  const double y = 0.5 * size.y;
  const double tx = std::min(kBoundaryThickness, size.x);
  const double ty = std::min(kBoundaryThickness, size.y);
  const ZRange z{0.0, size.z};
  return {BoxBlock({-x, -y, -x + tx, y}, z), BoxBlock({x - tx, -y, x, y}, z), BoxBlock({-x, -y, x, -y + ty}, z),
          BoxBlock({-x, y - ty, x, y}, z)};
}

bool HasBlocks(const WorldNode& node) {
  return std::any_of(node.children.begin(), node.children.end(),
                     [](const WorldNode& child) { return child.type == "block"; });
}

// Nothing after an error.
std::optional<std::vector<Block>> ReadBlocks(PropertyReader& reader) {
  std::vector<Block> blocks;
  for (const WorldNode& child : reader.node().children) {
    if (child.type != "block") continue;
    std::optional<Block> block = ReadBlock(child, reader.units(), reader.diagnostics());
    if (reader.diagnostics().failed()) return std::nullopt;
    if (block) blocks.push_back(std::move(*block));
  }
  return blocks;
}

// Of a body whose model has no height: flat to the eye, but hit by bodies that span its height, as in Stage, which
// tests heights inclusively.
constexpr double kFlatHeight = 1e-6;  // m

void Thicken(Shape& shape) {
  for (Block& block : shape.blocks) block.z.max = block.z.min + kFlatHeight;
  shape.rectangles_z.max = shape.rectangles_z.min + kFlatHeight;
}

// Blocks without height collide with nothing and are hit by no ray; a shape must not contain them.
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

// The body in the model's frame M, checked for validity in a world; an empty shape after an error.
Shape Placed(PropertyReader& reader, const Pose& X_MD, Shape body) {
  const std::string culprit = reader.node().Find("origin") != nullptr ? "origin" : "size";
  const auto fail = [&](const std::string& fault) {
    reader.diagnostics().Fail(reader.Where(culprit), "found a body that cannot be: " + fault);
    return Shape();
  };
  Shape shape = Moved(std::move(body), X_MD);
  DropFlatBlocks(shape);
  for (Block& block : shape.blocks) {
    Result<Polygon> outline = Normalized(std::move(block.outline));
    if (!outline.ok()) return fail(outline.error().message);
    block.outline = std::move(outline).value();
    if (!IsWithinReach(block.z)) return fail("its height is beyond 1000 km");
  }
  for (const Rectangle& rectangle : shape.rectangles) {
    if (!IsUsable(rectangle)) return fail("a pixel of its bitmap has no area, or is beyond 1000 km");
  }
  if (shape.area) {
    if (const Status status = shape.area->Check(); !status.ok()) return fail(status.error().message);
  }
  if (!IsWithinReach(shape.rectangles_z)) return fail("its height is beyond 1000 km");
  return shape;
}

// The map of one axis: stretched about `center`, which moves to 0.
struct AxisMap {
  double center = 0.0;
  double factor = 1.0;
  double operator()(double value) const { return (value - center) * factor; }
};

constexpr double kCellWallHeight = 2.0;  // m

// A map of square cells (worldfile/grids/grid_map.h), whose lower left corner is its origin.
std::optional<RosMap> ReadCellMap(PropertyReader& reader, BuildContext& context) {
  const double cell = reader.Length("cell_size", kDefaultCell / reader.units().length);
  const Property* property = reader.Use("map_cells");
  if (property == nullptr) return std::nullopt;
  const SourceLocation& where = property->value.where;
  if (!(cell >= kMinCell && cell <= kMaxCell)) {
    reader.diagnostics().Fail(reader.Where("cell_size"), "found cells of " + NumberText(cell) + " m, expected " +
                                                             NumberText(kMinCell) + " to " + NumberText(kMaxCell) +
                                                             " m");
    return std::nullopt;
  }
  if (context.without_bitmaps) {
    reader.diagnostics().Fail(where, "found a map, which cannot be read here");
    return std::nullopt;
  }
  const std::string path = FindFile(reader.Text("map_cells", ""), context.tree.directory, where.file);
  if (!IsGridMapPath(path)) {
    reader.diagnostics().Fail(where, "found " + QuotedPath(path) + ", expected a map of cells (.map, .pogema)");
    return std::nullopt;
  }
  const Result<GridMap> read = ReadGridMap(path, where, context.allowed);
  if (!read.ok()) {
    reader.diagnostics().Fail(read.error().where, read.error().message);
    return std::nullopt;
  }
  RosMap map;
  map.pixels = context.bitmaps.Keep(path, read.value().ToBitmap());
  map.resolution = cell;
  map.size = {map.pixels->width * cell, map.pixels->height * cell, kCellWallHeight};
  return map;
}

AxisMap FitAxis(double min, double max, double size) {
  if (!(max > min)) return {};
  return {0.5 * (min + max), size / (max - min)};
}

}  // namespace

std::optional<RosMap> ReadRosMap(PropertyReader& reader, BuildContext& context) {
  const Property* property = reader.Use("map_yaml");
  if (property == nullptr) return ReadCellMap(reader, context);
  const SourceLocation& where = property->value.where;
  if (context.without_bitmaps) {
    reader.diagnostics().Fail(where, "found a map, which cannot be read here");
    return std::nullopt;
  }
  const std::string path = FindFile(reader.Text("map_yaml", ""), context.tree.directory, where.file);
  const Result<MapYaml> yaml = ReadMapYaml(path, where, context.allowed);
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
  if (std::max(map.size.x, map.size.y) > kMaxMagnitude) {
    reader.diagnostics().Fail(where, "found a map of " + NumberText(map.size.x) + " x " + NumberText(map.size.y) +
                                         " m, expected at most 1000 km");
    return std::nullopt;
  }
  return map;
}

Shape ListedForMotion(PropertyReader& reader, Shape shape) {
  if (!shape.area) return shape;
  const std::size_t count = shape.area->cover().count();
  if (count <= kMaxMovingRectangles) return Listed(std::move(shape));
  reader.diagnostics().Fail(reader.Where(reader.node().Find("bitmap") != nullptr ? "bitmap" : "map_yaml"),
                            "found a bitmap of " + std::to_string(count) +
                                " rectangles in a model that moves, expected at most " +
                                std::to_string(kMaxMovingRectangles));
  return {};
}

Shape RosMapShape(PropertyReader& reader, const RosMap& map, const Size& size, const Pose& X_MD) {
  Shape shape;
  for (const PixelRectangle& r : map.pixels->rectangles) {
    shape.rectangles.push_back(
        {r.x0 * map.resolution, r.y0 * map.resolution, r.x1 * map.resolution, r.y1 * map.resolution});
  }
  if (map.pixels->dense != nullptr) {
    const PixelLines lines{.factor = map.resolution};
    shape.area = PixelArea(map.pixels->dense, lines, lines);
  }
  if (!shape.empty()) shape.rectangles_z = {0.0, size.z};
  return Placed(reader, X_MD, std::move(shape));
}

Shape ReadModelShape(PropertyReader& reader, bool has_box, const Size& size, const Pose& X_MD, BuildContext& context) {
  Shape shape;
  const bool without_box = reader.Flag("noblocks", false);
  const bool has_bitmap = reader.node().Find("bitmap") != nullptr;
  const bool has_boundary = reader.Flag("boundary", false);
  if (has_bitmap) {
    shape = ReadBitmapShape(reader, size, context).value_or(Shape());
  } else if (has_box && !without_box) {
    shape.blocks.push_back(BoxBlock({-0.5 * size.x, -0.5 * size.y, 0.5 * size.x, 0.5 * size.y}, {0.0, size.z}));
  }
  if (has_boundary && !shape.empty()) {
    // A model without a body has no boundary.
    for (Block& wall : BoundaryBlocks(size)) shape.blocks.push_back(std::move(wall));
  }
  const bool has_blocks = HasBlocks(reader.node());
  if (has_blocks && !has_bitmap) {
    if (shape.blocks.size() > 1) {
      reader.diagnostics().Warn(reader.Where("boundary"),
                                "property 'boundary' has no effect in a model with blocks and without a bitmap");
    }
    shape = {};
  }
  std::optional<std::vector<Block>> blocks = ReadBlocks(reader);
  if (!blocks || reader.diagnostics().failed()) return {};
  std::move(blocks->begin(), blocks->end(), std::back_inserter(shape.blocks));
  if (shape.empty()) return {};

  if (!(size.x > 0.0 && size.y > 0.0)) {
    reader.diagnostics().Warn(reader.Where("size"), "this model has a size of 0, so it has no body");
    return {};
  }
  // A lone bitmap has been stretched already, and a box has the size from the start.
  if (has_blocks) shape = ScaledToSize(std::move(shape), size);
  if (size.z == 0.0) Thicken(shape);
  return Placed(reader, X_MD, std::move(shape));
}

Shape ScaledToSize(Shape shape, const Size& size) {
  Rectangle bounds = Rectangle::Nothing();
  ZRange height{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
  const auto extend_height = [&height](const ZRange& z) {
    height.min = std::min(height.min, z.min);
    height.max = std::max(height.max, z.max);
  };
  for (const Block& block : shape.blocks) {
    bounds.Extend(BoundingBox(block.outline));
    extend_height(block.z);
  }
  for (const Rectangle& rectangle : shape.rectangles) bounds.Extend(rectangle);
  if (shape.area) bounds.Extend(shape.area->bounds());
  if (!shape.rectangles.empty() || shape.area) extend_height(shape.rectangles_z);
  if (bounds.empty()) return shape;

  const AxisMap x = FitAxis(bounds.min_x, bounds.max_x, size.x);
  const AxisMap y = FitAxis(bounds.min_y, bounds.max_y, size.y);
  const double z = height.max > height.min ? size.z / (height.max - height.min) : 1.0;
  for (Block& block : shape.blocks) {
    for (Vec2& vertex : block.outline) vertex = {x(vertex.x()), y(vertex.y())};
    block.z = {block.z.min * z, block.z.max * z};
  }
  for (Rectangle& r : shape.rectangles) r = {x(r.min_x), y(r.min_y), x(r.max_x), y(r.max_y)};
  if (shape.area) shape.area = shape.area->Stretched({x.center, y.center}, {x.factor, y.factor});
  shape.rectangles_z = {shape.rectangles_z.min * z, shape.rectangles_z.max * z};
  return shape;
}

Shape Moved(Shape shape, const Pose& X_MD) {
  // Rectangles stay along the axes, which makes them cheap; turned ones have to be polygons.
  if (X_MD.heading != 0.0 && !shape.area) {
    for (const Rectangle& rectangle : shape.rectangles) shape.blocks.push_back(BoxBlock(rectangle, shape.rectangles_z));
    shape.rectangles.clear();
    shape.rectangles_z = {};
  }
  const Transform2 move(X_MD);
  for (Block& block : shape.blocks) {
    for (Vec2& vertex : block.outline) vertex = move * vertex;
    block.z = block.z + X_MD.z;
  }
  for (Rectangle& r : shape.rectangles) {
    r = {r.min_x + X_MD.x, r.min_y + X_MD.y, r.max_x + X_MD.x, r.max_y + X_MD.y};
  }
  if (shape.area) shape.area = shape.area->Moved(X_MD);
  if (!shape.rectangles.empty() || shape.area) shape.rectangles_z = shape.rectangles_z + X_MD.z;
  return shape;
}

Block BoxBlock(const Rectangle& area, const ZRange& z) {
  const std::array<Vec2, 4> corners = Corners(area);
  return {Polygon(corners.begin(), corners.end()), z};
}

}  // namespace troupe
