#include "common/picture/viewport.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "troupe/picture_options.h"

namespace troupe {
namespace {

constexpr double kLongerSide = 1000.0;       // px, of a page whose width is not given
constexpr double kDefaultExtent = 10.0;      // m, of a picture of nothing
constexpr double kMinExtent = 1e-3;          // m
constexpr double kMaxExtent = 1e12;          // m
constexpr double kTopAspect[] = {0.3, 2.0};  // height by width of the region
constexpr double kSideAspect[] = {0.16, 0.8};

// Grows a box about its middle until its height is within these shares of its width. A side view keeps its ground.
void LimitAspect(Rectangle& region, const double (&aspect)[2], PictureView view) {
  const double missing_height = aspect[0] * region.width() - region.height();
  if (missing_height > 0.0) {
    const double below = view == PictureView::kTop ? 0.5 : 0.0;
    region.min_y -= below * missing_height;
    region.max_y += (1.0 - below) * missing_height;
  }
  const double missing_width = region.height() / aspect[1] - region.width();
  if (missing_width > 0.0) {
    region.min_x -= 0.5 * missing_width;
    region.max_x += 0.5 * missing_width;
  }
}

Rectangle ChooseRegion(const Rectangle& contents, const PictureOptions& options) {
  const bool top = options.view == PictureView::kTop;
  Rectangle region = contents;
  if (region.empty()) {
    region = {-0.5 * kDefaultExtent, top ? -0.5 * kDefaultExtent : 0.0, 0.5 * kDefaultExtent, 0.5 * kDefaultExtent};
  }
  const Vec2 middle = options.center ? *options.center : region.center();
  const double length = std::clamp(options.meters ? *options.meters : region.width(), kMinExtent, kMaxExtent);
  if (options.meters || options.center) {
    region.min_x = middle.x() - 0.5 * length;
    region.max_x = middle.x() + 0.5 * length;
    if (top) {
      const double height = options.meters ? 0.7 * length : region.height();
      region.min_y = middle.y() - 0.5 * height;
      region.max_y = middle.y() + 0.5 * height;
    }
  } else {
    const double margin = std::max(0.02 * std::max(region.width(), region.height()), kMinExtent);
    region = region.Inflated(margin);
  }
  if (!top) {
    // The ground and a strip below it.
    const double height = std::max({contents.empty() ? 0.0 : contents.max_y, 0.05 * region.width(), kMinExtent});
    const double low = contents.empty() ? 0.0 : std::min(0.0, contents.min_y);
    region.min_y = low - 0.1 * (height - low);
    region.max_y = height + 0.3 * (height - low);
  }
  LimitAspect(region, top ? kTopAspect : kSideAspect, options.view);
  return region;
}

}  // namespace

std::vector<Polygon> Viewport::ToPage(const std::vector<Polygon>& loops) const {
  std::vector<Polygon> result;
  for (const Polygon& loop : loops) {
    Polygon moved;
    for (const Vec2& p : loop) moved.push_back(ToPage(p));
    result.push_back(std::move(moved));
  }
  return result;
}

Rectangle Viewport::ToPage(const Rectangle& box) const {
  const Vec2 low = ToPage(box.min_x, box.max_y);
  const Vec2 high = ToPage(box.max_x, box.min_y);
  return {low.x(), low.y(), high.x(), high.y()};
}

Viewport MakeViewport(const Rectangle& contents, const PictureOptions& options) {
  Viewport viewport;
  viewport.region = ChooseRegion(contents, options);
  const double aspect = viewport.region.height() / viewport.region.width();
  viewport.width = options.width ? *options.width : int(std::lround(kLongerSide / std::max(1.0, aspect)));
  viewport.unit = std::clamp(viewport.width * std::sqrt(std::clamp(aspect, 0.5, 1.3)) / 900.0, 0.75, 4.0);

  const double u = viewport.unit;
  viewport.plot.min_x = 38.0 * u;
  viewport.plot.min_y = 14.0 * u;
  viewport.plot.max_x = viewport.width - 14.0 * u;
  viewport.scale = viewport.plot.width() / viewport.region.width();
  viewport.plot.max_y = viewport.plot.min_y + viewport.scale * viewport.region.height();
  viewport.height = int(std::ceil(viewport.plot.max_y + 62.0 * u));
  return viewport;
}

double RoundDown(double value) {
  double power = std::pow(10.0, std::floor(std::log10(value)));
  if (power > value) power /= 10.0;
  // The tolerance makes 4.9999999 that was computed from 5 count as 5.
  const double digits = value / power * (1.0 + 1e-9);
  return power * (digits >= 5.0 ? 5.0 : digits >= 2.0 ? 2.0 : 1.0);
}

std::string Label(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", value);
  return std::string(text) == "-0" ? "0" : text;
}

Status CheckPictureOptions(const PictureOptions& options) {
  if (options.width && (*options.width < kMinPictureWidth || *options.width > kMaxPictureWidth)) {
    return Error{{},
                 "found a picture width of " + std::to_string(*options.width) + ", expected " +
                     std::to_string(kMinPictureWidth) + " to " + std::to_string(kMaxPictureWidth) + " pixels"};
  }
  const auto out_of_bounds = [](double value) { return !(std::abs(value) <= 1e9); };
  if (options.center && (out_of_bounds(options.center->x()) || out_of_bounds(options.center->y()))) {
    return Error{{}, "found a picture centre that is not a place, expected x and y within 1e9 m"};
  }
  if (options.meters && !(*options.meters >= 0.01 && *options.meters <= 1e9)) {
    return Error{{}, "found a picture " + Label(*options.meters) + " m wide, expected 0.01 m to 1e9 m"};
  }
  return Status();
}

Result<PictureFormat> PictureFormatOf(const std::string& path) {
  const std::size_t slash = path.find_last_of('/');
  const std::string name = slash == std::string::npos ? path : path.substr(slash + 1);
  const std::size_t dot = name.find_last_of('.');
  const std::string ending = dot == std::string::npos ? "" : name.substr(dot);
  if (ending == ".png") return PictureFormat::kPng;
  if (ending == ".svg") return PictureFormat::kSvg;
  const std::string found = ending.empty() ? "no file ending" : "the file ending '" + ending + "'";
  return Error{{path, 0, 0}, "found " + found + ", expected .png or .svg"};
}

}  // namespace troupe
