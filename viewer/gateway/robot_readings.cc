#include "viewer/gateway/robot_readings.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <string_view>
#include <variant>

#include "common/base/utf8.h"

namespace troupe {
namespace {

// As in viewer/web/src/protocol.ts.
enum class ReadingKind : std::uint8_t {
  kNone = 0,
  kRanger = 1,
  kBreakBeams = 2,
  kFiducials = 3,
  kBumper = 4,
  kContacts = 5,
  kBlobs = 6,
  kCamera = 7,
  kRadio = 8,
  kImu = 9,
  kKept = 255,  // the reading that the page has still counts
};

// Bytes of a radio message that the page receives; its length comes with them.
constexpr std::size_t kMostMessageBytes = 256;

void Write(ByteWriter& writer, std::span<const double> values) {
  writer.WriteCount(values.size());
  for (const double value : values) writer.Write(value);
}

struct ContentWriter {
  ByteWriter& writer;

  void Write(ReadingKind kind) const { writer.Write(static_cast<std::uint8_t>(kind)); }
  void Write(const Interval& limits) const {
    writer.Write(limits.min);
    writer.Write(limits.max);
  }
  void operator()(const std::monostate&) const { Write(ReadingKind::kNone); }
  void operator()(const RangerReading& ranger) const {
    Write(ReadingKind::kRanger);
    writer.WriteCount(ranger.scans.size());
    for (const RangeScan& scan : ranger.scans) {
      writer.WritePose(scan.X_RS);
      writer.Write(scan.fan.fov);
      Write(scan.limits);
      troupe::Write(writer, scan.elevations);
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
      writer.WriteId(beam.broken_by);
    }
  }
  void operator()(const FiducialReading& reading) const {
    Write(ReadingKind::kFiducials);
    writer.WritePose(reading.X_RS);
    Write(reading.limits);
    writer.Write(reading.fov);
    writer.WriteCount(reading.fiducials.size());
    for (const Fiducial& fiducial : reading.fiducials) {
      writer.Write(fiducial.id);
      writer.WriteCount(fiducial.model.index());
      writer.Write(fiducial.range);
      writer.Write(fiducial.bearing);
      writer.WritePose(fiducial.X_WF);
    }
  }
  void operator()(const BumperReading& reading) const {
    Write(ReadingKind::kBumper);
    writer.Write(reading.height);
    writer.WriteCount(reading.segments.size());
    for (const BumperReading::Segment& segment : reading.segments) {
      writer.WritePose(segment.X_RB);
      writer.Write(segment.length);
      writer.WriteId(segment.pressed_by);
    }
  }
  void operator()(const ContactReading& reading) const {
    Write(ReadingKind::kContacts);
    writer.WriteCount(reading.contacts.size());
    for (const BodyContact& contact : reading.contacts) {
      writer.WriteCount(contact.part.index());
      writer.WriteCount(contact.other.index());
      for (const double value : {contact.point.x(), contact.point.y(), contact.z_min, contact.z_max}) {
        writer.Write(value);
      }
    }
  }
  void operator()(const BlobfinderReading& reading) const {
    Write(ReadingKind::kBlobs);
    writer.WritePose(reading.X_RS);
    writer.Write(reading.width);
    writer.Write(reading.height);
    writer.Write(reading.fov);
    writer.Write(reading.range);
    writer.WriteCount(reading.blobs.size());
    for (const Blob& blob : reading.blobs) {
      for (const double value : {blob.color.r, blob.color.g, blob.color.b}) writer.Write(value);
      for (const std::uint32_t value : {blob.left, blob.top, blob.right, blob.bottom}) writer.Write(value);
      writer.Write(blob.range);
    }
  }
  // The colours alone: the page shows no depths.
  void operator()(const CameraReading& reading) const {
    Write(ReadingKind::kCamera);
    writer.WritePose(reading.X_RS);
    writer.Write(reading.width);
    writer.Write(reading.height);
    for (const double value : {reading.focal_length_x, reading.focal_length_y, reading.center_x, reading.center_y}) {
      writer.Write(value);
    }
    Write(reading.limits);
    writer.WriteCount(reading.colors.size());
    writer.Append({reinterpret_cast<const char*>(reading.colors.data()), reading.colors.size()});
  }
  void operator()(const RadioReading& reading) const {
    Write(ReadingKind::kRadio);
    writer.WritePose(reading.X_RS);
    writer.Write(reading.range);
    writer.WriteCount(reading.receptions.size());
    for (const RadioReception& reception : reading.receptions) {
      writer.WriteCount(reception.from.index());
      writer.WriteByte(reception.to_all);
      writer.WriteCount(reception.bytes.size());
      writer.WriteText(
          CutUtf8({reinterpret_cast<const char*>(reception.bytes.data()), reception.bytes.size()}, kMostMessageBytes));
      writer.Write(reception.rssi);
      writer.Write(reception.tick);
      writer.WriteByte(reception.place.has_value());
      if (!reception.place) continue;
      writer.Write(reception.place->range);
      writer.Write(reception.place->bearing);
      writer.Write(reception.place->elevation);
    }
  }
  void operator()(const ImuReading& reading) const {
    Write(ReadingKind::kImu);
    writer.WritePose(reading.X_RS);
    for (const double value :
         {reading.heading, reading.turn, reading.force_xy.x(), reading.force_xy.y(), reading.force_z}) {
      writer.Write(value);
    }
  }
};

bool IsCamera(const Sensor& sensor) {
  return std::holds_alternative<CameraParameters>(sensor.description().parameters);
}

}  // namespace

void RobotReadings::SetState(const std::shared_ptr<const ViewedState>& state) {
  if (state == state_) return;
  if (state_ == nullptr || state->world->scene != state_->world->scene) {
    robots_.clear();
    bodies_.emplace(*state->world->scene);
  }
  state_ = state;
  bodies_fresh_ = false;
  for (auto& [id, robot] : robots_) robot.encoded.assign(robot.encoded.size(), {});
}

const std::string& RobotReadings::Encoded(Robot& robot, std::size_t sensor) {
  std::string& encoded = robot.encoded[sensor];
  if (!encoded.empty()) return encoded;
  const WorldState& state = *state_->state;
  if (!bodies_fresh_) bodies_->Assign(state);
  bodies_fresh_ = true;
  ByteWriter writer;
  const Scene& scene = *state_->world->scene;
  std::visit(ContentWriter{writer}, robot.suite.Measure(sensor, {scene, *bodies_, &state}, state.tick).content);
  return encoded = writer.TakeBytes();
}

bool RobotReadings::Write(ByteWriter& writer, RobotId id, Pictures pictures) {
  auto known = robots_.find(id);
  if (known == robots_.end()) {
    known = robots_.emplace(id, Robot{SensorSuite(*state_->world->scene, id), {}}).first;
    known->second.encoded.resize(known->second.suite.size());
  }
  Robot& robot = known->second;
  bool is_missing = false;
  writer.WriteCount(id.index());
  writer.Write(state_->state->tick);
  writer.WriteCount(robot.suite.size());
  for (std::size_t i = 0; i < robot.suite.size(); ++i) {
    const Sensor& sensor = robot.suite.sensor(i);
    writer.WriteText(sensor.description().name);
    if (IsCamera(sensor) && pictures != Pictures::kMeasured) {
      ContentWriter{writer}.Write(pictures == Pictures::kKept ? ReadingKind::kKept : ReadingKind::kNone);
      is_missing = true;
    } else {
      writer.Append(Encoded(robot, i));
    }
  }
  return is_missing;
}

}  // namespace troupe
