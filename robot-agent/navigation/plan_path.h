// PlanPath: the cheapest way on an EvidenceGrid, for controllers that plan.
#pragma once

#include <optional>
#include <vector>

#include "robot-agent/navigation/evidence_grid.h"

namespace troupe {

// The way (m, E; the centres of cells) from `from` to the nearest cell whose centre is within `reach` m of `goal`, at
// least `clearance` m away from occupied cells where that is possible. Cells never seen cost more than free ones.
// Nothing if no way is known, or a point is outside.
std::optional<std::vector<Vec2>> PlanPath(const EvidenceGrid& grid, const Vec2& from, const Vec2& goal, double reach,
                                          double clearance);

// The same through free cells to the nearest cell that was never seen, which is the last point.
std::optional<std::vector<Vec2>> PlanToUnknown(const EvidenceGrid& grid, const Vec2& from, double clearance);

}  // namespace troupe
