// Shapes: blocks, rectangles and areas of pixels.
#include <limits>
#include <memory>
#include <utility>

#include "transport/dds/convert/convert_parts.h"

namespace troupe::dds {
namespace {

constexpr std::size_t kNumbersOfPoint = 2;
constexpr std::size_t kNumbersOfRectangle = 4;

troupe_wire_Block ToWire(const Block& block, WireArena& arena) {
  troupe_wire_Block wire{};
  double* out = arena.Fill(wire.outline, block.outline.size() * kNumbersOfPoint);
  for (const Vec2& point : block.outline) {
    *out++ = point.x();
    *out++ = point.y();
  }
  wire.z_min = block.z.min;
  wire.z_max = block.z.max;
  return wire;
}
Status FromWire(const troupe_wire_Block& wire, Block& block) {
  const auto numbers = Elements(wire.outline);
  if (numbers.size() % kNumbersOfPoint != 0 || numbers.size() < 3 * kNumbersOfPoint) {
    return Error{{},
                 "outline of " + std::to_string(numbers.size()) + " numbers, expected x and y of at least 3 points"};
  }
  for (std::size_t i = 0; i < numbers.size(); i += kNumbersOfPoint)
    block.outline.emplace_back(numbers[i], numbers[i + 1]);
  block.z = {wire.z_min, wire.z_max};
  return {};
}

troupe_wire_PixelLines ToWire(const PixelLines& lines) {
  return {lines.center, lines.factor, lines.second_center, lines.second_factor, lines.shift};
}
PixelLines FromWire(const troupe_wire_PixelLines& wire) {
  return {wire.center, wire.factor, wire.second_center, wire.second_factor, wire.shift};
}

troupe_wire_PixelArea ToWire(const PixelArea& area, WireArena& arena) {
  troupe_wire_PixelArea wire{};
  const Bitmap& bitmap = area.cover().bitmap();
  wire.width = static_cast<std::uint32_t>(bitmap.width());
  wire.height = static_cast<std::uint32_t>(bitmap.height());
  const std::size_t words = Bitmap::WordsOf(bitmap.width(), bitmap.height());
  bitmap.Pack({arena.Fill(wire.bits, words), words});
  wire.x = ToWire(area.x());
  wire.y = ToWire(area.y());
  wire.lines_in_model = PoseToWire(area.X_MA());
  return wire;
}
Result<PixelArea> FromWire(const troupe_wire_PixelArea& wire) {
  constexpr std::uint32_t kMaxSide = std::numeric_limits<std::int32_t>::max();
  const auto bits = Elements(wire.bits);
  // Before anything is allocated by these numbers.
  if (wire.width < 1 || wire.height < 1 || wire.width > kMaxSide || wire.height > kMaxSide ||
      bits.size() != (std::uint64_t{wire.width} * wire.height + 63) / 64) {
    return Error{{},
                 "an area of " + std::to_string(wire.width) + " x " + std::to_string(wire.height) + " pixels with " +
                     std::to_string(bits.size()) + " words of 64 bits, expected one bit for each pixel"};
  }
  Bitmap bitmap = Bitmap::Unpacked(static_cast<int>(wire.width), static_cast<int>(wire.height), bits);
  return PixelArea(std::make_shared<const DenseCover>(std::move(bitmap)), FromWire(wire.x), FromWire(wire.y),
                   PoseFromWire(wire.lines_in_model));
}

}  // namespace

troupe_wire_Shape ToWire(const Shape& shape, WireArena& arena) {
  troupe_wire_Shape wire{};
  troupe_wire_Block* blocks = arena.Fill(wire.blocks, shape.blocks.size());
  for (const Block& block : shape.blocks) *blocks++ = ToWire(block, arena);
  double* out = arena.Fill(wire.rectangles, shape.rectangles.size() * kNumbersOfRectangle);
  for (const Rectangle& rectangle : shape.rectangles) {
    *out++ = rectangle.min_x;
    *out++ = rectangle.min_y;
    *out++ = rectangle.max_x;
    *out++ = rectangle.max_y;
  }
  wire.rectangles_z_min = shape.rectangles_z.min;
  wire.rectangles_z_max = shape.rectangles_z.max;
  if (shape.area) *arena.Fill(wire.areas, 1) = ToWire(*shape.area, arena);
  return wire;
}
Status FromWire(const troupe_wire_Shape& wire, Shape& shape) {
  shape.blocks.resize(wire.blocks._length);
  for (std::size_t i = 0; i < shape.blocks.size(); ++i) {
    if (Status failed = FromWire(wire.blocks._buffer[i], shape.blocks[i]); !failed.ok()) return failed;
  }
  const auto numbers = Elements(wire.rectangles);
  if (numbers.size() % kNumbersOfRectangle != 0) {
    return Error{{}, "rectangles of " + std::to_string(numbers.size()) + " numbers, expected 4 for each"};
  }
  shape.rectangles.reserve(numbers.size() / kNumbersOfRectangle);
  for (std::size_t i = 0; i < numbers.size(); i += kNumbersOfRectangle) {
    shape.rectangles.push_back({numbers[i], numbers[i + 1], numbers[i + 2], numbers[i + 3]});
  }
  shape.rectangles_z = {wire.rectangles_z_min, wire.rectangles_z_max};
  const auto areas = Elements(wire.areas);
  if (areas.size() > 1) return Error{{}, std::to_string(areas.size()) + " areas of a shape, expected at most 1"};
  if (areas.empty()) return {};
  Result<PixelArea> area = FromWire(areas.front());
  if (!area.ok()) return area.error();
  shape.area = std::move(area).value();
  return {};
}

}  // namespace troupe::dds
