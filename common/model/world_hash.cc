// The hash of a world description. A bitmap may be a list of rectangles or an area of pixels, by its size only
// (worldfile/map/map_yaml.h); both forms of one geometry have one hash, because a program with another limit must agree
// on the world. Hence AddShape adds an area in the order in which Listed would list it.
#include <cstdint>

#include "common/model/field_hasher.h"
#include "troupe/world_description.h"

namespace troupe {

void FieldHasher::AddShape(const Shape& shape) {
  if (!shape.area) {
    Add(shape.blocks);
    Add(shape.rectangles);
    Add(shape.rectangles_z);
    return;
  }
  const PixelArea& area = *shape.area;
  const bool turned = area.X_MA().heading != 0.0;
  AddNumber(shape.blocks.size() + (turned ? area.cover().count() : 0));
  for (const Block& block : shape.blocks) Add(block);
  const Transform2 transform(area.X_MA());
  if (turned) {
    area.ForEach([&](const Rectangle& r) {
      AddNumber(4);  // corners
      for (const Vec2& corner : Corners(r)) Add(Vec2(transform * corner));
      Add(shape.rectangles_z);
    });
  }
  AddNumber(turned ? 0 : area.cover().count());
  if (!turned) area.ForEach([this](const Rectangle& r) { Add(r); });
  Add(turned ? ZRange() : shape.rectangles_z);
}

std::uint64_t Hash(const WorldDescription& world) {
  FieldHasher hasher;
  hasher.Add(world);
  return hasher.value();
}

}  // namespace troupe
