#include "common/spatial/occupancy_grid.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace troupe {
namespace {

constexpr double kSliver = 1e-6;  // of a cell's side: less than this of a cell does not count as a part
constexpr double kDefaultHeight = 0.1;

// The extent along x of the part of a convex polygon between the lines y = low and y = high; empty without one.
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

}  // namespace

OccupancyGrid MakeOccupancyGrid(const Scene& scene, double resolution, double z) {
  OccupancyGrid grid;
  const Rectangle& bounds = scene.static_index().bounds();
  if (bounds.empty()) return grid;
  const auto cells_along = [](double length, double side) { return std::max(1.0, std::ceil(length / side - kSliver)); };
  while (cells_along(bounds.width(), resolution) * cells_along(bounds.height(), resolution) >
         static_cast<double>(kMaxGridCells)) {
    resolution *= 2.0;
  }
  grid.resolution = resolution;
  grid.origin_x = bounds.min_x;
  grid.origin_y = bounds.min_y;
  grid.width = static_cast<std::uint32_t>(cells_along(bounds.width(), resolution));
  grid.height = static_cast<std::uint32_t>(cells_along(bounds.height(), resolution));
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
      for (const RaySensorDescription& sensor : ranger->ray_sensors) {
        if (sensor.samples < 2) continue;
        const double z = z_of_robot + scene.X_RM(mounted.model).z + sensor.X_MS.z;
        if (!lowest || z < *lowest) lowest = z;
      }
    }
  }
  return lowest.value_or(kDefaultHeight);
}

}  // namespace troupe
