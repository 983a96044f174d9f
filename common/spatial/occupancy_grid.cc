#include "common/spatial/occupancy_grid.h"

#include <algorithm>
#include <cmath>

#include "common/model/states.h"

namespace troupe {
namespace {

constexpr double kSliver = 1e-6;  // of a cell's side: less than this of a cell does not count as a part
constexpr double kDefaultHeight = 0.1;

// The extent along x of the part of a convex polygon between the lines y = low and y = high; empty without one.
// By the vertices between the lines and the edges that cross them: the part is convex, so that its extent is between
// these.
Interval Extent(const std::vector<Vec2>& polygon, double low, double high) {
  Interval extent{1.0, 0.0};
  const auto extend = [&extent](double x) {
    extent = extent.min > extent.max ? Interval{x, x} : Interval{std::min(extent.min, x), std::max(extent.max, x)};
  };
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec2& a = polygon[i];
    const Vec2& b = polygon[(i + 1) % polygon.size()];
    if (a.y() >= low && a.y() <= high) extend(a.x());
    for (const double line : {low, high}) {
      if ((a.y() < line) == (b.y() < line)) continue;
      extend(a.x() + (b.x() - a.x()) * (line - a.y()) / (b.y() - a.y()));
    }
  }
  return extent;
}

// The cells [first, last) that the interval covers a part of.
struct Cells {
  std::int64_t first;
  std::int64_t last;
};
Cells CellsOf(double min, double max, double origin, double resolution, std::uint32_t count) {
  const auto first = static_cast<std::int64_t>(std::floor((min - origin) / resolution + kSliver));
  const auto last = static_cast<std::int64_t>(std::ceil((max - origin) / resolution - kSliver));
  return {std::max<std::int64_t>(first, 0), std::min<std::int64_t>(last, count)};
}

void Mark(const std::vector<Vec2>& polygon, OccupancyGrid& grid) {
  double min_y = polygon.front().y();
  double max_y = min_y;
  for (const Vec2& vertex : polygon) {
    min_y = std::min(min_y, vertex.y());
    max_y = std::max(max_y, vertex.y());
  }
  const Cells rows = CellsOf(min_y, max_y, grid.origin_y, grid.resolution, grid.height);
  const double inset = kSliver * grid.resolution;  // so that a side on a cell's edge marks one side of it only
  for (std::int64_t row = rows.first; row < rows.last; ++row) {
    const double y = grid.origin_y + static_cast<double>(row) * grid.resolution;
    const Interval x = Extent(polygon, y + inset, y + grid.resolution - inset);
    if (x.min > x.max) continue;
    const Cells cells = CellsOf(x.min, x.max, grid.origin_x, grid.resolution, grid.width);
    for (std::int64_t cell = cells.first; cell < cells.last; ++cell) {
      grid.occupied[static_cast<std::size_t>(row * grid.width + cell)] = true;
    }
  }
}

// The extent of a world's grid; its cells are aligned to `corner`.
struct GridExtent {
  Rectangle bounds = Rectangle::Nothing();
  Vec2 corner{0.0, 0.0};
  std::optional<double> resolution;  // m, of the world's first ROS map
};

GridExtent ExtentOf(const Scene& scene) {
  GridExtent extent{scene.static_index().bounds(), {0.0, 0.0}, std::nullopt};
  const WorldDescription& world = scene.world();
  std::vector<Pose> poses;
  bool is_aligned = false;
  for (std::size_t i = 0; i < world.models.size(); ++i) {
    const ModelDescription& model = world.models[i];
    if (model.map.columns == 0 || model.removed || scene.body_of(ModelId(i))) continue;
    if (poses.empty()) poses = ModelPoses(world, PlacedState(world));
    const Transform2 to_world(poses[i]);
    const double width = model.map.columns * model.map.resolution;
    const double height = model.map.rows * model.map.resolution;
    for (const Vec2& corner : Corners({0.0, 0.0, width, height})) {
      extent.bounds.Extend(Vec2(to_world * corner));
    }
    if (!extent.resolution) extent.resolution = model.map.resolution;
    if (is_aligned || poses[i].heading != 0.0) continue;
    is_aligned = true;
    extent.corner = poses[i].translation();
  }
  if (!is_aligned) extent.corner = {extent.bounds.min_x, extent.bounds.min_y};
  return extent;
}

// The cells from the one with `min` up to `max`, along an axis on which a cell begins at `corner`.
struct Span {
  double origin = 0.0;  // m
  double count = 0.0;
};
Span SpanOf(double min, double max, double corner, double resolution) {
  const double before = std::max(0.0, std::ceil((corner - min) / resolution - kSliver));
  const double origin = corner - before * resolution;
  return {origin, std::max(1.0, std::ceil((max - origin) / resolution - kSliver))};
}

}  // namespace

OccupancyGrid MakeOccupancyGrid(const Scene& scene, std::optional<double> resolution, double z,
                                std::uint64_t most_cells) {
  OccupancyGrid grid;
  const GridExtent extent = ExtentOf(scene);
  const Rectangle& bounds = extent.bounds;
  if (bounds.empty()) return grid;
  grid.resolution = resolution ? *resolution : extent.resolution.value_or(kDefaultGridResolution);
  Span x;
  Span y;
  // Doubled, not fitted: cells of a map stay multiples of the pixels it was read from.
  for (;; grid.resolution *= 2.0) {
    x = SpanOf(bounds.min_x, bounds.max_x, extent.corner.x(), grid.resolution);
    y = SpanOf(bounds.min_y, bounds.max_y, extent.corner.y(), grid.resolution);
    if (x.count * y.count <= static_cast<double>(most_cells)) break;
  }
  grid.origin_x = x.origin;
  grid.origin_y = y.origin;
  grid.width = static_cast<std::uint32_t>(x.count);
  grid.height = static_cast<std::uint32_t>(y.count);
  grid.occupied.assign(std::size_t{grid.width} * grid.height, false);
  scene.static_index().ForEachPiece([&](const ConvexPiece& piece) {
    if (piece.z.Contains(z) && (piece.obstacle || piece.ranger_return >= 0.0)) Mark(piece.vertices, grid);
  });
  return grid;
}

double UsualMapHeight(const Scene& scene) {
  std::optional<double> lowest;
  const WorldDescription& world = scene.world();
  for (const RobotDescription& robot : world.robots) {
    const double z_of_robot = world.model(robot.root).X_PM.z;
    for (const SensorDescription& mounted : robot.sensors) {
      const RangerParameters* const ranger = std::get_if<RangerParameters>(&mounted.parameters);
      if (ranger == nullptr) continue;
      for (const RaySensorDescription& sensor : *ranger->ray_sensors) {
        if (sensor.samples < 2) continue;
        const double z = z_of_robot + scene.X_RM(mounted.model).z + sensor.X_MS.z;
        if (!lowest || z < *lowest) lowest = z;
      }
    }
  }
  return lowest.value_or(kDefaultHeight);
}

}  // namespace troupe
