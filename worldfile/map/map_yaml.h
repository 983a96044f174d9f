// ROS maps: YAML files of map_server with the name of an image and the rule for its pixels; and the covers of all
// bitmaps of a world.
//
// Pixels become an occupied area here, once: a map is walls, not probabilities, for every sensor and collision. The
// rule is that of map_server, mode by mode, with its quirks (unknown pixels are free, the mean of the channels
// decides), because users compare the two pictures. Frame M of a map has its origin at the lower left corner of the
// image, x to the right, y up, 1 pixel = `resolution` metres.
//
// An area is covered by few large rectangles, which the indices of the world treat as boxes; a noisy bitmap (a scan, a
// photograph) has so many that the pixels themselves are the cheaper form (DenseCover). CoverOf decides by the counts
// below.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "common/base/paths.h"
#include "common/image/image_file.h"
#include "troupe/dense_cover.h"
#include "troupe/pose.h"
#include "troupe/rectangle_cover.h"
#include "troupe/result.h"
#include "worldfile/stage/world_tree.h"

namespace troupe {

struct MapYaml {
  SourceLocation image_where;
  std::string image;         // path, relative names resolved
  double resolution = 0.05;  // m, width and height of a pixel
  Pose origin;               // X_WM of the image's lower left corner; z is 0
  PixelRule rule;            // occupied: the pixel's probability is at least occupied_thresh
  // By grey value, as map_server fills its cells by the mode: 0 is free, 100 occupied, kUnknownCell unknown.
  static constexpr std::uint8_t kUnknownCell = 255;
  std::array<std::uint8_t, 256> numbers{};
  double wall_height = 2.0;  // m
  std::vector<Warning> warnings;
};

// A file that cannot be read is an error at `where`, which names it.
Result<MapYaml> ReadMapYaml(const std::string& path, const SourceLocation& where,
                            const AllowedPaths& allowed = AllowedPaths::All());
Result<MapYaml> ReadMapYamlText(const std::string& text, const std::string& path);

// A world of one static model, "map", made from the YAML file at `path`.
WorldTree MapYamlTree(const std::string& path);

// The occupied areas of the bitmaps that a world names; each file is read once.

struct BitmapRectangles {
  int width = 0;  // pixels of the image
  int height = 0;
  std::vector<PixelRectangle> rectangles;
  std::shared_ptr<const DenseCover> dense;  // instead of `rectangles` if these are many for so few pixels

  bool empty() const { return rectangles.empty() && dense == nullptr; }
  // The bounding box of the occupied pixels. REQUIRES: !empty()
  PixelRectangle bounds() const;
};

// A rectangle of a list costs some hundred bytes in all indices of a process together: above these counts a list would
// need more memory than its pixels.
inline constexpr std::size_t kFewRectangles = 5000;
inline constexpr std::size_t kPixelsPerRectangle = 128;

// A dense bitmap of more rectangles can only be a part of a model that never moves: a moving body is tested piece by
// piece at every tick.
inline constexpr std::size_t kMaxMovingRectangles = 16'384;

// Lists the rectangles if they are at most kFewRectangles, or one for kPixelsPerRectangle pixels.
BitmapRectangles CoverOf(Bitmap bitmap);

// KnownBitmaps: bitmaps as their files were when they were read, for a program that builds a world many times. One
// thread at a time.
struct KnownBitmap {
  PixelRule rule;
  std::shared_ptr<const BitmapRectangles> content;
};
using KnownBitmaps = std::multimap<std::string, KnownBitmap>;  // by path

// The covers of one build of a world, by path and rule: a hundred models of one bitmap share one cover. Errors are not
// kept. One thread.
class BitmapCache {
 public:
  // Images are read from these files only. `source`: of images that are not read from their files. `known`: of images
  // that are not read again; null: none.
  explicit BitmapCache(AllowedPaths allowed = AllowedPaths::All(), ImageSource source = nullptr,
                       std::shared_ptr<KnownBitmaps> known = nullptr)
      : allowed_(std::move(allowed)), source_(std::move(source)), known_(std::move(known)) {}

  // The bitmap at `path` by `rule`. Errors are placed at `where`, which names it. Valid as long as the cache.
  Result<const BitmapRectangles*> Load(const std::string& path, const PixelRule& rule, const SourceLocation& where);

  // The cover of pixels that are not those of an image: of the text at `path`. Valid as long as the cache.
  const BitmapRectangles* Keep(const std::string& path, Bitmap pixels);

  // Sorted by path.
  std::vector<std::string> Paths() const;
  // Width and height of the largest image, pixels.
  std::pair<int, int> LargestSize() const;

 private:
  Result<std::shared_ptr<const BitmapRectangles>> Read(const std::string& path, const PixelRule& rule,
                                                       const SourceLocation& where) const;

  AllowedPaths allowed_;
  ImageSource source_;
  std::shared_ptr<KnownBitmaps> known_;
  KnownBitmaps by_path_;
};

}  // namespace troupe
