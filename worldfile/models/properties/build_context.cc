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

std::string ModelNames::Add(const WorldNode& node, const std::string& name, Diagnostics& diagnostics) {
  const Property* const property = node.Find("name");
  const SourceLocation& where = property != nullptr ? property->value.where : node.where;
  if (name.size() > kMaxNameLength) {
    diagnostics.Fail(where, "found a name of " + std::to_string(name.size()) + " bytes, expected at most " +
                                std::to_string(kMaxNameLength));
  }
  const std::string free = free_.Add(name);
  const auto first = places_.emplace(free, where).first;
  if (property == nullptr) return free;
  const std::optional<std::string> given = GivenName(node);
  if (!given) {
    diagnostics.Warn(where, "found a 'name' that cannot be one; the model is called " + Quoted(free));
    return free;
  }
  if (!std::holds_alternative<std::string>(property->value.content)) {
    diagnostics.Warn(where,
                     "found a name that is not a string, expected it in quotes; it is read as " + Quoted(*given));
  }
  // A child before this one may have the name, or a model elsewhere.
  const std::string ending = given->starts_with('/') ? given->substr(1) : *given;
  if (free == ending || free.ends_with("." + ending)) return free;
  const auto other = places_.find(free.substr(0, free.rfind(ending) + ending.size()));
  const SourceLocation& place = (other != places_.end() ? other : first)->second;
  diagnostics.Warn(where, "found name " + Quoted(ending) + " twice, expected each name once (first at " + place.file +
                              ":" + std::to_string(place.line) + "); the others get a number, as in " +
                              Quoted(ending + ":2"));
  return free;
}

void ModelNames::AddPart(const SourceLocation& where, const std::string& name, Diagnostics& diagnostics) {
  if (free_.Add(name) != name) {
    diagnostics.Fail(where, "found name " + Quoted(name) + " twice, expected each name once");
  }
  places_.emplace(name, where);
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
