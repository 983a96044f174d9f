#include "troupe/bitmap.h"

#include <algorithm>
#include <bit>

#include "troupe/check.h"

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

int Bitmap::FirstFrom(int x, int y, bool value) const {
  const std::span<const std::uint64_t> words = row(y);
  const std::uint64_t flip = value ? 0 : ~std::uint64_t{0};
  std::size_t i = static_cast<std::size_t>(x) >> 6;
  if (i >= words.size()) return width_;
  std::uint64_t word = (words[i] ^ flip) >> (x & 63) << (x & 63);
  while (word == 0) {
    if (++i == words.size()) return width_;
    word = words[i] ^ flip;
  }
  return std::min(width_, static_cast<int>(i << 6) + std::countr_zero(word));
}

int Bitmap::RunStart(int x, int y) const {
  const std::span<const std::uint64_t> words = row(y);
  std::size_t i = static_cast<std::size_t>(x) >> 6;
  std::uint64_t free = ~words[i] << (63 - (x & 63));  // its highest bit is x
  int last = x;
  while (free == 0) {
    if (i == 0) return 0;
    last = static_cast<int>(i << 6) - 1;
    free = ~words[--i];
  }
  return last - std::countl_zero(free) + 1;
}

void Bitmap::Pack(std::span<std::uint64_t> bits) const {
  for (int y = 0; y < height_; ++y) {
    std::size_t at = static_cast<std::size_t>(y) * static_cast<std::size_t>(width_);
    for (const std::uint64_t word : row(y)) {
      bits[at >> 6] |= word << (at & 63);
      const std::uint64_t rest = (at & 63) == 0 ? 0 : word >> (64 - (at & 63));
      if (rest != 0) bits[(at >> 6) + 1] |= rest;
      at += 64;
    }
  }
}

Bitmap Bitmap::Unpacked(int width, int height, std::span<const std::uint64_t> bits) {
  Bitmap bitmap(width, height);
  for (int y = 0; y < height; ++y) {
    std::size_t at = static_cast<std::size_t>(y) * static_cast<std::size_t>(width);
    const std::size_t end = at + static_cast<std::size_t>(width);
    for (std::uint64_t& word : bitmap.row(y)) {
      const std::size_t count = std::min<std::size_t>(64, end - at);
      const std::size_t shift = at & 63;
      word = bits[at >> 6] >> shift;
      if (shift + count > 64) word |= bits[(at >> 6) + 1] << (64 - shift);
      if (count < 64) word &= (std::uint64_t{1} << count) - 1;
      at += count;
    }
  }
  return bitmap;
}

}  // namespace troupe
