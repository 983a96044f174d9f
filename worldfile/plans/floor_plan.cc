#include "worldfile/plans/floor_plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <set>

#include "common/base/glob.h"
#include "troupe/rectangle.h"
#include "worldfile/text/text_file.h"

namespace troupe {
namespace {

// Of a layer in a world file, where texts have no escapes and names of models no blanks.
std::string NameOfLayer(const std::string& layer) {
  std::string name;
  for (const char c : layer.substr(0, 100)) {
    const bool is_plain =
        (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' || c == '_';
    name += is_plain ? c : '_';
  }
  return name.empty() ? "walls" : name;
}

// The height of a layer's walls; nothing: it has none.
std::optional<double> HeightOf(const std::string& layer, const PlanWalls& walls) {
  if (walls.rules.empty()) return walls.height;
  for (const PlanRule& rule : walls.rules) {
    if (MatchesGlob(rule.layer, layer)) return rule.height;
  }
  return std::nullopt;
}

// Lines that are drawn twice, also from their other ends, once each; to a millimetre.
std::vector<PlanLine> Distinct(const std::vector<PlanLine>& lines) {
  using Key = std::array<std::int64_t, 4>;
  std::set<Key> seen;
  std::vector<PlanLine> kept;
  for (const PlanLine& line : lines) {
    const auto key = [](const Vec2& a, const Vec2& b) {
      return Key{std::llround(a.x() * 1e3), std::llround(a.y() * 1e3), std::llround(b.x() * 1e3),
                 std::llround(b.y() * 1e3)};
    };
    if (!seen.insert(std::min(key(line.start, line.end), key(line.end, line.start))).second) continue;
    kept.push_back(line);
  }
  return kept;
}

std::array<Vec2, 4> CornersOf(const PlanLine& line, double thickness) {
  const Vec2 way = line.end - line.start;
  const Vec2 along = 0.5 * thickness / way.norm() * way;
  const Vec2 beside(-along.y(), along.x());
  return {line.start - along - beside, line.end + along - beside, line.end + along + beside,
          line.start - along + beside};
}

}  // namespace

Result<FloorPlan> ReadFloorPlan(const std::string& path, PlanUnit unit) {
  const std::string ending = std::filesystem::path(path).extension().string();
  const bool is_dxf = ending == ".dxf" || ending == ".DXF";
  if (!is_dxf && ending != ".svg") {
    return Error{{path}, "found a file ending in " + Quoted(ending) + ", expected .dxf or .svg"};
  }
  const Result<std::string> text = ReadTextFile(path, {path});
  if (!text.ok()) return text.error();
  return is_dxf ? ReadDxfPlan(text.value(), path, unit) : ReadSvgPlan(text.value(), path, unit);
}

Result<std::string> PlanWorldText(const FloorPlan& plan, const PlanWalls& walls, const std::string& source) {
  struct Walls {
    std::string name;
    double height = 0.0;
    std::vector<PlanLine> lines;
  };
  std::vector<Walls> models;
  std::set<std::string> names;
  std::string known;
  Rectangle box = Rectangle::Nothing();
  for (const PlanLayer& layer : plan.layers) {
    known += (known.empty() ? "" : ", ") + Quoted(layer.name);
    const std::optional<double> height = HeightOf(layer.name, walls);
    if (!height) continue;
    std::string name = NameOfLayer(layer.name);
    for (int number = 2; !names.insert(name).second; ++number) {
      name = NameOfLayer(layer.name) + "_" + std::to_string(number);
    }
    models.push_back({name, *height, Distinct(layer.lines)});
    for (const PlanLine& line : models.back().lines) {
      for (const Vec2& corner : CornersOf(line, walls.thickness)) box.Extend(corner);
    }
  }
  if (models.empty()) {
    return Error{{source},
                 known.empty() ? "found no lines, expected a drawing with some"
                               : "found no layer that a rule names, expected one of " + known};
  }
  const Vec2 origin(box.min_x, box.min_y);
  std::string text = fmt::format("# Walls of {}, {:.2f} m x {:.2f} m.\n", PlainLine(source), box.max_x - box.min_x,
                                 box.max_y - box.min_y);
  for (const Walls& model : models) {
    // Stage stretches blocks to the size of their model: it is that of all of them.
    Rectangle own = Rectangle::Nothing();
    for (const PlanLine& line : model.lines) {
      for (const Vec2& corner : CornersOf(line, walls.thickness)) own.Extend(corner - origin);
    }
    text += fmt::format(
        "\nmodel\n(\n  name \"{}\"\n  pose [{:.6f} {:.6f} 0 0]\n  size [{:.6f} {:.6f} {:.6f}]\n  color \"gray40\"\n",
        model.name, 0.5 * (own.min_x + own.max_x), 0.5 * (own.min_y + own.max_y), own.max_x - own.min_x,
        own.max_y - own.min_y, model.height);
    for (const PlanLine& line : model.lines) {
      text += "  block( points 4";
      int number = 0;
      for (const Vec2& corner : CornersOf(line, walls.thickness)) {
        text += fmt::format(" point[{}] [{:.6f} {:.6f}]", number++, corner.x() - origin.x(), corner.y() - origin.y());
      }
      text += fmt::format(" z [0 {:.6f}] )\n", model.height);
    }
    text += ")\n";
  }
  return text;
}

}  // namespace troupe
