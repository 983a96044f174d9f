#include "worldfile/map/zone_mask.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <optional>
#include <utility>

#include "common/base/text.h"
#include "common/image/image_file.h"
#include "common/model/zones.h"
#include "worldfile/map/map_yaml.h"
#include "worldfile/text/text_file.h"

namespace troupe {
namespace {

using Corner = std::pair<int, int>;  // column and row of a corner of cells

constexpr int kMaxNumber = 100;

// A number for each cell of a mask, row by row from the bottom.
struct MaskCells {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> numbers;
};

// The cells of a mask that have one number, as outlines of their areas.
class AreaTracer {
 public:
  AreaTracer(const MaskCells& cells, std::uint8_t number)
      : width_(cells.width), height_(cells.height), part_(cells.numbers.size(), kNone) {
    for (std::size_t i = 0; i < part_.size(); ++i) {
      if (cells.numbers[i] == number) part_[i] = kUnseen;
    }
  }

  // The outlines of all areas, in cells; the error is that there are too many, or too many corners.
  Result<std::vector<std::vector<Corner>>> Trace() {
    for (std::size_t cell = 0; cell < part_.size(); ++cell) {
      if (part_[cell] == kUnseen) parts_.push_back(Collect(cell));
      while (!parts_.empty()) {
        if (outlines_.size() + parts_.size() > kMaxMaskAreas) {
          return Failure(fmt::format("found more than {} areas, expected fewer", kMaxMaskAreas));
        }
        std::vector<std::size_t> part = std::move(parts_.back());
        parts_.pop_back();
        if (Status problem = Outline(part); !problem.ok()) return problem.error();
      }
    }
    return std::move(outlines_);
  }

 private:
  static constexpr std::uint32_t kNone = 0;
  static constexpr std::uint32_t kUnseen = 1;

  std::size_t Index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x);
  }
  int ColumnOf(std::size_t cell) const { return static_cast<int>(cell % static_cast<std::size_t>(width_)); }
  int RowOf(std::size_t cell) const { return static_cast<int>(cell / static_cast<std::size_t>(width_)); }
  bool IsPart(int x, int y, std::uint32_t part) const {
    return x >= 0 && y >= 0 && x < width_ && y < height_ && part_[Index(x, y)] == part;
  }

  // All cells that are connected with one, and have its mark, under a new mark.
  std::vector<std::size_t> Collect(std::size_t first) {
    const std::uint32_t before = part_[first];
    const std::uint32_t mark = ++marks_;
    std::vector<std::size_t> cells = {first};
    part_[first] = mark;
    for (std::size_t i = 0; i < cells.size(); ++i) {
      const int x = ColumnOf(cells[i]);
      const int y = RowOf(cells[i]);
      for (const auto& [to_x, to_y] : {Corner{x + 1, y}, Corner{x, y + 1}, Corner{x - 1, y}, Corner{x, y - 1}}) {
        if (!IsPart(to_x, to_y, before)) continue;
        part_[Index(to_x, to_y)] = mark;
        cells.push_back(Index(to_x, to_y));
      }
    }
    return cells;
  }

