// Plots columns of a CSV file over its first column, as panels one below another.
//   soak_plot CSV PNG TITLE PANEL...      PANEL: "title=column,column,..."
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "command_line/parse_command_line.h"
#include "common/picture/canvas.h"

namespace troupe {
namespace {

constexpr int kWidth = 1100;  // px, as all lengths here
constexpr int kPanelHeight = 190;
constexpr int kTop = 40;
constexpr double kLeft = 90.0;
constexpr double kRight = 190.0;  // for the names of the lines
constexpr double kGap = 36.0;     // between panels

constexpr Color kBlack{0.1, 0.1, 0.1, 1.0};
constexpr Color kGrid{0.88, 0.88, 0.88, 1.0};
constexpr Color kLines[] = {{0.12, 0.35, 0.70, 1.0},
                            {0.85, 0.37, 0.05, 1.0},
                            {0.15, 0.55, 0.25, 1.0},
                            {0.60, 0.20, 0.55, 1.0},
                            {0.45, 0.45, 0.45, 1.0}};

using Columns = std::map<std::string, std::vector<double>>;

std::vector<std::string> Split(const std::string& text, char separator) {
  std::vector<std::string> parts;
  std::istringstream stream(text);
  for (std::string part; std::getline(stream, part, separator);) parts.push_back(part);
  return parts;
}

// An empty cell is not a number, and leaves a gap.
Columns ReadColumns(const std::string& path, std::vector<std::string>& names) {
  Columns columns;
  std::ifstream file(path);
  std::string line;
  if (std::getline(file, line)) names = Split(line, ',');
  while (std::getline(file, line)) {
    std::vector<std::string> cells = Split(line, ',');
    cells.resize(names.size());
    for (std::size_t i = 0; i < names.size(); ++i) {
      columns[names[i]].push_back(cells[i].empty() ? std::nan("") : std::atof(cells[i].c_str()));
    }
  }
  return columns;
}

double Largest(const std::vector<double>& values) {
  double largest = 0.0;
  for (const double value : values) largest = std::isfinite(value) ? std::max(largest, value) : largest;
  return largest;
}

// A step of 1, 2 or 5 times a power of ten that divides `range` into about `count`.
double NiceStep(double range, double count) {
  const double power = std::pow(10.0, std::floor(std::log10(std::max(range / count, 1e-9))));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (range / (factor * power) <= count) return factor * power;
  }
  return 10.0 * power;
}

class Panel {
 public:
  Panel(Canvas& canvas, double top, double last_x, double largest_y)
      : canvas_(canvas), top_(top), last_x_(std::max(last_x, 1e-9)), top_y_(std::max(1.1 * largest_y, 1e-9)) {}

  void DrawAxes(const std::string& title, bool with_labels) const {
    canvas_.Text(title, {kLeft, top_ - 6.0}, TextAnchor::kLeft, {13.0, kBlack, true});
    const TextStyle style{11.0, kBlack, false};
    for (double y = 0.0, step = NiceStep(top_y_, 5.0); y <= top_y_; y += step) {
      canvas_.Line(At(0.0, y), At(last_x_, y), 1.0, kGrid);
      canvas_.Text(fmt::format("{:g}", y), At(0.0, y) + Vec2(-6.0, 4.0), TextAnchor::kRight, style);
    }
    for (double x = 0.0, step = NiceStep(last_x_, 12.0); x <= last_x_; x += step) {
      canvas_.Line(At(x, 0.0), At(x, top_y_), 1.0, kGrid);
      if (with_labels) canvas_.Text(fmt::format("{:g}", x), At(x, 0.0) + Vec2(0.0, 16.0), TextAnchor::kMiddle, style);
    }
    canvas_.Line(At(0.0, 0.0), At(last_x_, 0.0), 1.0, kBlack);
    canvas_.Line(At(0.0, 0.0), At(0.0, top_y_), 1.0, kBlack);
  }

  void DrawLine(const std::string& name, std::size_t index, const std::vector<double>& xs,
                const std::vector<double>& ys) const {
    const Color& color = kLines[index % std::size(kLines)];
    for (std::size_t i = 1; i < std::min(xs.size(), ys.size()); ++i) {
      if (!std::isfinite(ys[i - 1]) || !std::isfinite(ys[i])) continue;
      canvas_.Line(At(xs[i - 1], ys[i - 1]), At(xs[i], ys[i]), 1.5, color);
    }
    const Vec2 label(kWidth - kRight + 12.0, top_ + 14.0 + 16.0 * static_cast<double>(index));
    canvas_.Text(name, label, TextAnchor::kLeft, {12.0, color, true});
  }

 private:
  Vec2 At(double x, double y) const {
    return {kLeft + (kWidth - kLeft - kRight) * x / last_x_, top_ + (kPanelHeight - kGap) * (1.0 - y / top_y_)};
  }

  Canvas& canvas_;
  const double top_;
  const double last_x_;
  const double top_y_;
};

void DrawPanel(Canvas& canvas, double top, const std::string& text, bool last, const std::vector<double>& xs,
               const Columns& columns) {
  const std::size_t equals = text.rfind('=');
  std::vector<std::string> names = Split(text.substr(equals + 1), ',');
  std::erase_if(names, [&](const std::string& name) { return !columns.contains(name); });
  double largest = 0.0;
  for (const std::string& name : names) largest = std::max(largest, Largest(columns.at(name)));
  const Panel panel(canvas, top, Largest(xs), largest);
  panel.DrawAxes(text.substr(0, equals), last);
  for (std::size_t i = 0; i < names.size(); ++i) panel.DrawLine(names[i], i, xs, columns.at(names[i]));
}

int Plot(const std::vector<std::string>& arguments) {
  std::vector<std::string> names;
  const Columns columns = ReadColumns(arguments[0], names);
  if (names.empty()) {
    fmt::print(stderr, "{}: error: found no columns, expected a CSV file\n", arguments[0]);
    return kExitBadInput;
  }
  const std::vector<std::string> panels(arguments.begin() + 3, arguments.end());
  const int height = kTop + static_cast<int>(panels.size()) * kPanelHeight + 20;
  Canvas canvas(PictureFormat::kPng, kWidth, height);
  canvas.Fill(Rectangle{0.0, 0.0, kWidth, static_cast<double>(height)}, {1.0, 1.0, 1.0, 1.0});
  canvas.Text(arguments[2], {kLeft, 20.0}, TextAnchor::kLeft, {15.0, kBlack, true});
  for (std::size_t i = 0; i < panels.size(); ++i) {
    const double top = kTop + 18.0 + static_cast<double>(i) * kPanelHeight;
    DrawPanel(canvas, top, panels[i], i + 1 == panels.size(), columns.at(names[0]), columns);
  }
  canvas.Text(names[0], {kWidth - kRight, height - 8.0}, TextAnchor::kRight, {11.0, kBlack, false});
  const Result<std::string> bytes = canvas.Finish();
  std::ofstream(arguments[1], std::ios::binary) << (bytes.ok() ? bytes.value() : "");
  return bytes.ok() ? kExitDone : kExitFailed;
}

}  // namespace
}  // namespace troupe

// An exception while another is reported ends the program.
int main(int argc, char** argv) {  // NOLINT(bugprone-exception-escape)
  if (argc < 5) {
    fmt::print(stderr, "error: expected CSV PNG TITLE PANEL..., a panel as title=column,column\n");
    return troupe::kExitBadInput;
  }
  return troupe::Plot(std::vector<std::string>(argv + 1, argv + argc));
}
