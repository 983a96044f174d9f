// Canvas: a page to draw on, in pixels from its upper left corner, finished as the bytes of a PNG or SVG file.
//
// A thin layer over Cairo that makes pictures reproducible and safe: polygons are clipped before Cairo sees them (its
// coordinates are fixed-point numbers that overflow), fonts have fixed settings, and ids that Cairo counts through the
// life of a process are removed. Errors of Cairo are kept by Cairo and reported by Finish; the calls in between need no
// checks.
//
// One thread per canvas. Colours are red, green, blue, opacity from 0 to 1.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "common/picture/draw_picture.h"
#include "common/picture/viewport.h"
#include "troupe/pixel_area.h"
#include "troupe/polygon.h"
#include "troupe/rectangle.h"
#include "troupe/result.h"
#include "troupe/world_description.h"

typedef struct _cairo cairo_t;
typedef struct _cairo_surface cairo_surface_t;

namespace troupe {

// PixelMask: the area of a dense bitmap as a picture of it shows it, in about as many cells as the page has pixels.
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

enum class TextAnchor : std::uint8_t { kLeft, kMiddle, kRight };

struct TextStyle {
  double size = 12.0;  // px
  Color color;
  bool bold = false;
};

class Canvas {
 public:
  Canvas(PictureFormat format, int width, int height);
  ~Canvas();
  Canvas(const Canvas&) = delete;
  Canvas& operator=(const Canvas&) = delete;

  int width() const { return width_; }
  int height() const { return height_; }

  // Until ClipNothing, only the area inside `box` is drawn.
  void ClipTo(const Rectangle& box);
  void ClipNothing();

  // The area inside an odd number of loops.
  void Fill(const std::vector<Polygon>& loops, const Color& color);
  // The area inside any of the loops, where all turn the same way.
  void FillUnion(const std::vector<Polygon>& loops, const Color& color);
  void Fill(const PixelMask& mask, const Color& color);
  void Stroke(const std::vector<Polygon>& loops, double line_width, const Color& color);
  void Fill(const Rectangle& box, const Color& color);
  void Stroke(const Rectangle& box, double line_width, const Color& color);
  void Line(const Vec2& from, const Vec2& to, double line_width, const Color& color);
  void FillCircle(const Vec2& center, double radius, const Color& color);
  void StrokeCircle(const Vec2& center, double radius, double line_width, const Color& color);

  // Text on one line; `at` is on its base line. Drawn as a plain line (common/base/text.h).
  void Text(const std::string& text, const Vec2& at, TextAnchor anchor, const TextStyle& style);
  double TextWidth(const std::string& text, const TextStyle& style);
  // `text`, cut to `width` pixels with "..." if it is longer.
  std::string Shortened(const std::string& text, double width, const TextStyle& style);

  // The file's bytes. REQUIRES: called once, as the last call.
  Result<std::string> Finish();

 private:
  void SetColor(const Color& color);
  void AddLoops(const std::vector<Polygon>& loops);
  void SetFont(const TextStyle& style);

  PictureFormat format_;
  int width_;
  int height_;
  Rectangle clip_;
  std::string bytes_;  // an SVG surface writes here
  cairo_surface_t* surface_;
  cairo_t* cairo_;
};

// The part of a polygon inside a box; a concave polygon may become several pieces joined along the box's edge.
Polygon ClipPolygon(const Polygon& polygon, const Rectangle& box);

// Colours of pictures: a pale page, and model colours softened and shaded by height.

// `from` at 0, `to` at 1.
Color Mix(const Color& from, const Color& to, double share);
Color WithOpacity(Color color, double opacity);

// A model's colour at a height: `height` 0 is the lowest (dark, muted), 1 the highest (light).
Color ObjectColor(const Color& color, double height);
// The same for a part of a robot: stronger, so that robots stand out from their surroundings.
Color RobotColor(const Color& color, double height);
// The walls of a map: dark, with a tinge of its colour.
Color WallColor(const Color& color);
// A line around an area of this colour.
Color OutlineColor(const Color& color);

namespace page {

inline constexpr Color kPaper{1.0, 1.0, 1.0, 1.0};
inline constexpr Color kGround{0.984, 0.988, 0.992, 1.0};
inline constexpr Color kGridMinor{0.945, 0.953, 0.961, 1.0};
inline constexpr Color kGridMajor{0.890, 0.906, 0.922, 1.0};
inline constexpr Color kFrame{0.760, 0.790, 0.820, 1.0};
inline constexpr Color kQuietText{0.440, 0.480, 0.530, 1.0};
inline constexpr Color kText{0.100, 0.130, 0.180, 1.0};
inline constexpr Color kScan{0.180, 0.470, 0.900, 1.0};
inline constexpr Color kStalled{0.860, 0.110, 0.170, 1.0};

}  // namespace page
}  // namespace troupe
