// Bitmap: a grid of occupied and free pixels, the one type behind every kind of map file.
//
// Three frames of reference must not be mixed up: columns count from the left and rows from the bottom, as x and y of
// the world; files begin at their top row, which readers turn round; and the words of a row have bit x % 64 for column
// x. Searches look at 64 pixels at a time, so that a row of a large map costs a few hundred steps. Memory: one bit a
// pixel, rows padded to whole words.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
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

  // The pixels of a row, 64 to a word: column x is bit x % 64 of word x / 64. Bits beyond the width are zero, and have
  // to stay so.
  std::span<const std::uint64_t> row(int y) const { return {words_.data() + WordIndex(y), words_per_row()}; }
  std::span<std::uint64_t> row(int y) { return {words_.data() + WordIndex(y), words_per_row()}; }

  // The first column from x on whose pixel in row y is occupied or free, as `value` says; width() if there is none.
  // REQUIRES: 0 <= x <= width()
  int FirstFrom(int x, int y, bool value) const;
  // The first column of the run of occupied pixels that a pixel belongs to. REQUIRES: occupied(x, y)
  int RunStart(int x, int y) const;

  // All pixels row by row without gaps: pixel i is bit i % 64 of bits[i / 64]; for messages.
  static std::size_t WordsOf(int width, int height) {
    return (static_cast<std::size_t>(width) * static_cast<std::size_t>(height) + 63) / 64;
  }
  // REQUIRES: bits has WordsOf(width(), height()) words, all 0
  void Pack(std::span<std::uint64_t> bits) const;
  // REQUIRES: bits has WordsOf(width, height) words
  static Bitmap Unpacked(int width, int height, std::span<const std::uint64_t> bits);

  bool operator==(const Bitmap&) const = default;

 private:
  std::size_t words_per_row() const { return static_cast<std::size_t>(stride_) >> 6; }
  std::size_t WordIndex(int y) const { return static_cast<std::size_t>(y) * words_per_row(); }
  std::size_t Index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(stride_) + static_cast<std::size_t>(x);
  }
  int width_ = 0;
  int height_ = 0;
  std::int64_t stride_ = 0;  // width rounded up to whole 64-bit words: rows start on a word
  std::vector<std::uint64_t> words_;
};

}  // namespace troupe
