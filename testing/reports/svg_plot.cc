#include "testing/reports/svg_plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/base/text.h"

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
};

std::string Number(double number) {
  // Multiples of a step miss zero by rounding: "0", not "-2.8e-17".
  return fmt::format("{:.6g}", std::abs(number) < 1e-12 ? 0.0 : number);
}

}  // namespace

std::string Escaped(const std::string& text) {
  std::string escaped;
  for (const char c : PlainLine(text)) {
    switch (c) {
      case '&':
        escaped += "&amp;";
        break;
      case '<':
        escaped += "&lt;";
        break;
      case '>':
        escaped += "&gt;";
        break;
      case '"':
        escaped += "&quot;";
        break;
      case '\'':
        escaped += "&#39;";
        break;
      default:
        escaped += c;
    }
  }
  return escaped;
}

std::string MakePlot(const std::vector<PlotPoint>& all, const PlotSettings& settings) {
  std::vector<PlotPoint> points;
  std::copy_if(all.begin(), all.end(), std::back_inserter(points),
               [](const PlotPoint& point) { return std::isfinite(point.x) && std::isfinite(point.y); });
  double left = 0.0;
  double right = 1.0;
  double low = settings.line.value_or(0.0);
  double high = settings.line.value_or(1.0);
  if (!points.empty()) {
    left = right = points.front().x;
    if (!settings.line) low = high = points.front().y;
  }
  for (const PlotPoint& point : points) {
    left = std::min(left, point.x);
    right = std::max(right, point.x);
    low = std::min(low, point.y - point.error);
    high = std::max(high, point.y + point.error);
  }
  Axis x(left, right);
  const Axis y(low, high);
  const bool words = !settings.x_words.empty();
  if (words) {
    // Words stand in the middle of their columns.
    x.min = -0.5;
    x.max = static_cast<double>(settings.x_words.size()) - 0.5;
    x.step = 1.0;
  }
  const double width = settings.width - kLeft - kRight;
  const double height = settings.height - kTop - kBottom;
  const auto px = [&](double value) { return kLeft + (value - x.min) / (x.max - x.min) * width; };
  const auto py = [&](double value) { return kTop + (y.max - value) / (y.max - y.min) * height; };

  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1}\" viewBox=\"0 0 {0} {1}\" "
      "font-family=\"sans-serif\" font-size=\"11\">\n<rect width=\"{0}\" height=\"{1}\" fill=\"#fff\"/>\n",
      settings.width, settings.height);
  svg += fmt::format("<text x=\"{}\" y=\"18\" text-anchor=\"middle\" font-size=\"13\">{}</text>\n", settings.width / 2,
                     Escaped(settings.title));
  const auto steps = [](const auto& axis) { return std::lround((axis.max - axis.min) / axis.step); };
  for (long i = 0; i <= steps(y); ++i) {
    const double value = y.min + static_cast<double>(i) * y.step;
    svg += fmt::format(
        "<line x1=\"{:.1f}\" x2=\"{:.1f}\" y1=\"{:.1f}\" y2=\"{:.1f}\" stroke=\"#ddd\"/>"
        "<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"end\">{}</text>\n",
        kLeft, kLeft + width, py(value), py(value), kLeft - 5, py(value) + 4, Number(value));
  }
  if (words) {
    for (std::size_t i = 0; i < settings.x_words.size(); ++i) {
      svg += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\">{}</text>\n",
                         px(static_cast<double>(i)), kTop + height + 15, Escaped(settings.x_words[i]));
    }
  } else {
    for (long i = 0; i <= steps(x); ++i) {
      const double value = x.min + static_cast<double>(i) * x.step;
      svg += fmt::format(
          "<line x1=\"{0:.1f}\" x2=\"{0:.1f}\" y1=\"{1:.1f}\" y2=\"{2:.1f}\" stroke=\"#999\"/>"
          "<text x=\"{0:.1f}\" y=\"{3:.1f}\" text-anchor=\"middle\">{4}</text>\n",
          px(value), kTop + height, kTop + height + 4, kTop + height + 15, Number(value));
    }
  }
  svg += fmt::format(
      "<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" fill=\"none\" stroke=\"#999\"/>\n", kLeft,
      kTop, width, height);
  svg += fmt::format("<text x=\"{:.1f}\" y=\"{}\" text-anchor=\"middle\">{}</text>\n", kLeft + width / 2,
                     settings.height - 10, Escaped(settings.x_label));
  svg += fmt::format("<text transform=\"translate(13 {:.1f}) rotate(-90)\" text-anchor=\"middle\">{}</text>\n",
                     kTop + height / 2, Escaped(settings.y_label));
  if (settings.line) {
    svg += fmt::format(
        "<line x1=\"{:.1f}\" x2=\"{:.1f}\" y1=\"{:.1f}\" y2=\"{:.1f}\" stroke=\"#c0392b\" "
        "stroke-dasharray=\"4 3\"/>\n",
        kLeft, kLeft + width, py(*settings.line), py(*settings.line));
  }
  for (const PlotPoint& point : points) {
    if (point.error > 0.0) {
      svg += fmt::format("<line x1=\"{0:.1f}\" x2=\"{0:.1f}\" y1=\"{1:.1f}\" y2=\"{2:.1f}\" stroke=\"#2471a3\"/>\n",
                         px(point.x), py(point.y - point.error), py(point.y + point.error));
    }
    if (settings.markers) {
      svg += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3\" fill=\"#2471a3\"/>\n", px(point.x), py(point.y));
    }
  }
  if (points.size() > 1 && !words) {
    svg += "<polyline fill=\"none\" stroke=\"#2471a3\" stroke-width=\"1.3\" points=\"";
    for (const PlotPoint& point : points) svg += fmt::format("{:.1f},{:.1f} ", px(point.x), py(point.y));
    svg += "\"/>\n";
  }
  return svg + "</svg>\n";
}

}  // namespace troupe
