#include "common/picture/canvas.h"

#include <cairo-svg.h>
#include <cairo.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/base/text.h"

namespace troupe {
namespace {

// Cairo keeps coordinates as fixed-point numbers with 24 bits before the point, so a zoomed picture of a large world
// must be cut before Cairo draws it. The margin keeps cut edges and their strokes out of sight.
constexpr double kClipMargin = 64.0;  // px

constexpr std::size_t kMaxText = 500;  // bytes

cairo_status_t Append(void* closure, const unsigned char* data, unsigned int length) {
  static_cast<std::string*>(closure)->append(reinterpret_cast<const char*>(data), length);
  return CAIRO_STATUS_SUCCESS;
}

// Cairo numbers its surfaces through the life of the process, which would make two equal pictures differ.
void RemoveSurfaceIds(std::string& svg) {
  const std::string start = " id=\"surface";
  for (std::size_t at = svg.find(start); at != std::string::npos; at = svg.find(start, at)) {
    const std::size_t end = svg.find('"', at + start.size());
    if (end == std::string::npos) return;
    svg.erase(at, end + 1 - at);
  }
}

constexpr int kMaxCells = 4096;  // along each side

// Where the pixels of an area are on the page: pixel (i, j) begins at origin + i * along_x + j * along_y.
struct PagePlacement {
  Vec2 origin;
  Vec2 along_x;
  Vec2 along_y;
};

PagePlacement Placement(const PixelArea& area, const Pose& X_WM, const Viewport& viewport) {
  const Transform2 model(X_WM);
  const Transform2 lines(area.X_MA());
  const auto on_page = [&](int i, int j) { return viewport.ToPage(model * (lines * Vec2(area.x()(i), area.y()(j)))); };
  const int width = area.cover().bitmap().width();
  const int height = area.cover().bitmap().height();
  const Vec2 origin = on_page(0, 0);
  return {origin, (on_page(width, 0) - origin) / width, (on_page(0, height) - origin) / height};
}

// The pixels of the bitmap that may be in the box on the page.
PixelRectangle PixelsIn(const Rectangle& box, const PagePlacement& placement, const PixelRectangle& bounds) {
  const double area = Cross(placement.along_x, placement.along_y);
  Rectangle pixels = Rectangle::Nothing();
  for (const Vec2& corner : Corners(box)) {
    const Vec2 from = corner - placement.origin;
    pixels.Extend(Vec2(Cross(from, placement.along_y) / area, Cross(placement.along_x, from) / area));
  }
  const auto clamped = [](double pixel, int min, int max) {
    return static_cast<int>(std::clamp(pixel, static_cast<double>(min), static_cast<double>(max)));
  };
  return {
      clamped(std::floor(pixels.min_x), bounds.x0, bounds.x1), clamped(std::floor(pixels.min_y), bounds.y0, bounds.y1),
      clamped(std::ceil(pixels.max_x), bounds.x0, bounds.x1), clamped(std::ceil(pixels.max_y), bounds.y0, bounds.y1)};
}

// Adds the occupied pixels of a row to the cells that they are in, `step` pixels wide.
void CountRow(const Bitmap& bitmap, int y, const PixelRectangle& part, int step, std::vector<std::uint32_t>& counts) {
  for (int x = bitmap.FirstFrom(part.x0, y, true); x < part.x1;) {
    const int end = std::min(bitmap.FirstFrom(x, y, false), part.x1);
    while (x < end) {
      const int cell = (x - part.x0) / step;
      const int next = std::min(end, part.x0 + (cell + 1) * step);
      counts[static_cast<std::size_t>(cell)] += static_cast<std::uint32_t>(next - x);
      x = next;
    }
    x = bitmap.FirstFrom(end, y, true);
  }
}

constexpr Color kShadow{0.10, 0.12, 0.16, 1.0};

// Pure screen colours are too loud: reduces their saturation, and a little of their contrast.
Color Soft(const Color& color, double share) {
  const double luma = 0.3 * color.r + 0.59 * color.g + 0.11 * color.b;
  return Mix(Mix(WithOpacity(color, 1.0), {luma, luma, luma, 1.0}, share), {0.5, 0.5, 0.5, 1.0}, 0.10);
}

}  // namespace

Polygon ClipPolygon(const Polygon& polygon, const Rectangle& box) {
  Polygon result = polygon;
  // One pass for each side: keep the vertices inside, cut the edges that cross.
  for (int side = 0; side < 4; ++side) {
    const int axis = side / 2;
    const bool upper = side % 2 == 1;
    const double limit = axis == 0 ? (upper ? box.max_x : box.min_x) : (upper ? box.max_y : box.min_y);
    const auto inside = [&](const Vec2& p) { return upper ? p[axis] <= limit : p[axis] >= limit; };
    Polygon kept;
    for (std::size_t i = 0; i < result.size(); ++i) {
      const Vec2& from = result[i];
      const Vec2& to = result[(i + 1) % result.size()];
      if (inside(from)) kept.push_back(from);
      if (inside(from) != inside(to)) {
        Vec2 cut = from + (to - from) * ((limit - from[axis]) / (to[axis] - from[axis]));
        cut[axis] = limit;
        kept.push_back(cut);
      }
    }
    result = std::move(kept);
  }
  return result;
}

Canvas::Canvas(PictureFormat format, int width, int height)
    : format_(format), width_(width), height_(height), clip_{0.0, 0.0, double(width), double(height)} {
  surface_ = format == PictureFormat::kPng ? cairo_image_surface_create(CAIRO_FORMAT_RGB24, width, height)
                                           : cairo_svg_surface_create_for_stream(Append, &bytes_, width, height);
  cairo_ = cairo_create(surface_);
  // Outlines of bitmaps have holes as loops of any direction.
  cairo_set_fill_rule(cairo_, CAIRO_FILL_RULE_EVEN_ODD);
  cairo_set_line_join(cairo_, CAIRO_LINE_JOIN_ROUND);
  // Letters have the same shape with any font settings of the machine.
  cairo_font_options_t* font = cairo_font_options_create();
  cairo_font_options_set_antialias(font, CAIRO_ANTIALIAS_GRAY);
  cairo_font_options_set_hint_style(font, CAIRO_HINT_STYLE_NONE);
  cairo_font_options_set_hint_metrics(font, CAIRO_HINT_METRICS_OFF);
  cairo_set_font_options(cairo_, font);
  cairo_font_options_destroy(font);
}

Canvas::~Canvas() {
  cairo_destroy(cairo_);
  cairo_surface_destroy(surface_);
}

void Canvas::ClipTo(const Rectangle& box) {
  cairo_save(cairo_);
  cairo_rectangle(cairo_, box.min_x, box.min_y, box.width(), box.height());
  cairo_clip(cairo_);
  clip_ = box;
}

void Canvas::ClipNothing() {
  cairo_restore(cairo_);
  clip_ = {0.0, 0.0, double(width_), double(height_)};
}

void Canvas::SetColor(const Color& color) {
  cairo_set_source_rgba(cairo_, color.r, color.g, color.b, color.a);
}

void Canvas::AddLoops(const std::vector<Polygon>& loops) {
  const Rectangle reach = clip_.Inflated(kClipMargin);
  for (const Polygon& loop : loops) {
    const Rectangle box = BoundingBox(loop);
    // Most of a large world is outside of a zoomed page.
    if (!box.Overlaps(reach)) continue;
    const bool whole = reach.Contains({box.min_x, box.min_y}) && reach.Contains({box.max_x, box.max_y});
    const Polygon cut = whole ? Polygon() : ClipPolygon(loop, reach);
    for (const Vec2& p : whole ? loop : cut) cairo_line_to(cairo_, p.x(), p.y());
    cairo_close_path(cairo_);
    cairo_new_sub_path(cairo_);
  }
}

void Canvas::Fill(const std::vector<Polygon>& loops, const Color& color) {
  SetColor(color);
  AddLoops(loops);
  cairo_fill(cairo_);
}

void Canvas::FillUnion(const std::vector<Polygon>& loops, const Color& color) {
  cairo_set_fill_rule(cairo_, CAIRO_FILL_RULE_WINDING);
  Fill(loops, color);
  cairo_set_fill_rule(cairo_, CAIRO_FILL_RULE_EVEN_ODD);
}

void Canvas::Fill(const PixelMask& mask, const Color& color) {
  if (mask.width == 0) return;
  cairo_matrix_t matrix;
  cairo_matrix_init(&matrix, mask.along_x.x(), mask.along_x.y(), mask.along_y.x(), mask.along_y.y(), mask.origin.x(),
                    mask.origin.y());
  if (cairo_matrix_invert(&matrix) != CAIRO_STATUS_SUCCESS) return;  // the area is too small to be seen
  cairo_surface_t* cells = cairo_image_surface_create(CAIRO_FORMAT_A8, mask.width, mask.height);
  if (unsigned char* const bytes = cairo_image_surface_get_data(cells)) {  // none without memory
    const int stride = cairo_image_surface_get_stride(cells);
    for (int row = 0; row < mask.height; ++row) {
      std::copy_n(mask.coverage.begin() + static_cast<std::ptrdiff_t>(row) * mask.width, mask.width,
                  bytes + static_cast<std::ptrdiff_t>(row) * stride);
    }
    cairo_surface_mark_dirty(cells);
  }
  cairo_pattern_t* pattern = cairo_pattern_create_for_surface(cells);
  cairo_pattern_set_matrix(pattern, &matrix);
  cairo_pattern_set_filter(pattern, mask.sharp ? CAIRO_FILTER_NEAREST : CAIRO_FILTER_GOOD);
  SetColor(color);
  cairo_mask(cairo_, pattern);  // keeps an error of the surface for Finish
  cairo_pattern_destroy(pattern);
  cairo_surface_destroy(cells);
}

void Canvas::Stroke(const std::vector<Polygon>& loops, double line_width, const Color& color) {
  SetColor(color);
  AddLoops(loops);
  cairo_set_line_width(cairo_, line_width);
  cairo_stroke(cairo_);
}

void Canvas::Fill(const Rectangle& box, const Color& color) {
  Fill({{{box.min_x, box.min_y}, {box.max_x, box.min_y}, {box.max_x, box.max_y}, {box.min_x, box.max_y}}}, color);
}

void Canvas::Stroke(const Rectangle& box, double line_width, const Color& color) {
  Stroke({{{box.min_x, box.min_y}, {box.max_x, box.min_y}, {box.max_x, box.max_y}, {box.min_x, box.max_y}}}, line_width,
         color);
}

void Canvas::Line(const Vec2& from, const Vec2& to, double line_width, const Color& color) {
  Stroke({{from, to}}, line_width, color);
}

void Canvas::FillCircle(const Vec2& center, double radius, const Color& color) {
  if (!clip_.Inflated(radius).Contains(center)) return;
  SetColor(color);
  cairo_new_path(cairo_);
  cairo_arc(cairo_, center.x(), center.y(), radius, 0.0, 2.0 * std::numbers::pi);
  cairo_fill(cairo_);
}

void Canvas::StrokeCircle(const Vec2& center, double radius, double line_width, const Color& color) {
  // A circle far larger than the page would leave Cairo's range.
  if (!clip_.Inflated(radius).Contains(center) || radius > 1e5) return;
  SetColor(color);
  cairo_new_path(cairo_);
  cairo_arc(cairo_, center.x(), center.y(), radius, 0.0, 2.0 * std::numbers::pi);
  cairo_set_line_width(cairo_, line_width);
  cairo_stroke(cairo_);
}

void Canvas::SetFont(const TextStyle& style) {
  cairo_select_font_face(cairo_, "DejaVu Sans", CAIRO_FONT_SLANT_NORMAL,
                         style.bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_font_size(cairo_, style.size);
}

double Canvas::TextWidth(const std::string& text, const TextStyle& style) {
  SetFont(style);
  cairo_text_extents_t extents;
  cairo_text_extents(cairo_, PlainLine(text).c_str(), &extents);
  return extents.x_advance;
}

void Canvas::Text(const std::string& text, const Vec2& at, TextAnchor anchor, const TextStyle& style) {
  const double width = TextWidth(text, style);
  const double shift = anchor == TextAnchor::kLeft ? 0.0 : anchor == TextAnchor::kMiddle ? 0.5 : 1.0;
  const Vec2 start(at.x() - shift * width, at.y());
  const std::string printable = PlainLine(text);
  SetColor(style.color);
  cairo_move_to(cairo_, start.x(), start.y());
  cairo_show_text(cairo_, printable.c_str());
  cairo_new_path(cairo_);
}

std::string Canvas::Shortened(const std::string& text, double width, const TextStyle& style) {
  std::string result = PlainLine(text, kMaxText);
  if (TextWidth(result, style) <= width && text.size() <= kMaxText) return result;
  while (!result.empty() && TextWidth(result + "...", style) > width) {
    result.resize(CutUtf8(result, result.size() - 1).size());
  }
  return result.empty() ? result : result + "...";
}

Result<std::string> Canvas::Finish() {
  cairo_status_t status = cairo_status(cairo_);
  if (status == CAIRO_STATUS_SUCCESS && format_ == PictureFormat::kPng) {
    status = cairo_surface_write_to_png_stream(surface_, Append, &bytes_);
  }
  cairo_surface_finish(surface_);
  if (status == CAIRO_STATUS_SUCCESS) status = cairo_surface_status(surface_);
  if (status != CAIRO_STATUS_SUCCESS) {
    return Error{{}, std::string("cannot draw the picture: ") + cairo_status_to_string(status)};
  }
  if (format_ == PictureFormat::kSvg) RemoveSurfaceIds(bytes_);
  return std::move(bytes_);
}

PixelMask MakePixelMask(const PixelArea& area, const Pose& X_WM, const Viewport& viewport) {
  const PagePlacement placement = Placement(area, X_WM, viewport);
  const PixelRectangle part = PixelsIn(viewport.plot, placement, area.cover().bounds());
  PixelMask mask;
  if (part.x0 >= part.x1 || part.y0 >= part.y1) return mask;
  // Cells of half a page's pixel, or of a pixel of the bitmap where that is larger.
  // Two cells for a pixel of the page: finer ones would not be seen, coarser ones would show.
  const double finest = 0.5 / std::max(placement.along_x.norm(), placement.along_y.norm());
  const int longest = std::max(part.x1 - part.x0, part.y1 - part.y0);
  const int step =
      std::max(static_cast<int>(std::clamp(finest, 1.0, static_cast<double>(longest))), (longest - 1) / kMaxCells + 1);
  mask.width = (part.x1 - part.x0 - 1) / step + 1;
  mask.height = (part.y1 - part.y0 - 1) / step + 1;
  mask.origin = placement.origin + part.x0 * placement.along_x + part.y0 * placement.along_y;
  mask.along_x = step * placement.along_x;
  mask.along_y = step * placement.along_y;
  mask.sharp = step == 1;
  mask.coverage.reserve(static_cast<std::size_t>(mask.width) * static_cast<std::size_t>(mask.height));
  const double full = static_cast<double>(step) * step;
  std::vector<std::uint32_t> counts;
  for (int row = 0; row < mask.height; ++row) {
    counts.assign(static_cast<std::size_t>(mask.width), 0);
    const int first = part.y0 + row * step;
    for (int y = first; y < std::min(first + step, part.y1); ++y) {
      CountRow(area.cover().bitmap(), y, part, step, counts);
    }
    for (const std::uint32_t count : counts) {
      mask.coverage.push_back(static_cast<std::uint8_t>(std::lround(255.0 * count / full)));
    }
  }
  return mask;
}

Color Mix(const Color& from, const Color& to, double share) {
  const auto mix = [&](double a, double b) { return a + (b - a) * share; };
  return {mix(from.r, to.r), mix(from.g, to.g), mix(from.b, to.b), mix(from.a, to.a)};
}

Color WithOpacity(Color color, double opacity) {
  color.a = opacity;
  return color;
}

Color ObjectColor(const Color& color, double height) {
  const Color soft = Soft(color, 0.26);
  // Most solids are low beside the highest one: the root spreads them over the shades.
  const double share = std::sqrt(std::clamp(height, 0.0, 1.0));
  return Mix(Mix(soft, kShadow, 0.42), Mix(soft, page::kPaper, 0.5), share);
}

Color RobotColor(const Color& color, double height) {
  const Color soft = Soft(color, 0.12);
  return Mix(Mix(soft, kShadow, 0.38), Mix(soft, page::kPaper, 0.14), std::clamp(height, 0.0, 1.0));
}

Color WallColor(const Color& color) {
  return Mix(WithOpacity(color, 1.0), {0.180, 0.215, 0.270, 1.0}, 0.75);
}

Color OutlineColor(const Color& color) {
  return Mix(color, kShadow, 0.55);
}

}  // namespace troupe
