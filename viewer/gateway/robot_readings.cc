#include "viewer/gateway/robot_readings.h"

#include <span>
#include <variant>

#include "viewer/gateway/byte_writer.h"

namespace troupe {
namespace {

enum class ReadingKind : std::uint8_t { kNone = 0, kRanger = 1, kBreakBeams = 2 };

void Write(ByteWriter& writer, std::span<const double> values) {
  writer.WriteCount(values.size());
  for (const double value : values) writer.Write(value);
}

struct ContentWriter {
  ByteWriter& writer;

  void Write(ReadingKind kind) const { writer.Write(static_cast<std::uint8_t>(kind)); }
  void operator()(const std::monostate&) const { Write(ReadingKind::kNone); }
  void operator()(const RangerReading& ranger) const {
    Write(ReadingKind::kRanger);
    writer.WriteCount(ranger.scans.size());
    for (const RangeScan& scan : ranger.scans) {
      writer.WritePose(scan.X_RS);
      writer.Write(scan.fan.fov);
      writer.Write(scan.limits.min);
      writer.Write(scan.limits.max);
      troupe::Write(writer, scan.ranges);
    }
  }
  void operator()(const BreakBeamReading& reading) const {
    Write(ReadingKind::kBreakBeams);
    writer.WriteCount(reading.gripper_model.index());
    writer.WriteCount(reading.beams.size());
    for (const BreakBeamReading::Beam& beam : reading.beams) {
      for (const double value :
           {beam.beam.from.x(), beam.beam.from.y(), beam.beam.to.x(), beam.beam.to.y(), beam.beam.z}) {
        writer.Write(value);
      }
      writer.WriteByte(beam.broken_by.has_value());
    }
  }
  // The page does not show other kinds.
  template <typename Other>
  void operator()(const Other&) const {
    Write(ReadingKind::kNone);
  }
};

}  // namespace

void RobotReadings::SetState(const std::shared_ptr<const Scene>& scene, const WorldState& state) {
  if (scene != scene_) {
    suites_.clear();
    scene_ = scene;
    bodies_.emplace(*scene_);
  }
  state_ = &state;
  bodies_fresh_ = false;
  encoded_.clear();
}

const std::string& RobotReadings::Of(RobotId robot) {
  if (const auto known = encoded_.find(robot); known != encoded_.end()) return known->second;
  if (!bodies_fresh_) bodies_->Assign(*state_);
  bodies_fresh_ = true;
  SensorSuite& suite = suites_.try_emplace(robot, *scene_, robot).first->second;
  ByteWriter writer;
  writer.WriteCount(robot.index());
  writer.Write(state_->tick);
  writer.WriteCount(suite.size());
  for (std::size_t i = 0; i < suite.size(); ++i) {
    writer.WriteText(suite.sensor(i).description().name);
    std::visit(ContentWriter{writer}, suite.Measure(i, {*scene_, *bodies_, state_}, state_->tick).content);
  }
  return encoded_.emplace(robot, writer.TakeBytes()).first->second;
}

}  // namespace troupe