  // The outline of a part without holes; another one is cut at the lowest row of a hole.
  Status Outline(std::vector<std::size_t>& part) {
    const std::uint32_t mark = part_[part.front()];
    // Edges with the part on their left, by their starts: at most two leave a corner.
    std::map<Corner, std::array<std::optional<Corner>, 2>> edges;
    const auto add = [&](Corner from, Corner to) {
      auto& ends = edges[from];
      ends[ends[0] ? 1 : 0] = to;
    };
    for (const std::size_t cell : part) {
      const int x = ColumnOf(cell);
      const int y = RowOf(cell);
      if (!IsPart(x, y - 1, mark)) add({x, y}, {x + 1, y});
      if (!IsPart(x + 1, y, mark)) add({x + 1, y}, {x + 1, y + 1});
      if (!IsPart(x, y + 1, mark)) add({x + 1, y + 1}, {x, y + 1});
      if (!IsPart(x - 1, y, mark)) add({x, y + 1}, {x, y});
    }
    // A corner that is passed twice, or a loop beside that of the lowest corner.
    std::optional<int> cut;
    for (const auto& [corner, ends] : edges) {
      if (ends[1]) cut = cut ? std::min(*cut, corner.second) : corner.second;
    }
    std::vector<Corner> outline;
    if (!cut) {
      const Corner start = edges.begin()->first;  // the leftmost, which is on the outer loop
      Corner at = start;
      Corner last = {start.first, start.second};
      do {
        const Corner to = *edges.at(at)[0];
        edges.erase(at);
        const bool is_straight = !outline.empty() && (last.first == to.first || last.second == to.second);
        if (!is_straight) {
          outline.push_back(at);
          last = at;
        }
        at = to;
      } while (at != start);
      for (const auto& [corner, ends] : edges) cut = cut ? std::min(*cut, corner.second) : corner.second;
    }
    if (!cut) {
      if (outline.size() > kMaxMaskCorners) {
        return Failure(fmt::format("found an area with more than {} corners, expected fewer", kMaxMaskCorners));
      }
      outlines_.push_back(std::move(outline));
      return Status();
    }
    const std::uint32_t below = ++marks_;
    const std::uint32_t above = ++marks_;
    for (const std::size_t cell : part) part_[cell] = RowOf(cell) < *cut ? below : above;
    for (const std::size_t cell : part) {
      if (part_[cell] == below || part_[cell] == above) parts_.push_back(Collect(cell));
    }
    return Status();
  }

  int width_;
  int height_;
  std::vector<std::uint32_t> part_;  // by cell: the mark of its part
  std::uint32_t marks_ = kUnseen;
  std::vector<std::vector<std::size_t>> parts_;  // that are to be outlined
  std::vector<std::vector<Corner>> outlines_;
};

// The image is read once for each binary digit of its numbers: the reader of images gives one bit of each pixel.
Result<MaskCells> ReadCells(const MapYaml& map) {
  constexpr int kDigits = 7;  // of numbers up to kMaxNumber
  MaskCells cells;
  for (int digit = 0; digit < kDigits; ++digit) {
    PixelRule rule = map.rule;
    for (std::size_t value = 0; value < 256; ++value) {
      const std::uint8_t number = map.numbers[value] <= kMaxNumber ? map.numbers[value] : 0;  // 255: unknown
      rule.occupied[value] = ((number >> digit) & 1) != 0;
    }
    const Result<Bitmap> bits = ReadBitmap(map.image, rule);
    if (!bits.ok()) return Error{map.image_where, "mask " + QuotedPath(map.image) + ": " + bits.error().message};
    cells.width = bits.value().width();
    cells.height = bits.value().height();
    if (std::int64_t{cells.width} * cells.height > kMaxMaskCells) {
      return Error{map.image_where, fmt::format("found a mask of more than {} cells, expected fewer", kMaxMaskCells)};
    }
    cells.numbers.resize(static_cast<std::size_t>(cells.width) * static_cast<std::size_t>(cells.height));
    for (int y = 0; y < cells.height; ++y) {
      for (int x = cells.width > 0 ? bits.value().FirstFrom(0, y, true) : 0; x < cells.width;
           x = x + 1 < cells.width ? bits.value().FirstFrom(x + 1, y, true) : cells.width) {
        std::uint8_t& number = cells.numbers[static_cast<std::size_t>(y) * static_cast<std::size_t>(cells.width) +
                                             static_cast<std::size_t>(x)];
        number = static_cast<std::uint8_t>(number | (1U << digit));
      }
    }
  }
  return cells;
}

// m/s: steps that are exact for limits in cm/s, and for which 100 are enough.
double StepOf(const WorldDescription& world) {
  double most = 0.0;
  for (const ZoneDescription& zone : world.zones) {
    if (zone.kind == ZoneKind::kSpeed) most = std::max(most, zone.speed_limit);
  }
  return 0.01 * std::max(1.0, std::ceil(most - 1e-9));
}

}  // namespace

