// SvgPlot: a plot of a few series as SVG text, for reports. Plain text without scripts, fonts or a server, so that a
// page in an artifact store shows it, and tests can compare it. Numbers have one decimal of a pixel: equal data give
// equal bytes.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace troupe {

struct PlotPoint {
  double x = 0.0;
  double y = 0.0;
  double error = 0.0;  // half the height of its bar; 0: none
};

struct PlotSettings {
  std::string title;
  std::string x_label;
  std::string y_label;
  // Words of the x axis: x is their index, from 0. Empty: numbers.
  std::vector<std::string> x_words = {};
  std::optional<double> line = {};  // a horizontal line at this y
  bool markers = true;              // a dot for each point
  int width = 560;                  // pixels
  int height = 300;
};

// A line through the points, in their order, with bars. Points that are not finite are left out.
std::string MakePlot(const std::vector<PlotPoint>& points, const PlotSettings& settings);

}  // namespace troupe
