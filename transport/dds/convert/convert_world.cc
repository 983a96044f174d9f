// World descriptions: all types with lists of fields by StructWriter and StructReader.
#include <algorithm>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "transport/dds/convert/convert.h"
#include "transport/dds/convert/sensor_numbers.h"
#include "transport/dds/convert/structs.h"

namespace troupe::dds {
namespace {

troupe_wire_PixelLines ToWire(const PixelLines& lines) {
  return {lines.center, lines.factor, lines.second_center, lines.second_factor, lines.shift};
}
PixelLines FromWire(const troupe_wire_PixelLines& wire) {
  return {wire.center, wire.factor, wire.second_center, wire.second_factor, wire.shift};
}

// Equal robots mostly follow one another: each shares its list of rays with its predecessor.
void ShareRaySensors(std::vector<RobotDescription>& robots) {
  const auto rays_of = [](RobotDescription& robot, std::size_t sensor) {
    auto* const ranger =
        sensor < robot.sensors.size() ? std::get_if<RangerParameters>(&robot.sensors[sensor].parameters) : nullptr;
    return ranger != nullptr ? &ranger->ray_sensors : nullptr;
  };
  for (std::size_t i = 1; i < robots.size(); ++i) {
    for (std::size_t sensor = 0; sensor < robots[i].sensors.size(); ++sensor) {
      auto* const own = rays_of(robots[i], sensor);
      const auto* const other = rays_of(robots[i - 1], sensor);
      if (own != nullptr && other != nullptr && *own == *other) *own = *other;
    }
  }
}

}  // namespace

void ToWire(const SensorParameters& parameters, char*& type, dds_sequence_troupe_wire_SensorField& wire,
            WireArena& arena) {
  type = arena.Copy(TypeOf(parameters));
  const std::vector<NamedNumbers> fields = NumbersOf(parameters);
  troupe_wire_SensorField* out = arena.Fill(wire, fields.size());
  for (const NamedNumbers& field : fields) {
    out->name = arena.Copy(field.name);
    std::copy(field.numbers.begin(), field.numbers.end(), arena.Fill(out->numbers, field.numbers.size()));
    ++out;
  }
}
Result<SensorParameters> FromWire(const char* type, const dds_sequence_troupe_wire_SensorField& wire) {
  std::vector<NamedNumbers> fields;
  for (const troupe_wire_SensorField& field : Elements(wire)) {
    const auto numbers = Elements(field.numbers);
    fields.push_back({Text(field.name), {numbers.begin(), numbers.end()}});
  }
  return ParametersFrom(Text(type), fields);
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

troupe_wire_World ToWire(const WorldDescription& world, WireArena& arena) {
  return WriteStruct<troupe_wire_World>(world, arena);
}

Result<WorldDescription> FromWire(const troupe_wire_World& wire) {
  Result<WorldDescription> world = ReadStruct<WorldDescription>(wire);
  if (!world.ok()) return world;
  ShareRaySensors(world.value().robots);
  if (Status status = Validate(world.value()); !status.ok()) return status.error();
  return world;
}

}  // namespace troupe::dds