Result<std::vector<MaskArea>> ReadZoneMask(const std::string& path, const SourceLocation& where,
                                           const AllowedPaths& allowed, bool full) {
  Result<MapYaml> map = ReadMapYaml(path, where, allowed);
  if (!map.ok()) return map.error();
  const std::optional<std::string> image = allowed.Resolve(map.value().image);
  if (!image) return Error{map.value().image_where, "mask: " + NotAllowed(map.value().image, allowed)};
  map.value().image = *image;
  const Result<MaskCells> cells = ReadCells(map.value());
  if (!cells.ok()) return cells.error();
  std::array<bool, kMaxNumber + 1> is_there{};
  for (const std::uint8_t number : cells.value().numbers) is_there[number] = true;
  const Transform2 X_WM(map.value().origin);
  const double resolution = map.value().resolution;
  std::vector<MaskArea> areas;
  for (int number = full ? kMaxNumber : 1; number <= kMaxNumber; ++number) {
    if (!is_there[static_cast<std::size_t>(number)]) continue;
    auto outlines = AreaTracer(cells.value(), static_cast<std::uint8_t>(number)).Trace();
    if (!outlines.ok()) return Error{where, outlines.error().message};
    for (const std::vector<Corner>& outline : outlines.value()) {
      Polygon corners;
      for (const auto& [x, y] : outline) corners.push_back(X_WM * Vec2(x * resolution, y * resolution));
      Result<Polygon> normalized = Normalized(std::move(corners));
      if (!normalized.ok()) return Error{where, "found an area that is no polygon: " + normalized.error().message};
      areas.push_back({std::move(normalized).value(), number});
    }
    if (areas.size() <= kMaxMaskAreas) continue;
    return Error{where, fmt::format("found more than {} areas, expected fewer", kMaxMaskAreas)};
  }
  return areas;
}

ZoneMask MakeZoneMask(const WorldDescription& world, ZoneKind kind, double height, const OccupancyGrid& grid,
                      const std::string& image_name) {
  ZoneMask mask;
  if (kind == ZoneKind::kSpeed) mask.multiplier = StepOf(world);
  std::vector<std::uint8_t> numbers(std::size_t{grid.width} * grid.height, 0);
  for (const ZoneDescription& zone : world.zones) {
    if (zone.kind != kind || !zone.is_on || !IsOnLevelOf(world, zone, height)) continue;
    const double steps = kind == ZoneKind::kSpeed ? zone.speed_limit / mask.multiplier : 100.0;
    const auto number = static_cast<std::uint8_t>(std::clamp(std::round(steps), 1.0, 100.0));
    const Rectangle box = BoundingBox(zone.outline);
    const auto cell_at = [&](double at, std::uint32_t count) {
      return static_cast<std::uint32_t>(std::clamp(std::floor(at / grid.resolution), 0.0, static_cast<double>(count)));
    };
    const std::uint32_t last_row = std::min(grid.height, cell_at(box.max_y - grid.origin_y, grid.height) + 1);
    const std::uint32_t last_column = std::min(grid.width, cell_at(box.max_x - grid.origin_x, grid.width) + 1);
    for (std::uint32_t row = cell_at(box.min_y - grid.origin_y, grid.height); row < last_row; ++row) {
      for (std::uint32_t column = cell_at(box.min_x - grid.origin_x, grid.width); column < last_column; ++column) {
        const Vec2 center(grid.origin_x + (column + 0.5) * grid.resolution,
                          grid.origin_y + (row + 0.5) * grid.resolution);
        std::uint8_t& cell = numbers[std::size_t{row} * grid.width + column];
        if ((cell == 0 || number < cell) && Contains(zone.outline, center)) cell = number;
      }
    }
  }
  mask.image = fmt::format("P5\n{} {}\n255\n", grid.width, grid.height);
  mask.image.reserve(mask.image.size() + numbers.size());
  for (std::uint32_t row = grid.height; row-- > 0;) {
    for (std::uint32_t column = 0; column < grid.width; ++column) {
      // In the mode `scale` a pixel is 255 less than the number in 255ths.
      const double number = numbers[std::size_t{row} * grid.width + column];
      mask.image += static_cast<char>(static_cast<std::uint8_t>(255.0 - std::round(number * 2.55)));
    }
  }
  mask.yaml = fmt::format(
      "image: {}\nmode: scale\nresolution: {}\norigin: [{}, {}, 0]\nnegate: 0\noccupied_thresh: 1.0\nfree_thresh: "
      "0.0\n",
      image_name, grid.resolution, grid.origin_x, grid.origin_y);
  return mask;
}

}  // namespace troupe
