#include "common/spatial/walk_routes.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>
#include <utility>

#include "troupe/check.h"
#include "troupe/rectangle.h"

namespace troupe {
namespace {

constexpr double kFinestCell = 0.1;       // m
constexpr double kCoarsestCell = 0.25;    // m
constexpr double kManyCells = 400'000.0;  // with more, cells are coarser
constexpr double kMostCells = 16e6;
constexpr double kBorder = 2.0;   // m, around all that is known
constexpr double kDetour = 1.5;   // m: a target is at most so far from its goal
constexpr double kComfort = 0.2;  // m: a cell so near to a wall counts twice
constexpr std::uint32_t kUnreached = std::numeric_limits<std::uint32_t>::max();
constexpr std::uint32_t kStraight = 10;  // the length of a step to the side of a cell
constexpr std::uint32_t kDiagonal = 14;
constexpr int kLookAhead = 48;  // steps

struct CellStep {
  int columns;
  int rows;
  std::uint32_t length;
};
// Numbers of steps in kSteps, and two more.
constexpr std::uint8_t kUnknownStep = 0xff;  // not looked for so far
constexpr std::uint8_t kNoStep = 0xfe;
constexpr std::array kSteps{CellStep{1, 0, kStraight},   CellStep{0, 1, kStraight}, CellStep{-1, 0, kStraight},
                            CellStep{0, -1, kStraight},  CellStep{1, 1, kDiagonal}, CellStep{-1, 1, kDiagonal},
                            CellStep{-1, -1, kDiagonal}, CellStep{1, -1, kDiagonal}};

}  // namespace

// The cells of one size of people.
class WalkRoutes::Layer {
 public:
  struct Size {
    ZRange z;
    double radius = 0.0;
    bool operator==(const Size&) const = default;
  };
  // Few sizes, so that there are few grids.
  static Size SizeOf(const Scene& scene, PersonId id) {
    constexpr double kClass = 0.05;  // m
    const PersonDescription& person = scene.world().person(id);
    const Body& body = scene.body(scene.body_of(id));
    const double radius = kClass * std::ceil(std::max(person.radius, body.radius) / kClass - 1e-6);
    return {body.z + scene.world().model(person.root).X_PM.z, radius};
  }

  Layer(const Scene& scene, const Size& its_size, const Rectangle& bounds) : size(its_size), bounds_(bounds) {
    cell_ = std::clamp(std::sqrt(bounds.width() * bounds.height() / kManyCells), kFinestCell, kCoarsestCell);
    cell_ = std::max(cell_, std::sqrt(bounds.width() * bounds.height() / kMostCells));
    columns_ = static_cast<int>(bounds.width() / cell_) + 1;
    rows_ = static_cast<int>(bounds.height() / cell_) + 1;
    room_.assign(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_), Room::kFree);
    for (std::size_t i = 0; i < kSteps.size(); ++i)
      offsets_[i] = kSteps[i].rows * std::ptrdiff_t{columns_} + kSteps[i].columns;
    scene.static_index().ForEachPiece([&](const ConvexPiece& piece) {
      if (piece.obstacle && piece.z.Overlaps(size.z)) Block(piece);
    });
  }

  std::size_t cell_count() const { return room_.size(); }
  double cell() const { return cell_; }
  bool IsFree(std::size_t cell) const { return room_[cell] != Room::kBlocked; }
  std::uint32_t CostOf(std::size_t cell) const { return room_[cell] == Room::kNearWall ? 2 : 1; }
  std::size_t CellAt(int column, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(column);
  }
  int ColumnOf(std::size_t cell) const { return static_cast<int>(cell % static_cast<std::size_t>(columns_)); }
  int RowOf(std::size_t cell) const { return static_cast<int>(cell / static_cast<std::size_t>(columns_)); }
  // Points beyond the grid belong to the nearest cell.
  int ColumnAt(double x) const { return Clamped((x - bounds_.min_x) / cell_, columns_); }
  int RowAt(double y) const { return Clamped((y - bounds_.min_y) / cell_, rows_); }
  std::size_t CellOf(const Vec2& p) const { return CellAt(ColumnAt(p.x()), RowAt(p.y())); }
  Vec2 CenterOf(std::size_t cell) const {
    return {bounds_.min_x + (ColumnOf(cell) + 0.5) * cell_, bounds_.min_y + (RowOf(cell) + 0.5) * cell_};
  }

