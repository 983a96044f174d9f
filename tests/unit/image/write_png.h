// Writes PNG files of any kind, for tests.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace troupe {

struct PngContent {
  int width = 0;
  int height = 0;
  int bit_depth = 8;
  int color_type = 0;  // PNG_COLOR_TYPE_*
  bool interlaced = false;
  std::vector<std::vector<std::uint8_t>> rows;     // packed as in the file, from the top
  std::vector<std::vector<std::uint8_t>> palette;  // {red, green, blue} each
};

void WritePng(const std::string& path, const PngContent& content);

}  // namespace troupe
