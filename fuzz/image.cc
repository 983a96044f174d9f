// Feeds any bytes to the readers of images, and what they accept to the importer of bitmaps.
#include "fuzz/image.h"

#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>

#include "common/image/image_file.h"
#include "worldfile/map/map_yaml.h"

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

// A PNG of few bytes may have millions of pixels, which only takes time. Width and height are at fixed places in the
// header chunk, big-endian.
bool IsLargePng(Bytes bytes) {
  constexpr std::size_t kWidthAt = 16;
  constexpr std::size_t kHeightAt = 20;
  constexpr std::uint64_t kMaxPixels = 10'000;
  if (bytes.size() < kHeightAt + 4 || bytes[1] != std::byte{'P'}) return false;
  const auto number = [bytes](std::size_t at) {
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < 4; ++i) value = value << 8 | std::to_integer<std::uint64_t>(bytes[at + i]);
    return value;
  };
  const std::uint64_t width = number(kWidthAt);
  const std::uint64_t height = number(kHeightAt);
  // Numbers beyond the limits are errors, which take no time.
  return width < 100'000 && height < 100'000 && width * height > kMaxPixels;
}

}  // namespace

void Image(Bytes bytes) {
  static const MemoryFile file;
  if (IsLargePng(bytes)) return;
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

// Feeds any bytes to the reader of ROS maps, and to the importer of the image that they name.
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

MemoryFile::MemoryFile() : descriptor_(memfd_create("fuzz", MFD_CLOEXEC)) {
  Check(descriptor_ >= 0);
}

MemoryFile::~MemoryFile() {
  close(descriptor_);
}

std::string MemoryFile::path() const {
  return "/proc/self/fd/" + std::to_string(descriptor_);
}

void MemoryFile::Write(Bytes bytes) const {
  Check(ftruncate(descriptor_, 0) == 0);
  Check(pwrite(descriptor_, bytes.data(), bytes.size(), 0) == static_cast<ssize_t>(bytes.size()));
}

}  // namespace troupe::fuzz
