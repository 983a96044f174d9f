// Feeds any bytes to the reader of ROS maps, and to the importer of the image that they name.
#include "worldfile/map/map_yaml.h"

#include <algorithm>

#include "fuzz/check.h"
#include "fuzz/memory_file.h"
#include "fuzz/targets.h"
#include "worldfile/map/bitmap_rectangles.h"

namespace troupe::fuzz {

void MapYaml(Bytes bytes) {
  static const MemoryFile image;
  const auto end = std::find(bytes.begin(), bytes.end(), std::byte{0});
  const auto length = static_cast<std::size_t>(end - bytes.begin());
  const Result<troupe::MapYaml> map = ReadMapYamlText(TextOf(bytes.first(length)), "fuzz/map.yaml");
  if (!map.ok()) {
    Check(!map.error().message.empty() && !map.error().where.file.empty());
    return;
  }
  Check(map.value().resolution > 0.0 && IsFinite(map.value().origin));
  image.Write(end == bytes.end() ? Bytes() : bytes.subspan(length + 1));
  BitmapCache bitmaps;
  const auto pixels = bitmaps.Load(image.path(), map.value().rule, map.value().image_where);
  if (!pixels.ok()) Check(!pixels.error().message.empty());
}

}  // namespace troupe::fuzz
