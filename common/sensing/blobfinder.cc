#include "common/sensing/blobfinder.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "common/sensing/fan_marks.h"
#include "common/sensing/model_pose.h"
#include "common/sensing/reading_json.h"
#include "common/spatial/column_cast.h"
#include "troupe/deterministic_math.h"

namespace troupe {
namespace {

constexpr double kSameColor = 1e-5;  // of each component, as in Stage

bool AreSame(const Color& a, const Color& b) {
  return std::abs(a.r - b.r) < kSameColor && std::abs(a.g - b.g) < kSameColor && std::abs(a.b - b.b) < kSameColor;
}

// rad, to the left of the middle: of the middle of a column.
double BearingOfColumn(const BlobfinderParameters& parameters, std::uint32_t column) {
  return parameters.fov * (0.5 - (column + 0.5) / parameters.width);
}

class Blobfinder final : public Sensor {
 public:
  explicit Blobfinder(const SensorMount& mount) : Sensor(mount) {}

  std::string JsonLines(const WorldDescription& world, const SensorReading& reading) const override {
    std::string line = LineStart(reading.tick, world.robot(robot()).name, description().name) + ",\"blobs\":[";
    for (const Blob& blob : std::get<BlobfinderReading>(reading.content).blobs) {
      if (line.back() != '[') line += ',';
      line += "{\"color\":" + JsonNumbers({{blob.color.r, blob.color.g, blob.color.b}}) +
              ",\"left\":" + std::to_string(blob.left) + ",\"top\":" + std::to_string(blob.top) +
              ",\"right\":" + std::to_string(blob.right) + ",\"bottom\":" + std::to_string(blob.bottom) +
              ",\"range\":" + JsonNumber(blob.range) + "}";
    }
    return line + "]}\n";
  }

  void AddMarks(const SensedWorld& world, const SensorReading& reading, std::vector<Mark>& marks) const override {
    const BlobfinderReading& content = std::get<BlobfinderReading>(reading.content);
    const Pose X_WS = world.bodies.X_WB(world.scene.body_of(robot())) * content.X_RS;
    marks.push_back(SectorMark(X_WS, content.fov, content.range));
    for (const Blob& blob : content.blobs) {
      Mark mark{MarkShape::kArea, MarkRole::kFound, X_WS.z, {X_WS.translation()}};
      for (const std::uint32_t column : {blob.left, blob.right}) {
        const SinCosResult at = SinCos(X_WS.heading + content.fov * (0.5 - double{1} * column / content.width));
        mark.points.push_back(X_WS.translation() + blob.range * Vec2(at.cos, at.sin));
      }
      marks.push_back(std::move(mark));
    }
  }

 private:
  const BlobfinderParameters& parameters() const { return std::get<BlobfinderParameters>(description().parameters); }

  bool IsFound(const Color& color) const {
    const std::vector<Color>& colors = parameters().colors;
    return colors.empty() ||
           std::any_of(colors.begin(), colors.end(), [&](const Color& known) { return AreSame(known, color); });
  }

  // Pixels are square: a row is as many radians high as a column is wide. `rise`: m, above the finder.
  double RowOf(double rise, double distance) const {
    return 0.5 * parameters().height - Atan2(rise, distance) * parameters().width / parameters().fov;
  }

  void MeasureInto(const SensedWorld& world, Tick tick, SensorReading& reading) const override {
    reading.tick = tick;
    BlobfinderReading& content = ContentOf<BlobfinderReading>(reading);
    content.X_RS = MountAt(world) * parameters().X_MS;
    content.width = parameters().width;
    content.height = parameters().height;
    content.fov = parameters().fov;
    content.range = parameters().range;
    content.blobs.clear();
    const Pose X_WS = world.bodies.X_WM(description().model) * parameters().X_MS;
    ColumnCaster caster(world.scene, world.bodies, X_WS.translation(), parameters().range, robot(), Sight::kBodies);
    std::vector<ColumnCut> cuts;
    for (std::uint32_t column = 0; column < parameters().width; ++column) {
      const SinCosResult at = SinCos(X_WS.heading + BearingOfColumn(parameters(), column));
      caster.Cut({at.cos, at.sin}, {X_WS.z, X_WS.z}, cuts);
      const auto hit =
          std::find_if(cuts.begin(), cuts.end(), [&](const ColumnCut& cut) { return cut.z.Contains(X_WS.z); });
      if (hit == cuts.end()) continue;
      const Color color = ColorOfModel(world, hit->model, tick);
      if (IsFound(color)) AddColumn(column, color, *hit, X_WS.z, content.blobs);
    }
  }

  void AddColumn(std::uint32_t column, const Color& color, const ColumnCut& hit, double z,
                 std::vector<Blob>& blobs) const {
    const auto row = [&](double at) {
      return static_cast<std::uint32_t>(std::clamp(at, 0.0, static_cast<double>(parameters().height)));
    };
    const std::uint32_t top = row(std::floor(RowOf(hit.z.max - z, hit.enter)));
    const std::uint32_t bottom = row(std::ceil(RowOf(hit.z.min - z, hit.enter)));
    if (blobs.empty() || blobs.back().right != column || !AreSame(blobs.back().color, color)) {
      blobs.push_back({color, column, top, column + 1, bottom, hit.enter});
      return;
    }
    Blob& blob = blobs.back();
    blob.right = column + 1;
    blob.top = std::min(blob.top, top);
    blob.bottom = std::max(blob.bottom, bottom);
    blob.range = std::min(blob.range, hit.enter);
  }
};

}  // namespace

std::unique_ptr<const Sensor> MakeBlobfinder(const SensorMount& mount) {
  return std::make_unique<Blobfinder>(mount);
}

}  // namespace troupe
