// PixelStroke: one stroke of a brush in a picture, as a request describes it. Private to this folder.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <vector>

#include "troupe/result.h"
#include "viewer/editor/grey_picture.h"

namespace troupe {

struct Pixel {
  int x = 0;  // from the left
  int y = 0;  // from the top
};

struct PixelStroke {
  enum class Tool : std::uint8_t {
    kLine,    // a square brush along the points
    kFrame,   // the edge of the rectangle between two points, inwards
    kFilled,  // the rectangle between two points
  };
  Tool tool = Tool::kLine;
  std::vector<Pixel> points;
  int width = 1;           // of the brush, pixels
  std::uint8_t value = 0;  // of the pixels: 0 for walls, 255 for free ones
};

// {"tool": "line", "frame" or "filled", "points": [[x, y], ...], "width", "erase": true or false}: up to 5000 points
// within 100,000 pixels, a brush of up to 500. The error tells what is wrong, or that the stroke is too much work.
Result<PixelStroke> StrokeIn(const nlohmann::json& request);

void Draw(const PixelStroke& stroke, GreyPicture& picture);

}  // namespace troupe
