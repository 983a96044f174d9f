#include "common/bitmap/bitmap.h"

#include "common/base/check.h"

namespace troupe {

Bitmap::Bitmap(int width, int height)
    : width_(width), height_(height), stride_((static_cast<std::int64_t>(width) + 63) / 64 * 64) {
  TROUPE_CHECK(width >= 0 && height >= 0);
  words_.resize(words_per_row() * static_cast<std::size_t>(height));
}

void Bitmap::set_occupied(int x, int y, bool value) {
  const std::size_t i = Index(x, y);
  const std::uint64_t bit = std::uint64_t{1} << (i & 63);
  if (value) {
    words_[i >> 6] |= bit;
  } else {
    words_[i >> 6] &= ~bit;
  }
}

}  // namespace troupe
