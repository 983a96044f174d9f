// StaticIndex: the pieces of all models that never move, in a uniform grid.
#pragma once

#include <cstdint>
#include <vector>

#include "common/geometry/rectangle.h"
#include "common/spatial/convex_piece.h"

namespace troupe {

class StaticIndex {
 public:
  StaticIndex() = default;
  explicit StaticIndex(std::vector<ConvexPiece> pieces);

  const std::vector<ConvexPiece>& pieces() const { return pieces_; }
  const Rectangle& bounds() const { return bounds_; }

  // Indices of the pieces whose bounding boxes may overlap `box`: ascending, without repeats. Appends to `result`.
  void Query(const Rectangle& box, std::vector<std::uint32_t>& result) const;

 private:
  // (an implementation's own members)
  std::vector<ConvexPiece> pieces_;
  Rectangle bounds_ = Rectangle::Nothing();
};

}  // namespace troupe
