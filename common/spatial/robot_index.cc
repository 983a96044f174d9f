#include "common/spatial/robot_index.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/base/check.h"

namespace troupe {
namespace {

constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
constexpr double kSmallestCell = 0.01;  // m

Rectangle BoundsOf(const std::vector<Pose>& poses) {
  Rectangle bounds = Rectangle::Nothing();
  for (const Pose& pose : poses) bounds.Extend(pose.translation());
  return bounds;
}

}  // namespace

void RobotIndex::Assign(const WorldState& state) {
  const std::size_t count = state.robots.size();
  TROUPE_CHECK(count == scene_->world().robots.size());
  if (X_WR_.size() != count) {
    X_WR_.clear();
    for (const RobotState& robot : state.robots) X_WR_.push_back(robot.X_WR);
    cache_.assign(count, {});
    if (count > 0) Rebuild();
    return;
  }
  for (std::size_t i = 0; i < count; ++i) Move(RobotId(i), state.robots[i].X_WR);
  if (count > 0 && !FitsGrid()) Rebuild();
}

void RobotIndex::Move(RobotId robot, const Pose& X_WR) {
  const auto index = static_cast<std::uint32_t>(robot.index());
  if (X_WR_[index] == X_WR) return;
  X_WR_[index] = X_WR;
  cache_[index].fresh = false;
  if (grid_.CellOf(X_WR.translation()) == cell_of_[index]) return;
  Remove(index);
  Insert(index);
}

const std::vector<ConvexPiece>& RobotIndex::pieces_in_world(RobotId robot) const {
  Cache& cache = cache_[robot.index()];
  if (cache.fresh) return cache.pieces;
  const std::vector<ConvexPiece>& pieces_in_robot = scene_->body(robot).pieces;
  const Pose& X_WR = X_WR_[robot.index()];
  if (cache.pieces.size() != pieces_in_robot.size()) cache.pieces = pieces_in_robot;
  const Transform2 transform(X_WR);
  for (std::size_t i = 0; i < pieces_in_robot.size(); ++i) {
    const ConvexPiece& from = pieces_in_robot[i];
    ConvexPiece& to = cache.pieces[i];
    to.z = from.z + X_WR.z;
    for (std::size_t v = 0; v < from.vertices.size(); ++v) to.vertices[v] = transform * from.vertices[v];
  }
  cache.fresh = true;
  return cache.pieces;
}

void RobotIndex::Query(const Rectangle& box, std::vector<RobotId>& result) const {
  if (X_WR_.empty() || box.empty()) return;
  // A robot is in the cell of its origin, so its body may reach into the box from as far as the largest radius.
  const CellRange range = grid_.CellsOf(box.Inflated(scene_->max_body_radius()));
  if (range.count() >= X_WR_.size()) {
    for (std::size_t i = 0; i < X_WR_.size(); ++i) {
      if (MayOverlap(static_cast<std::uint32_t>(i), box)) result.push_back(RobotId(i));
    }
    return;
  }
  const auto first = static_cast<std::ptrdiff_t>(result.size());
  for (std::int32_t row = range.min_row; row <= range.max_row; ++row) {
    for (std::int32_t column = range.min_column; column <= range.max_column; ++column) {
      for (std::uint32_t i = cell_first_[grid_.CellAt(column, row)]; i != kNone; i = next_[i]) {
        if (MayOverlap(i, box)) result.push_back(RobotId(i));
      }
    }
  }
  std::sort(result.begin() + first, result.end());
}

bool RobotIndex::MayOverlap(std::uint32_t robot, const Rectangle& box) const {
  // A hair more than the radius, because moving the body rounds.
  const double radius = scene_->body(RobotId(robot)).radius * (1.0 + 1e-9) + 1e-9;
  return box.Inflated(radius).Contains(X_WR_[robot].translation());
}

// The grid fits as long as all robots are in it and do not huddle in a small part of it. It is correct anyway, only
// slower.
bool RobotIndex::FitsGrid() const {
  const Rectangle bounds = BoundsOf(X_WR_);
  const Rectangle& grid = grid_.bounds();
  return grid.Contains({bounds.min_x, bounds.min_y}) && grid.Contains({bounds.max_x, bounds.max_y}) &&
         4.0 * (std::max(bounds.width(), bounds.height()) + grid_.cell_size()) >= std::max(grid.width(), grid.height());
}

void RobotIndex::Rebuild() {
  const std::size_t count = X_WR_.size();
  const Rectangle tight = BoundsOf(X_WR_);
  const double smallest_cell = std::max(2.0 * scene_->max_body_radius(), kSmallestCell);
  // Room to drive without having to rebuild.
  const Rectangle bounds = tight.Inflated(0.25 * std::max(tight.width(), tight.height()) + smallest_cell);
  const double robots = static_cast<double>(count);
  const double cell = std::max(smallest_cell, std::sqrt(bounds.width() * bounds.height() / robots));
  grid_ = Grid(bounds, cell, 2.0 * robots + 16.0);
  cell_first_.assign(grid_.cell_count(), kNone);
  next_.assign(count, kNone);
  cell_of_.assign(count, 0);
  for (std::size_t i = 0; i < count; ++i) Insert(static_cast<std::uint32_t>(i));
}

void RobotIndex::Insert(std::uint32_t robot) {
  const std::size_t cell = grid_.CellOf(X_WR_[robot].translation());
  cell_of_[robot] = static_cast<std::uint32_t>(cell);
  next_[robot] = cell_first_[cell];
  cell_first_[cell] = robot;
}

void RobotIndex::Remove(std::uint32_t robot) {
  std::uint32_t* link = &cell_first_[cell_of_[robot]];
  while (*link != robot) link = &next_[*link];
  *link = next_[robot];
}

}  // namespace troupe
