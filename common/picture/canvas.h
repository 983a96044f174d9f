// Canvas: a page to draw on, in pixels from its upper left corner, finished as the bytes of a PNG or SVG file.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "common/picture/draw_picture.h"
#include "common/picture/pixel_mask.h"
#include "troupe/polygon.h"
#include "troupe/rectangle.h"
#include "troupe/result.h"
#include "troupe/world_description.h"

typedef struct _cairo cairo_t;
typedef struct _cairo_surface cairo_surface_t;

namespace troupe {

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

  // Text on one line; `at` is on its base line. Drawn as a plain line (common/base/utf8.h).
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

}  // namespace troupe
