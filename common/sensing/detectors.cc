// The finders of colours and of fiducials: both cast horizontal rays in the plane of the sensor and take the first
// body, seen or unseen by rangers (Sight::kBodies).
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "common/sensing/sensor.h"
#include "common/sensing/sensor_kinds.h"
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
    std::string line;
    JsonWriter json(line);
    BeginReading(json, reading.tick, world.robot(robot()).name, description().name);
    json.Key("blobs").BeginList();
    for (const Blob& blob : std::get<BlobfinderReading>(reading.content).blobs) {
      json.BeginObject().Member("color", std::array{blob.color.r, blob.color.g, blob.color.b});
      json.Member("left", blob.left).Member("top", blob.top).Member("right", blob.right).Member("bottom", blob.bottom);
      json.Member("range", blob.range).EndObject();
    }
    json.EndList().EndObject();
    return line + "\n";
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
      // One ray through the middle of each column: a body narrower than a column may be missed, as by a real sensor of
      // that resolution.
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
    // A stretch ends with its colour; two bodies of one colour side by side are one blob.
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

class FiducialFinder final : public Sensor {
 public:
  explicit FiducialFinder(const SensorMount& mount) : Sensor(mount) {}

  std::string JsonLines(const WorldDescription& world, const SensorReading& reading) const override {
    std::string line;
    JsonWriter json(line);
    BeginReading(json, reading.tick, world.robot(robot()).name, description().name);
    json.Key("fiducials").BeginList();
    for (const Fiducial& fiducial : std::get<FiducialReading>(reading.content).fiducials) {
      const Pose& pose = fiducial.X_SF;
      json.BeginObject().Member("id", fiducial.id).Member("model", world.model(fiducial.model).name);
      json.Member("range", fiducial.range).Member("bearing", fiducial.bearing);
      json.Member("pose", std::array{pose.x, pose.y, pose.z, pose.heading});
      json.Member("size", std::array{fiducial.size_x, fiducial.size_y, fiducial.size_z}).EndObject();
    }
    json.EndList().EndObject();
    return line + "\n";
  }

  void AddMarks(const SensedWorld& world, const SensorReading& reading, std::vector<Mark>& marks) const override {
    const FiducialReading& content = std::get<FiducialReading>(reading.content);
    const Pose X_WS = world.bodies.X_WB(world.scene.body_of(robot())) * content.X_RS;
    marks.push_back(SectorMark(X_WS, content.fov, content.limits.max));
    for (const Fiducial& fiducial : content.fiducials) {
      const Vec2 at = fiducial.X_WF.translation();
      marks.push_back({MarkShape::kLine, MarkRole::kFound, X_WS.z, {X_WS.translation(), at}});
      marks.push_back({MarkShape::kDot, MarkRole::kFound, X_WS.z, {at}});
    }
  }

 private:
  const FiducialParameters& parameters() const { return std::get<FiducialParameters>(description().parameters); }

  void MeasureInto(const SensedWorld& world, Tick tick, SensorReading& reading) const override {
    reading.tick = tick;
    FiducialReading& content = ContentOf<FiducialReading>(reading);
    content.X_RS = MountAt(world) * parameters().X_MS;
    content.limits = parameters().range;
    content.fov = parameters().fov;
    content.fiducials.clear();
    const Pose X_WS = world.bodies.X_WM(description().model) * parameters().X_MS;
    std::optional<ColumnCaster> caster;  // made for the first model in the field of view
    for (const ModelId model : world.scene.fiducials()) {
      const ModelDescription& fiducial = world.scene.world().model(model);
      if (fiducial.fiducial_key != parameters().key || IsOnOwnRobot(world, model)) continue;
      const Pose X_WF = PoseOfModel(world, model);
      const Vec2 way = X_WF.translation() - X_WS.translation();
      const double range = std::sqrt(way.squaredNorm());
      // The cheap tests first; the ray for the line of sight comes last. At a distance of 0 there is no bearing.
      if (!parameters().range.Contains(range) || !(range > 0.0)) continue;
      const Pose X_SF = Inverse(X_WS) * X_WF;
      const double bearing = Atan2(X_SF.y, X_SF.x);
      if (std::abs(bearing) > 0.5 * parameters().fov) continue;
      if (!caster) {
        caster.emplace(world.scene, world.bodies, X_WS.translation(), parameters().range.max, robot(), Sight::kBodies);
      }
      if (!IsInSight(world, *caster, X_WS.z, way / range, range, model)) continue;
      content.fiducials.push_back({.id = range <= parameters().id_range ? fiducial.fiducial_return : 0,
                                   .model = model,
                                   .range = range,
                                   .bearing = bearing,
                                   .X_SF = X_SF,
                                   .X_WF = X_WF,
                                   .size_x = fiducial.size_x,
                                   .size_y = fiducial.size_y,
                                   .size_z = fiducial.size_z});
    }
  }

  // The robot itself, and the objects that it holds.
  bool IsOnOwnRobot(const SensedWorld& world, ModelId model) const {
    const std::optional<BodyId> body = world.scene.body_of(model);
    return body && world.bodies.owner(*body) == robot();
  }

  bool IsInSight(const SensedWorld& world, ColumnCaster& caster, double z, const Vec2& direction, double range,
                 ModelId model) const {
    std::vector<ColumnCut> cuts;
    caster.Cut(direction, {z, z}, cuts);
    const std::optional<ColumnHit> hit = FirstHit({z, 0.0}, cuts);
    // The body that ends the ray may be a part of the model.
    if (hit && IsInTree(world.scene.world(), hit->model, model)) return true;
    return parameters().ignores_height && (!hit || hit->distance > range);
  }
};

}  // namespace

std::unique_ptr<const Sensor> MakeBlobfinder(const SensorMount& mount) {
  return std::make_unique<Blobfinder>(mount);
}

std::unique_ptr<const Sensor> MakeFiducialFinder(const SensorMount& mount) {
  return std::make_unique<FiducialFinder>(mount);
}

}  // namespace troupe