  // The cell nearest to `p` for which accept(cell); of equally near ones the first.
  template <typename Accept>
  std::optional<std::size_t> Nearest(const Vec2& p, Accept accept) const {
    if (const std::size_t own = CellOf(p); accept(own)) return own;
    const int reach = static_cast<int>(kDetour / cell_);
    const int column = ColumnAt(p.x());
    const int row = RowAt(p.y());
    std::optional<std::size_t> best;
    double least = kDetour * kDetour;
    for (int r = std::max(0, row - reach); r <= std::min(rows_ - 1, row + reach); ++r) {
      for (int c = std::max(0, column - reach); c <= std::min(columns_ - 1, column + reach); ++c) {
        const std::size_t cell = CellAt(c, r);
        const double square = (CenterOf(cell) - p).squaredNorm();
        if (square >= least || !accept(cell)) continue;
        best = cell;
        least = square;
      }
    }
    return best;
  }

  // The cell behind a step.
  std::size_t Beside(std::size_t cell, std::size_t step) const {
    return cell + static_cast<std::size_t>(offsets_[step]);
  }

  // Calls visit(cell, number of the step) for the free neighbours, never across the corner of a blocked cell.
  template <typename Visit>
  void ForEachStep(std::size_t cell, Visit visit) const {
    const int column = ColumnOf(cell);
    const int row = RowOf(cell);
    for (std::size_t i = 0; i < kSteps.size(); ++i) {
      const CellStep& step = kSteps[i];
      const int c = column + step.columns;
      const int r = row + step.rows;
      if (c < 0 || r < 0 || c >= columns_ || r >= rows_ || !IsFree(CellAt(c, r))) continue;
      if (step.length == kDiagonal && (!IsFree(CellAt(c, row)) || !IsFree(CellAt(column, r)))) continue;
      visit(CellAt(c, r), i);
    }
  }

  // All cells between the points are free.
  bool IsClear(const Vec2& from, const Vec2& to) const {
    const Vec2 way = to - from;
    const int parts = static_cast<int>(2.0 * way.norm() / cell_) + 1;
    for (int i = 1; i <= parts; ++i) {
      if (!IsFree(CellOf(from + (static_cast<double>(i) / parts) * way))) return false;
    }
    return true;
  }

  const Size size;

 private:
  enum class Room : std::uint8_t { kFree, kNearWall, kBlocked };

  static int Clamped(double at, int count) { return at <= 0.0 ? 0 : at >= count ? count - 1 : static_cast<int>(at); }

  void Block(const ConvexPiece& piece) {
    const Rectangle box = BoundingBox(piece.vertices).Inflated(size.radius + kComfort);
    if (!box.Overlaps(bounds_)) return;
    for (int row = RowAt(box.min_y); row <= RowAt(box.max_y); ++row) {
      for (int column = ColumnAt(box.min_x); column <= ColumnAt(box.max_x); ++column) {
        const std::size_t cell = CellAt(column, row);
        if (room_[cell] == Room::kBlocked) continue;
        const Vec2 center = CenterOf(cell);
        const double distance = FindNearestPoints(std::span(&center, 1), piece.vertices).distance;
        if (distance < size.radius + kComfort) room_[cell] = Room::kNearWall;
        if (distance < size.radius) room_[cell] = Room::kBlocked;
      }
    }
  }

  Rectangle bounds_;
  double cell_ = kFinestCell;
  int columns_ = 0;
  int rows_ = 0;
  std::array<std::ptrdiff_t, kSteps.size()> offsets_{};  // of the numbers of cells, by step
  std::vector<Room> room_;
};

struct WalkRoutes::Field {
  Field(const Layer& its_layer, const Vec2& goal) : layer(its_layer) {
    const std::optional<std::size_t> cell = layer.Nearest(goal, [&](std::size_t c) { return layer.IsFree(c); });
    if (!cell) return;
    target = layer.CellOf(goal) == *cell ? goal : layer.CenterOf(*cell);
    length.assign(layer.cell_count(), kUnreached);
    // Dijkstra's algorithm with a list for each length that may be in it: lengths are small numbers.
    std::array<std::vector<std::size_t>, 2 * kDiagonal + 1> lists;
    length[*cell] = 0;
    lists[0].push_back(*cell);
    std::size_t waiting = 1;
    for (std::uint32_t at = 0; waiting > 0; ++at) {
      std::vector<std::size_t>& list = lists[at % lists.size()];
      for (std::size_t i = 0; i < list.size(); ++i) {
        const std::size_t from = list[i];
        --waiting;
        if (length[from] != at) continue;  // it was found on a shorter way
        layer.ForEachStep(from, [&](std::size_t to, std::size_t step) {
          const std::uint32_t there = at + kSteps[step].length * layer.CostOf(to);
          if (there >= length[to]) return;
          length[to] = there;
          lists[there % lists.size()].push_back(to);
          ++waiting;
        });
      }
      list.clear();
    }
    steps = std::vector<std::atomic<std::uint8_t>>(length.size());
    for (std::atomic<std::uint8_t>& step : steps) step.store(kUnknownStep, std::memory_order_relaxed);
  }

