#include "worldfile/models/properties/build_context.h"

#include "common/base/hash.h"
#include "worldfile/text/quote.h"

namespace troupe {
namespace {

constexpr std::size_t kMaxNameLength = 1000;

void AddRange(const ZRange& z, Hasher& hasher) {
  hasher.Add(z.min);
  hasher.Add(z.max);
}

std::uint64_t HashOf(const Shape& shape) {
  Hasher hasher;
  for (const Block& block : shape.blocks) {
    hasher.Add(std::uint64_t{block.outline.size()});
    for (const Vec2& vertex : block.outline) {
      hasher.Add(vertex.x());
      hasher.Add(vertex.y());
    }
    AddRange(block.z, hasher);
  }
  for (const Rectangle& rectangle : shape.rectangles) {
    hasher.Add(rectangle.min_x);
    hasher.Add(rectangle.min_y);
    hasher.Add(rectangle.max_x);
    hasher.Add(rectangle.max_y);
  }
  AddRange(shape.rectangles_z, hasher);
  if (shape.area) {
    hasher.Add(std::uint64_t{shape.area->cover().count()});
    const Rectangle bounds = shape.area->bounds();
    for (const double edge : {bounds.min_x, bounds.min_y, bounds.max_x, bounds.max_y}) hasher.Add(edge);
  }
  return hasher.value();
}

}  // namespace

void ModelNames::Add(const WorldNode& node, const std::string& name, Diagnostics& diagnostics) {
  const Property* given = node.Find("name");
  const SourceLocation& where = given != nullptr ? given->value.where : node.where;
  if (given != nullptr && !std::holds_alternative<std::string>(given->value.content)) {
    diagnostics.Fail(where, "found a name that is not a string, expected it in quotes");
  } else if (name.empty() || name.back() == '.') {
    diagnostics.Fail(where, "found an empty name, expected at least one character");
  } else if (name.size() > kMaxNameLength) {
    diagnostics.Fail(where, "found a name of " + std::to_string(name.size()) + " bytes, expected at most " +
                                std::to_string(kMaxNameLength));
  } else if (const auto [first, is_new] = places_.emplace(name, where); !is_new) {
    diagnostics.Fail(where, "found name " + Quoted(name) + " twice, expected each name once (first at " +
                                first->second.file + ":" + std::to_string(first->second.line) + ")");
  }
}

ShapeId ShapeStore::Add(Shape shape) {
  const std::uint64_t hash = HashOf(shape);
  const auto [begin, end] = by_hash_.equal_range(hash);
  for (auto entry = begin; entry != end; ++entry) {
    if (shapes_[entry->second.index()] == shape) return entry->second;
  }
  const ShapeId id(shapes_.size());
  shapes_.push_back(std::move(shape));
  by_hash_.emplace(hash, id);
  return id;
}

}  // namespace troupe
