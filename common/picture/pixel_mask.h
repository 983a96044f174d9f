// PixelMask: the area of a dense bitmap as a picture of it shows it, in about as many cells as the page has pixels.
#pragma once

#include <cstdint>
#include <vector>

#include "common/picture/viewport.h"
#include "troupe/pixel_area.h"

namespace troupe {

struct PixelMask {
  int width = 0;  // cells; 0: nothing of the area is on the page
  int height = 0;
  std::vector<std::uint8_t> coverage;  // row by row: the share of the cell that is occupied, 255 being all
  // On the page, px: cell (i, j) begins at origin + i * along_x + j * along_y.
  Vec2 origin = Vec2::Zero();
  Vec2 along_x = Vec2::Zero();
  Vec2 along_y = Vec2::Zero();
  bool sharp = false;  // a cell is a pixel of the bitmap
};

// The part of the area (of a model at X_WM) in the plot of the viewport.
PixelMask MakePixelMask(const PixelArea& area, const Pose& X_WM, const Viewport& viewport);

}  // namespace troupe
