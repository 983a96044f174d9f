// Reading map images, straight to occupied and free pixels.
//
// Images come from strangers. Sizes are checked against fixed limits and against the length of the file before memory
// is taken; damaged and cut files are errors, not grey areas. One row is unpacked at a time: a map of 60,000 x 60,000
// pixels is 450 MB as bits, 10 GB as colours.
//
// Row 0 of a Bitmap is at the bottom, as y of the world, whereas files begin at the top. The result depends on the
// bytes of the file and the rule only, on every machine. Any thread may read.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "troupe/bitmap.h"
#include "troupe/result.h"

namespace troupe {

// The rule that makes pixels of an image occupied. Only the grey value of a pixel counts, reduced to 0..255.
struct PixelRule {
  std::array<bool, 256> occupied{};  // by grey value
  // A colour image's grey value is the mean of red, green and blue; otherwise it is red alone.
  bool mean_of_channels = false;
  // A pixel that is not fully opaque is free; otherwise opacity does not matter.
  bool transparent_is_free = false;
  bool operator==(const PixelRule&) const = default;
};

// Stage's rule: a pixel is occupied if its grey (or red) value is at most 127; opacity does not matter.
PixelRule StagePixelRule();

// Images larger than this are refused before anything is allocated: a small file can unpack to any size.
inline constexpr std::int64_t kMaxImagePixels = 4'000'000'000;
// The limit of the unpacked size in bytes, which colour and 16-bit samples multiply.
inline constexpr std::int64_t kMaxImageBytes = 8'000'000'000;
// Interlaced PNG images have to be unpacked as a whole, so they have to be smaller.
inline constexpr std::int64_t kMaxInterlacedBytes = 400'000'000;

// Reads an image row by row, so that memory is one bit for each pixel. Format by content, not by file name: PNG, JPEG
// and BMP of any kind, PGM text (P2) and binary (P5). 16-bit samples are reduced to 8; palettes are looked up. The
// error for another format names it, with a way to convert it.
Result<Bitmap> ReadBitmap(const std::string& path, const PixelRule& rule);

// ImageSource: contents that stand in for image files, of images that are edited and not saved yet.
// The occupied pixels of the image at a path, by the rule; nothing: the file is to be read. A source that is empty
// stands in for no file.
using ImageSource = std::function<std::optional<Bitmap>(const std::string& path, const PixelRule& rule)>;

// Images of one grey value for each pixel, to be edited and written as PNG files.

struct GreyImage {
  int width = 0;  // pixels
  int height = 0;
  std::vector<std::uint8_t> values;  // row by row from the top; 0: black
};

// Larger images are not read or written here.
inline constexpr std::int64_t kMaxGreyPixels = 16'777'216;

// Reads a PNG file of any kind as Stage does: of a coloured image the red counts, opacity does not, 16-bit samples are
// reduced to 8. The error names another format, a damaged file, or one with too many pixels.
Result<GreyImage> ReadGreyPng(const std::string& path);

// The bytes of a PNG file, grey, 8 bits a pixel. REQUIRES: it has 1 to kMaxGreyPixels pixels, with a value each.
Result<std::string> EncodeGreyPng(const GreyImage& image);

}  // namespace troupe
