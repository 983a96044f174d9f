// Images of one grey value for each pixel, to be edited and written as PNG files.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "troupe/result.h"

namespace troupe {

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
