#include "viewer/editor/pixel_stroke.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "viewer/editor/request_values.h"
#include "worldfile/text/quote.h"

namespace troupe {
namespace {

using Json = nlohmann::json;

constexpr std::size_t kMostPoints = 5000;
constexpr int kFarthest = 100'000;               // pixels
constexpr int kWidest = 500;                     // pixels
constexpr std::int64_t kMostWork = 100'000'000;  // pixels that are filled, some of them again
constexpr std::uint8_t kOccupied = 0;
constexpr std::uint8_t kFreed = 255;

std::optional<int> PixelNumber(const Json& value) {
  if (!value.is_number_integer() || std::abs(value.get<double>()) > kFarthest) return std::nullopt;
  return value.get<int>();
}

// Calls with each pixel of the straight line, both ends included.
template <typename Visit>
void VisitLine(Pixel at, const Pixel& to, Visit visit) {
  const int dx = std::abs(to.x - at.x);
  const int dy = -std::abs(to.y - at.y);
  const int step_x = at.x < to.x ? 1 : -1;
  const int step_y = at.y < to.y ? 1 : -1;
  for (int error = dx + dy;;) {
    visit(at);
    if (at.x == to.x && at.y == to.y) return;
    const int twice = 2 * error;
    if (twice >= dy) {
      error += dy;
      at.x += step_x;
    }
    if (twice <= dx) {
      error += dx;
      at.y += step_y;
    }
  }
}

std::int64_t WorkOf(const PixelStroke& stroke) {
  if (stroke.tool != PixelStroke::Tool::kLine) return 0;  // at most the picture, twice
  std::int64_t steps = 1;
  for (std::size_t i = 1; i < stroke.points.size(); ++i) {
    steps += std::max(std::abs(stroke.points[i].x - stroke.points[i - 1].x),
                      std::abs(stroke.points[i].y - stroke.points[i - 1].y));
  }
  return steps * stroke.width * stroke.width;
}

}  // namespace

Result<PixelStroke> StrokeIn(const Json& request) {
  PixelStroke stroke;
  const std::string tool = TextIn(request, "tool");
  if (tool == "frame") {
    stroke.tool = PixelStroke::Tool::kFrame;
  } else if (tool == "filled") {
    stroke.tool = PixelStroke::Tool::kFilled;
  } else if (tool != "line") {
    return Error{{}, "found the tool " + Quoted(tool) + ", expected line, frame or filled"};
  }
  const auto width = request.find("width");
  const std::optional<int> brush = width != request.end() ? PixelNumber(*width) : std::nullopt;
  if (!brush || *brush < 1 || *brush > kWidest) return Error{{}, "found no width of a brush, expected 1 to 500 pixels"};
  stroke.width = *brush;
  stroke.value = request.value("erase", Json()) == true ? kFreed : kOccupied;
  const auto points = request.find("points");
  const Error malformed{{}, "found no points, expected 1 to 5000 of two whole numbers within 100000 pixels"};
  if (points == request.end() || !points->is_array() || points->empty() || points->size() > kMostPoints)
    return malformed;
  for (const Json& point : *points) {
    if (!point.is_array() || point.size() != 2) return malformed;
    const std::optional<int> x = PixelNumber(point[0]);
    const std::optional<int> y = PixelNumber(point[1]);
    if (!x || !y) return malformed;
    stroke.points.push_back({*x, *y});
  }
  if (stroke.tool != PixelStroke::Tool::kLine && stroke.points.size() != 2)
    return Error{{}, "found another number of points, expected the two corners of a rectangle"};
  if (WorkOf(stroke) > kMostWork) return Error{{}, "found a stroke that is too long for so wide a brush"};
  return stroke;
}

void Draw(const PixelStroke& stroke, GreyPicture& picture) {
  const int before = (stroke.width - 1) / 2;
  const int after = stroke.width - before;
  if (stroke.tool == PixelStroke::Tool::kLine) {
    Pixel from = stroke.points.front();
    for (const Pixel& to : stroke.points) {
      VisitLine(from, to, [&](const Pixel& at) {
        picture.Fill({at.x - before, at.y - before, at.x + after, at.y + after}, stroke.value);
      });
      from = to;
    }
    return;
  }
  const auto [x0, x1] = std::minmax(stroke.points[0].x, stroke.points[1].x);
  const auto [y0, y1] = std::minmax(stroke.points[0].y, stroke.points[1].y);
  const PixelBox box{x0, y0, x1 + 1, y1 + 1};
  if (stroke.tool == PixelStroke::Tool::kFilled) {
    picture.Fill(box, stroke.value);
    return;
  }
  const int w = stroke.width;
  picture.Fill({box.x0, box.y0, box.x1, std::min(box.y0 + w, box.y1)}, stroke.value);
  picture.Fill({box.x0, std::max(box.y1 - w, box.y0), box.x1, box.y1}, stroke.value);
  picture.Fill({box.x0, box.y0, std::min(box.x0 + w, box.x1), box.y1}, stroke.value);
  picture.Fill({std::max(box.x1 - w, box.x0), box.y0, box.x1, box.y1}, stroke.value);
}

}  // namespace troupe
