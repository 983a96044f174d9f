// An image as a PNG file.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "troupe/result.h"

namespace troupe {

// The bytes of a PNG file of an image: red, green and blue of each pixel, row by row from the top. The error is a fault
// of the graphics library. REQUIRES: rgb has 3 * width * height bytes; both sides are at least 1
Result<std::string> EncodePng(int width, int height, std::span<const std::uint8_t> rgb);

}  // namespace troupe
