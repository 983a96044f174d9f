// Reading map images: PNG and PGM, as grey values.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/base/result.h"
#include "common/bitmap/bitmap.h"

namespace troupe {

// The first channel of an image (grey, or red) and its opacity, rows from the top.
struct GreyImage {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> grey;   // width * height
  std::vector<std::uint8_t> alpha;  // the same size; empty: opaque
};

// Images larger than this are refused before anything is allocated: a small file can unpack to any size.
inline constexpr std::int64_t kMaxImagePixels = 4'000'000'000;

// Format by content, not by file name. 16-bit samples are reduced to 8; palettes are looked up.
Result<GreyImage> ReadImage(const std::string& path);

// Stage's rule: a pixel is occupied if its grey value is at most 127; opacity does not matter.
Bitmap BitmapByStageRule(const GreyImage& image);

}  // namespace troupe
