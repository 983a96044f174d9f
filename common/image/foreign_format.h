// Names of image formats that are not read, for messages: "unknown format" does not tell its reader what to do, "a TIFF
// image, convert it" does. By the first bytes, never by the ending of the name.
#pragma once

#include <string>
#include <string_view>

namespace troupe {

// Bytes of a file that are enough to tell its format.
inline constexpr std::size_t kFormatBytes = 512;

// "found a GIF image, expected PNG, JPEG, BMP or PGM (P2 or P5): convert it ..." of a file that starts so.
std::string DescribeForeignFormat(std::string_view start);

}  // namespace troupe
