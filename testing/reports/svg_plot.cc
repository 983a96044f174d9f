#include "testing/reports/svg_plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "common/base/xml_text.h"

namespace troupe {
namespace {

constexpr double kLeft = 66.0;  // pixels
constexpr double kRight = 14.0;
constexpr double kTop = 30.0;
constexpr double kBottom = 46.0;

// 1, 2 or 5 times a power of ten, so that about five steps span the extent.
double StepOf(double extent) {
  const double rough = extent / 5.0;
  const double power = std::pow(10.0, std::floor(std::log10(rough)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (rough <= factor * power) return factor * power;
  }
  return 10.0 * power;
}

struct Axis {
  double min = 0.0;
  double max = 1.0;
  double step = 0.2;

  Axis(double its_min, double its_max, double its_step) : min(its_min), max(its_max), step(its_step) {}
  // From a mark at or below `least` to one at or above `greatest`.
  Axis(double least, double greatest) {
    if (!(least < greatest)) {  // one value
      const double margin = std::max(std::abs(least) * 0.1, 0.5);
      least -= margin;
      greatest += margin;
    }
    step = StepOf(greatest - least);
    min = std::floor(least / step) * step;
    max = std::ceil(greatest / step) * step;
  }

  long steps() const { return std::lround((max - min) / step); }
  double ValueAt(long mark) const { return min + static_cast<double>(mark) * step; }
};

std::string Number(double number) {
  // Multiples of a step miss zero by rounding: "0", not "-2.8e-17".
  return fmt::format("{:.6g}", std::abs(number) < 1e-12 ? 0.0 : number);
}

std::vector<PlotPoint> FinitePoints(const std::vector<PlotPoint>& all) {
  std::vector<PlotPoint> points;
  std::copy_if(all.begin(), all.end(), std::back_inserter(points),
               [](const PlotPoint& point) { return std::isfinite(point.x) && std::isfinite(point.y); });
  return points;
}

Axis AxisOfX(const std::vector<PlotPoint>& points, const PlotSettings& settings) {
  // Words stand in the middle of their columns.
  if (!settings.x_words.empty()) return {-0.5, static_cast<double>(settings.x_words.size()) - 0.5, 1.0};
  const auto is_left = [](const PlotPoint& a, const PlotPoint& b) { return a.x < b.x; };
  const auto [left, right] = std::minmax_element(points.begin(), points.end(), is_left);
  return points.empty() ? Axis(0.0, 1.0) : Axis(left->x, right->x);
}

// With the line of the settings and the errors of the points.
Axis AxisOfY(const std::vector<PlotPoint>& points, const PlotSettings& settings) {
  if (points.empty()) return {settings.line.value_or(0.0), settings.line.value_or(1.0)};
  double low = settings.line.value_or(points.front().y);
  double high = low;
  for (const PlotPoint& point : points) {
    low = std::min(low, point.y - point.error);
    high = std::max(high, point.y + point.error);
  }
  return {low, high};
}

// The parts of a plot, each as elements of SVG.
class Plot {
 public:
  Plot(std::vector<PlotPoint> points, const PlotSettings& settings)
      : points_(std::move(points)),
        settings_(settings),
        x_(AxisOfX(points_, settings)),
        y_(AxisOfY(points_, settings)),
        width_(settings.width - kLeft - kRight),
        height_(settings.height - kTop - kBottom) {}

  std::string Draw() const {
    std::string svg = fmt::format(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1}\" viewBox=\"0 0 {0} {1}\" "
        "role=\"img\" aria-label=\"{2}\" font-family=\"sans-serif\" font-size=\"11\">\n<rect width=\"{0}\" "
        "height=\"{1}\" fill=\"#fff\"/>\n",
        settings_.width, settings_.height, XmlText(settings_.title));
    svg += fmt::format("<text x=\"{}\" y=\"18\" text-anchor=\"middle\" font-size=\"13\">{}</text>\n",
                       settings_.width / 2, XmlText(settings_.title));
    return svg + MarksOfY() + (has_words() ? Words() : MarksOfX()) + FrameAndLabels() + Points() + "</svg>\n";
  }

 private:
  bool has_words() const { return !settings_.x_words.empty(); }
  double ToPixelX(double value) const { return kLeft + (value - x_.min) / (x_.max - x_.min) * width_; }
  double ToPixelY(double value) const { return kTop + (y_.max - value) / (y_.max - y_.min) * height_; }

  std::string MarksOfY() const {
    std::string svg;
    for (long i = 0; i <= y_.steps(); ++i) {
      const double value = y_.ValueAt(i);
      svg += fmt::format(
          "<line x1=\"{:.1f}\" x2=\"{:.1f}\" y1=\"{:.1f}\" y2=\"{:.1f}\" stroke=\"#ddd\"/>"
          "<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"end\">{}</text>\n",
          kLeft, kLeft + width_, ToPixelY(value), ToPixelY(value), kLeft - 5, ToPixelY(value) + 4, Number(value));
    }
    return svg;
  }

  std::string MarksOfX() const {
    std::string svg;
    const double bottom = kTop + height_;
    for (long i = 0; i <= x_.steps(); ++i) {
      const double value = x_.ValueAt(i);
      svg += fmt::format(
          "<line x1=\"{0:.1f}\" x2=\"{0:.1f}\" y1=\"{1:.1f}\" y2=\"{2:.1f}\" stroke=\"#999\"/>"
          "<text x=\"{0:.1f}\" y=\"{3:.1f}\" text-anchor=\"middle\">{4}</text>\n",
          ToPixelX(value), bottom, bottom + 4, bottom + 15, Number(value));
    }
    return svg;
  }

  // In place of marks of x.
  std::string Words() const {
    std::string svg;
    for (std::size_t i = 0; i < settings_.x_words.size(); ++i) {
      svg += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\">{}</text>\n",
                         ToPixelX(static_cast<double>(i)), kTop + height_ + 15, XmlText(settings_.x_words[i]));
    }
    return svg;
  }