  // The neighbour with the shortest way, of equal ones the first; the cell itself where no way is shorter.
  std::size_t NextCell(std::size_t cell) const {
    std::uint8_t step = steps[cell].load(std::memory_order_relaxed);
    if (step == kUnknownStep) {
      step = kNoStep;
      std::uint32_t least = length[cell];
      layer.ForEachStep(cell, [&](std::size_t to, std::size_t number) {
        if (length[to] >= least) return;
        least = length[to];
        step = static_cast<std::uint8_t>(number);
      });
      steps[cell].store(step, std::memory_order_relaxed);
    }
    return step == kNoStep ? cell : layer.Beside(cell, step);
  }

  std::optional<std::size_t> StartOf(const Vec2& from) const {
    return layer.Nearest(from, [&](std::size_t cell) { return length[cell] != kUnreached; });
  }

  const Layer& layer;
  std::optional<Vec2> target;
  std::vector<std::uint32_t> length;  // by cell, kStraight for the side of one; empty without a target
  // By cell, in kSteps: found when a person first comes by, by any thread, as a pure function of the lengths.
  mutable std::vector<std::atomic<std::uint8_t>> steps;
};

WalkRoutes::~WalkRoutes() = default;

WalkRoutes::WalkRoutes(const Scene& scene) {
  const WorldDescription& world = scene.world();
  Rectangle bounds = scene.static_index().bounds();
  for (const GoalSet& set : world.goal_sets) {
    goals_.push_back(set.points);
    first_point_.push_back(points_);
    points_ += set.points.size();
    for (const Vec2& point : set.points) bounds.Extend(point);
  }
  for (const PersonDescription& person : world.people) bounds.Extend(world.model(person.root).X_PM.translation());
  bounds = bounds.Inflated(kBorder);
  layers_.reserve(world.people.size());  // fields refer to them
  for (std::size_t i = 0; i < world.people.size(); ++i) {
    const Layer::Size size = Layer::SizeOf(scene, PersonId(i));
    const auto same =
        std::find_if(layers_.begin(), layers_.end(), [&](const Layer& layer) { return layer.size == size; });
    layer_of_.push_back(static_cast<std::size_t>(same - layers_.begin()));
    if (same == layers_.end()) layers_.emplace_back(scene, size, bounds);
  }
  made_ = std::vector<std::once_flag>(layers_.size() * points_);
  fields_.resize(layers_.size() * points_);
}

const WalkRoutes::Field& WalkRoutes::FieldOf(PersonId person, std::uint32_t goals, std::uint32_t point) const {
  TROUPE_CHECK(goals < goals_.size() && point < goals_[goals].size());
  const std::size_t layer = layer_of_[person.index()];
  const std::size_t number = layer * points_ + first_point_[goals] + point;
  std::call_once(made_[number],
                 [&] { fields_[number] = std::make_unique<const Field>(layers_[layer], goals_[goals][point]); });
  return *fields_[number];
}

std::optional<Vec2> WalkRoutes::Target(PersonId person, std::uint32_t goals, std::uint32_t point) const {
  return FieldOf(person, goals, point).target;
}

std::optional<double> WalkRoutes::Length(PersonId person, std::uint32_t goals, std::uint32_t point,
                                         const Vec2& from) const {
  const Field& field = FieldOf(person, goals, point);
  if (!field.target) return std::nullopt;
  const std::optional<std::size_t> start = field.StartOf(from);
  if (!start) return std::nullopt;
  return field.length[*start] * field.layer.cell() / kStraight;
}

std::optional<Vec2> WalkRoutes::NextPoint(PersonId person, std::uint32_t goals, std::uint32_t point,
                                          const Vec2& from) const {
  const Field& field = FieldOf(person, goals, point);
  if (!field.target) return std::nullopt;
  const Layer& layer = field.layer;
  const std::optional<std::size_t> start = field.StartOf(from);
  if (!start) return std::nullopt;
  // Beside the free cells, where a person is pressed against a wall: back to them first.
  if (*start != layer.CellOf(from)) return layer.CenterOf(*start);
  std::array<std::size_t, kLookAhead> way;
  int steps = 0;
  for (std::size_t at = *start; steps < kLookAhead; ++steps) {
    const std::size_t next = field.NextCell(at);
    if (next == at) break;  // the goal
    way[static_cast<std::size_t>(steps)] = at = next;
  }
  const bool is_near = steps == 0 || field.length[way[static_cast<std::size_t>(steps) - 1]] == 0;
  if (is_near && layer.IsClear(from, *field.target)) return *field.target;
  for (int ahead = steps; ahead > 1; ahead = ahead * 3 / 4) {
    const Vec2 center = layer.CenterOf(way[static_cast<std::size_t>(ahead) - 1]);
    if (layer.IsClear(from, center)) return center;
  }
  return steps > 0 ? layer.CenterOf(way[0]) : *field.target;
}

}  // namespace troupe
