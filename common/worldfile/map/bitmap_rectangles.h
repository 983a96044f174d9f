// The occupied areas of the bitmaps that a world names; each file is read once.
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "common/base/allowed_paths.h"
#include "common/base/result.h"
#include "common/bitmap/image_file.h"
#include "common/bitmap/rectangle_cover.h"

namespace troupe {

struct BitmapRectangles {
  int width = 0;  // pixels of the image
  int height = 0;
  std::vector<PixelRectangle> rectangles;
  PixelRectangle bounds;  // of the occupied pixels; all zero if there are none
};

BitmapRectangles CoverOf(const Bitmap& bitmap);

class BitmapCache {
 public:
  // Images are read from these files only.
  explicit BitmapCache(AllowedPaths allowed = AllowedPaths::All()) : allowed_(std::move(allowed)) {}

  // The bitmap at `path` by `rule`. Errors are placed at `where`, which names it. Valid as long as the cache.
  Result<const BitmapRectangles*> Load(const std::string& path, const PixelRule& rule, const SourceLocation& where);

  // Sorted by path.
  std::vector<std::string> Paths() const;
  // Width and height of the largest image, pixels.
  std::pair<int, int> LargestSize() const;

 private:
  struct Entry {
    PixelRule rule;
    BitmapRectangles content;
  };
  AllowedPaths allowed_;
  std::multimap<std::string, Entry> by_path_;
};

}  // namespace troupe