  std::string FrameAndLabels() const {
    std::string svg = fmt::format(
        "<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" fill=\"none\" stroke=\"#999\"/>\n", kLeft,
        kTop, width_, height_);
    svg += fmt::format("<text x=\"{:.1f}\" y=\"{}\" text-anchor=\"middle\">{}</text>\n", kLeft + width_ / 2,
                       settings_.height - 10, XmlText(settings_.x_label));
    svg += fmt::format("<text transform=\"translate(13 {:.1f}) rotate(-90)\" text-anchor=\"middle\">{}</text>\n",
                       kTop + height_ / 2, XmlText(settings_.y_label));
    if (!settings_.line) return svg;
    return svg + fmt::format(
                     "<line x1=\"{:.1f}\" x2=\"{:.1f}\" y1=\"{:.1f}\" y2=\"{:.1f}\" stroke=\"#c0392b\" "
                     "stroke-dasharray=\"4 3\"/>\n",
                     kLeft, kLeft + width_, ToPixelY(*settings_.line), ToPixelY(*settings_.line));
  }

  // Errors, markers, and the line through the points.
  std::string Points() const {
    std::string svg;
    for (const PlotPoint& point : points_) {
      const double x = ToPixelX(point.x);
      if (point.error > 0.0) {
        svg += fmt::format("<line x1=\"{0:.1f}\" x2=\"{0:.1f}\" y1=\"{1:.1f}\" y2=\"{2:.1f}\" stroke=\"#2471a3\"/>\n",
                           x, ToPixelY(point.y - point.error), ToPixelY(point.y + point.error));
      }
      if (settings_.markers)
        svg += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3\" fill=\"#2471a3\"/>\n", x, ToPixelY(point.y));
    }
    if (points_.size() < 2 || has_words()) return svg;
    svg += "<polyline fill=\"none\" stroke=\"#2471a3\" stroke-width=\"1.3\" points=\"";
    for (const PlotPoint& point : points_) svg += fmt::format("{:.1f},{:.1f} ", ToPixelX(point.x), ToPixelY(point.y));
    return svg + "\"/>\n";
  }

  std::vector<PlotPoint> points_;
  const PlotSettings& settings_;
  Axis x_;
  Axis y_;
  double width_;  // of the frame, pixels
  double height_;
};

}  // namespace

std::string MakePlot(const std::vector<PlotPoint>& all, const PlotSettings& settings) {
  return Plot(FinitePoints(all), settings).Draw();
}

}  // namespace troupe
