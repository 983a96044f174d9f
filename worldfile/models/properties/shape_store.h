// ShapeStore: keeps each geometry once, so that models made from one macro share their shape.
#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "troupe/world_description.h"

namespace troupe {

class ShapeStore {
 public:
  // `shapes` must outlive the store.
  explicit ShapeStore(std::vector<Shape>& shapes) : shapes_(shapes) {}

  // The id of a shape equal to this one, which is added if there is none.
  ShapeId Add(Shape shape);

 private:
  std::vector<Shape>& shapes_;
  std::multimap<std::uint64_t, ShapeId> by_hash_;
};

}  // namespace troupe
