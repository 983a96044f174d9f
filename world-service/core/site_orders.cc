// What operators change in a site (step_workspace.h: TimedInputs, RuleLanes, CoverZones): actions at given times, rules
// of lanes, zones, and the cells of cleaning zones.
#include <algorithm>
#include <cmath>
#include <vector>

#include "common/model/lane_rules.h"
#include "common/model/states.h"
#include "common/model/zones.h"
#include "common/spatial/convex_piece.h"
#include "troupe/polygon.h"
#include "world-service/core/step_workspace.h"

namespace troupe {
namespace {

Order OrderOf(const TimedAction& action) {
  switch (action.kind) {
    case TimedKind::kDoor:
      return DoorOrder{action.number, action.value};
    case TimedKind::kLift:
      return LiftOrder{.lift = action.number, .floor = static_cast<std::size_t>(action.value)};
    case TimedKind::kLane:
      return LaneOrder{action.number, action.value};
    case TimedKind::kZone:
      break;
  }
  return ZoneOrder{action.number, action.value != 0.0};
}

void SetRule(std::vector<LaneRule>& rules, std::uint32_t lane, double speed_limit) {
  const auto place = std::lower_bound(rules.begin(), rules.end(), lane,
                                      [](const LaneRule& rule, std::uint32_t number) { return rule.lane < number; });
  const bool has_rule = place != rules.end() && place->lane == lane;
  if (speed_limit < 0.0) {
    if (has_rule) rules.erase(place);
  } else if (has_rule) {
    place->speed_limit = speed_limit;
  } else {
    rules.insert(place, {lane, speed_limit});
  }
}

// Convex and counter-clockwise.
bool IsWithin(std::span<const Vec2> outline, const Vec2& point) {
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const Vec2 side = outline[(i + 1) % outline.size()] - outline[i];
    const Vec2 to = point - outline[i];
    if (side.x() * to.y() - side.y() * to.x() < 0.0) return false;
  }
  return true;
}

// Of the cells of a zone those whose middle is on a piece of a body.
class ZoneCover {
 public:
  ZoneCover(const ZoneDescription& zone, const CoverageGrid& grid, ZoneState& state,
            std::vector<CoverageState>& coverage)
      : zone_(zone), grid_(grid), state_(state), coverage_(coverage) {}

  void Add(const ConvexPiece& piece) {
    const Rectangle box = BoundingBox(piece.vertices);
    const auto [first_column, end_column] =
        Range(box.min_x - grid_.corner.x(), box.max_x - grid_.corner.x(), grid_.columns);
    const auto [first_row, end_row] = Range(box.min_y - grid_.corner.y(), box.max_y - grid_.corner.y(), grid_.rows);
    for (std::size_t row = first_row; row < end_row; ++row) {
      for (std::size_t column = first_column; column < end_column; ++column) AddCell(piece, column, row);
    }
  }

 private:
  // The cells whose middle may be from `from` to `to` m.
  static std::pair<std::size_t, std::size_t> Range(double from, double to, std::size_t count) {
    const auto bound = [count](double cell) {
      return static_cast<std::size_t>(std::clamp(cell, 0.0, static_cast<double>(count)));
    };
    return {bound(std::floor(from / kCoverageCell)), bound(std::ceil(to / kCoverageCell))};
  }

  void AddCell(const ConvexPiece& piece, std::size_t column, std::size_t row) {
    const std::size_t cell = row * grid_.columns + column;
    std::uint32_t& bits = coverage_[grid_.first + cell / 32].cells;
    const std::uint32_t bit = std::uint32_t{1} << (cell % 32);
    if ((bits & bit) != 0) return;
    const Vec2 middle = grid_.MiddleOf(column, row);
    if (!IsWithin(piece.vertices, middle) || !Contains(zone_.outline, middle)) return;
    bits |= bit;
    ++state_.covered;
  }

  const ZoneDescription& zone_;
  const CoverageGrid& grid_;
  ZoneState& state_;
  std::vector<CoverageState>& coverage_;
};

}  // namespace

std::vector<Input> TimedInputs(const WorldDescription& world, Tick tick) {
  std::vector<Input> inputs;
  for (const TimedAction& action : world.timed_actions) {
    if (std::max<Tick>(TicksIn(world, action.at), 1) == tick) inputs.push_back({{}, OrderOf(action)});
  }
  return inputs;
}

void RuleLanes(const TickOrders& orders, StepWorkspace& workspace) {
  orders.ForEachInput<LaneOrder>([&](const std::optional<RobotId>&, const LaneOrder& order) {
    for (const std::uint32_t lane : LanesOnLine(workspace.world(), order.lane)) {
      SetRule(workspace.next.lane_rules, lane, order.speed_limit);
    }
  });
  orders.ForEachInput<ZoneOrder>([&](const std::optional<RobotId>&, const ZoneOrder& order) {
    workspace.next.zones[order.zone].is_on = order.on;
  });
}

void CoverZones(StepWorkspace& workspace) {
  const WorldDescription& world = workspace.world();
  if (workspace.next.coverage.empty()) return;
  const std::vector<CoverageGrid> grids = CoverageGrids(world);
  for (std::size_t i = 0; i < grids.size(); ++i) {
    if (grids[i].count() == 0 || !workspace.next.zones[i].is_on) continue;
    const ZoneDescription& zone = world.zones[i];
    ZoneCover cover(zone, grids[i], workspace.next.zones[i], workspace.next.coverage);
    const Rectangle box = BoundingBox(zone.outline);
    for (std::size_t robot = 0; robot < world.robots.size(); ++robot) {
      const Pose& X_WR = workspace.next.robots[robot].X_WR;
      const BodyId body = workspace.scene.body_of(RobotId(robot));
      const double radius = workspace.scene.body(body).radius;
      if (X_WR.x < box.min_x - radius || X_WR.x > box.max_x + radius || X_WR.y < box.min_y - radius ||
          X_WR.y > box.max_y + radius || !RobotExists(world, RobotId(robot)) ||
          (!world.levels.empty() && LevelAt(world.levels, zone.z) != LevelAt(world.levels, X_WR.z))) {
        continue;
      }
      for (const ConvexPiece& piece : workspace.bodies.pieces_in_world(body)) cover.Add(piece);
    }
  }
}

}  // namespace troupe
