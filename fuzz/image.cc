// Feeds any bytes to the readers of images, and what they accept to the importer of bitmaps.
#include "common/image/image_file.h"
#include "common/worldfile/map/bitmap_rectangles.h"
#include "fuzz/check.h"
#include "fuzz/memory_file.h"
#include "fuzz/targets.h"

namespace troupe::fuzz {
namespace {

std::size_t OccupiedPixels(const Bitmap& bitmap) {
  std::size_t count = 0;
  for (int y = 0; y < bitmap.height(); ++y) {
    for (const std::uint64_t word : bitmap.row(y)) count += static_cast<std::size_t>(std::popcount(word));
  }
  return count;
}

std::size_t PixelsOf(const PixelRectangle& r) {
  return static_cast<std::size_t>(r.x1 - r.x0) * static_cast<std::size_t>(r.y1 - r.y0);
}

}  // namespace

void Image(Bytes bytes) {
  static const MemoryFile file;
  file.Write(bytes);
  const Result<Bitmap> bitmap = ReadBitmap(file.path(), StagePixelRule());
  if (!bitmap.ok()) {
    Check(!bitmap.error().message.empty() && !bitmap.error().where.file.empty());
    return;
  }
  const DenseCover dense(bitmap.value());
  std::size_t covered = 0;
  dense.ForEach([&covered](const PixelRectangle& r) { covered += PixelsOf(r); });
  Check(covered == OccupiedPixels(bitmap.value()));
  const BitmapRectangles cover = CoverOf(bitmap.value());
  Check(cover.dense != nullptr ? cover.dense->count() == dense.count() : cover.rectangles.size() == dense.count());
}

}  // namespace troupe::fuzz
