#include "robot-agent/navigation/evidence_grid.h"

#include <algorithm>
#include <cmath>

namespace troupe {
namespace {

constexpr int kHit = 3;
constexpr int kPass = -1;
constexpr int kMostEvidence = 12;

}  // namespace

EvidenceGrid::EvidenceGrid(const Vec2& center, double side, double cell)
    : corner_(center - Vec2(0.5 * side, 0.5 * side)),
      cell_(cell),
      width_(static_cast<std::size_t>(std::ceil(side / cell))),
      evidence_(width_ * width_, 0) {}

std::optional<std::size_t> EvidenceGrid::IndexOf(const Vec2& point) const {
  const Vec2 place = (point - corner_) / cell_;
  const double width = static_cast<double>(width_);
  if (!(place.x() >= 0.0 && place.y() >= 0.0 && place.x() < width && place.y() < width)) return std::nullopt;
  return static_cast<std::size_t>(place.y()) * width_ + static_cast<std::size_t>(place.x());
}

Vec2 EvidenceGrid::CenterOf(std::size_t index) const {
  const std::size_t row = index / width_;
  return corner_ + cell_ * Vec2(static_cast<double>(index % width_) + 0.5, static_cast<double>(row) + 0.5);
}

void EvidenceGrid::Add(std::size_t index, int evidence) {
  int sum = std::clamp(evidence_[index] + evidence, -kMostEvidence, kMostEvidence);
  if (sum == 0) sum = evidence > 0 ? 1 : -1;  // 0: never seen
  evidence_[index] = static_cast<std::int8_t>(sum);
}

void EvidenceGrid::Observe(const Vec2& origin, const Vec2& direction, double range, bool hit) {
  const std::optional<std::size_t> end = hit ? IndexOf(origin + range * direction) : std::nullopt;
  std::optional<std::size_t> last;
  const double step = 0.5 * cell_;
  const auto count = static_cast<std::size_t>(range / step);
  for (std::size_t i = 0; i <= count; ++i) {
    const std::optional<std::size_t> index = IndexOf(origin + (static_cast<double>(i) * step) * direction);
    if (!index || index == last || index == end) continue;
    last = index;
    Add(*index, kPass);
  }
  if (end) Add(*end, kHit);
}

}  // namespace troupe
