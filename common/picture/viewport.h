// Viewport: the part of the world that a picture shows, its place on the page, and the scale.
//
// The page grows with the region: the width is given or chosen, the height follows from the aspect of the region, which
// is kept within limits so that a long corridor does not become a line. One scale for both axes. Pure functions.
#pragma once

#include <string>
#include <vector>

#include "common/picture/draw_picture.h"
#include "troupe/rectangle.h"

namespace troupe {

// The plane of the picture: x to the right and "up" (y in a top view, z in a side view), m, frame W.
struct Viewport {
  Rectangle region;    // m
  Rectangle plot;      // px: where the region is drawn
  double scale = 1.0;  // px per m
  int width = 0;       // px, of the page
  int height = 0;      // px
  double unit = 1.0;   // px: lines, letters and margins are multiples of this, so that pictures of any size look alike

  Vec2 ToPage(double x, double up) const {
    return {plot.min_x + (x - region.min_x) * scale, plot.max_y - (up - region.min_y) * scale};
  }
  Vec2 ToPage(const Vec2& p) const { return ToPage(p.x(), p.y()); }
  std::vector<Polygon> ToPage(const std::vector<Polygon>& loops) const;
  // The box on the page of a box in the plane.
  Rectangle ToPage(const Rectangle& box) const;
};

// `contents` is the extent of the solids in the plane; it may be empty.
Viewport MakeViewport(const Rectangle& contents, const PictureOptions& options);

// The largest of 1, 2, 5, 10, ... (and 0.5, 0.2, ...) that is not above `value` > 0.
double RoundDown(double value);

// A number for a label: "12", "0.5", never "-0".
std::string Label(double value);

}  // namespace troupe
