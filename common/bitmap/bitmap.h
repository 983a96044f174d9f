// Bitmap: a grid of occupied and free pixels, the one type behind every kind of map file.
#pragma once

#include <cstdint>
#include <vector>

namespace troupe {

class Bitmap {
 public:
  Bitmap() = default;
  Bitmap(int width, int height);  // all free; REQUIRES: width, height >= 0

  int width() const { return width_; }
  int height() const { return height_; }
  // Column x counts from the left, row y from the bottom (as in the world, y up).
  bool occupied(int x, int y) const {
    const std::size_t i = Index(x, y);
    return (words_[i >> 6] >> (i & 63)) & 1u;
  }
  void set_occupied(int x, int y, bool value);

 private:
  std::size_t Index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(stride_) + static_cast<std::size_t>(x);
  }
  int width_ = 0;
  int height_ = 0;
  int stride_ = 0;  // width rounded up to whole 64-bit words: rows start on a word
  std::vector<std::uint64_t> words_;
};

}  // namespace troupe
