#include "common/sensing/fiducial.h"

#include <cmath>
#include <optional>
#include <vector>

#include "common/sensing/fan_marks.h"
#include "common/sensing/model_pose.h"
#include "common/sensing/reading_json.h"
#include "common/spatial/column_cast.h"

namespace troupe {
namespace {

class FiducialFinder final : public Sensor {
 public:
  explicit FiducialFinder(const SensorMount& mount) : Sensor(mount) {}

  std::string JsonLines(const WorldDescription& world, const SensorReading& reading) const override {
    std::string line = LineStart(reading.tick, world.robot(robot()).name, description().name) + ",\"fiducials\":[";
    for (const Fiducial& fiducial : std::get<FiducialReading>(reading.content).fiducials) {
      if (line.back() != '[') line += ',';
      const Pose& pose = fiducial.X_SF;
      line += "{\"id\":" + std::to_string(fiducial.id) + ",\"model\":" + JsonString(world.model(fiducial.model).name) +
              ",\"range\":" + JsonNumber(fiducial.range) + ",\"bearing\":" + JsonNumber(fiducial.bearing) +
              ",\"pose\":" + JsonNumbers({{pose.x, pose.y, pose.z, pose.heading}}) +
              ",\"size\":" + JsonNumbers({{fiducial.size_x, fiducial.size_y, fiducial.size_z}}) + "}";
    }
    return line + "]}\n";
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
    if (hit && IsInTree(world.scene.world(), hit->model, model)) return true;
    return parameters().ignores_height && (!hit || hit->distance > range);
  }
};

}  // namespace

std::unique_ptr<const Sensor> MakeFiducialFinder(const SensorMount& mount) {
  return std::make_unique<FiducialFinder>(mount);
}

}  // namespace troupe
