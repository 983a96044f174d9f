// A controller whose commands depend on every bit of every reading: wherever a sensor reads another bit, the robots
// move in another way, and all hashes from then on differ. It moves, grips, talks, switches lights and turns cameras
// all the time.
#include <bit>
#include <type_traits>

#include "common/base/hash.h"
#include "troupe/controller.h"

namespace {

using namespace troupe;

// Bits of any reading, in the order of its members.
class Digest {
 public:
  void Add(double value) { hasher_.Add(std::bit_cast<std::uint64_t>(value)); }
  template <typename Number>
  requires std::is_integral_v<Number> || std::is_enum_v<Number>
  void Add(Number number) { hasher_.Add(static_cast<std::uint64_t>(number)); }
  template <typename Tag>
  void Add(Id<Tag> id) {
    Add(id.index());
  }
  template <typename Value>
  void Add(const std::optional<Value>& value) {
    Add(value.has_value());
    if (value) Add(*value);
  }
  template <typename Value>
  void Add(const std::vector<Value>& values) {
    Add(values.size());
    for (const Value& value : values) Add(value);
  }
  template <typename Value>
  void Add(std::span<const Value> values) {
    Add(values.size());
    for (const Value& value : values) Add(value);
  }
  void Add(const std::vector<bool>& flags) {
    for (const bool flag : flags) Add(flag);
  }
  void Add(float value) { Add(static_cast<double>(value)); }
  void Add(const Vec2& point) { AddAll(point.x(), point.y()); }
  void Add(const Pose& pose) { AddAll(pose.x, pose.y, pose.z, pose.heading); }
  void Add(const Twist& twist) { AddAll(twist.vx, twist.vy, twist.wz); }
  void Add(const Color& color) { AddAll(color.r, color.g, color.b); }
  void Add(const SeenModel& seen) { Add(seen.id); }
  void Add(const JointReading& joint) { AddAll(joint.position, joint.velocity, joint.blocked, joint.moving); }
  void Add(const GripperReading& gripper) {
    AddAll(gripper.fingers, gripper.lift_moving, gripper.lift_position, gripper.left_contact, gripper.right_contact,
           gripper.held, gripper.clamped, gripper.beams);
  }
  void Add(const EnergyReading& energy) { AddAll(energy.joules, energy.capacity, energy.charge_watts); }
  void Add(const RangeScan& scan) { AddAll(scan.ranges, scan.intensities, scan.X_RS); }
  void Add(const RangerReading& ranger) { Add(ranger.scans()); }
  void Add(const BreakBeamReading::Beam& beam) { Add(beam.broken_by); }
  void Add(const BreakBeamReading& beams) { Add(beams.beams); }
  void Add(const Fiducial& fiducial) {
    AddAll(fiducial.id, fiducial.model, fiducial.range, fiducial.bearing, fiducial.X_SF, fiducial.X_WF);
  }
  void Add(const FiducialReading& finder) { AddAll(finder.X_RS, finder.fiducials); }
  void Add(const BumperReading::Segment& segment) { AddAll(segment.X_RB, segment.pressed_by); }
  void Add(const BumperReading& bumper) { Add(bumper.segments); }
  void Add(const BodyContact& contact) {
    AddAll(contact.part, contact.other, contact.point, contact.z_min, contact.z_max);
  }
  void Add(const ContactReading& skin) { Add(skin.contacts); }
  void Add(const Blob& blob) { AddAll(blob.color, blob.left, blob.top, blob.right, blob.bottom, blob.range); }
  void Add(const BlobfinderReading& blobs) { Add(blobs.blobs); }
  void Add(const CameraReading& camera) { AddAll(camera.X_RS, camera.colors, camera.depths, camera.models); }
  void Add(const RadioReception::Place& place) { AddAll(place.range, place.bearing, place.elevation); }
  void Add(const RadioReception& reception) {
    AddAll(reception.from, reception.to_all, reception.bytes, reception.rssi, reception.tick, reception.place);
  }
  void Add(const RadioReading& radio) { Add(radio.receptions); }
  void Add(const ImuReading& imu) { AddAll(imu.heading, imu.turn, imu.force_xy, imu.force_z); }
  void Add(std::monostate) {}
  void Add(const SensorReading& reading) {
    AddAll(reading.tick, reading.content.index());
    std::visit([this](const auto& content) { Add(content); }, reading.content);
  }

  template <typename... Values>
  void AddAll(const Values&... values) {
    (Add(values), ...);
  }
  std::uint64_t value() const { return hasher_.value(); }

 private:
  Hasher hasher_;
};

class Feeling final : public Controller {
 public:
  explicit Feeling(const RobotInfo& info)
      : sensors_(info.sensors.size()), grippers_(info.grippers.size()), lights_(info.lights.size()) {
    for (std::size_t i = 0; i < sensors_; ++i) {
      if (std::holds_alternative<RadioParameters>(info.sensors[i].description->parameters)) radio_ = i;
      if (std::holds_alternative<CameraParameters>(info.sensors[i].description->parameters)) camera_ = i;
    }
  }

  std::vector<std::size_t> Subscriptions() const override {
    std::vector<std::size_t> all(sensors_);
    for (std::size_t i = 0; i < sensors_; ++i) all[i] = i;
    return all;
  }

  Command Update(const Observation& observation) override {
    Digest digest;
    digest.AddAll(memory_, observation.tick, observation.pose_estimate, observation.twist, observation.stalled,
                  observation.sensors, observation.joints, observation.grippers, observation.lights,
                  observation.energy);
    memory_ = digest.value();
    // Each byte decides one thing.
    const auto draw = [this](int i) { return static_cast<double>(memory_ >> (8 * i) & 0xff) / 255.0; };
    if (observation.tick % 10 == 0) twist_ = {0.8 * draw(1) - 0.4, 0.0, 2.0 * draw(0) - 1.0};
    Command command;
    command.twist = twist_;
    if (radio_ && draw(2) > 0.5) {
      command.messages.push_back({*radio_, {}, std::vector<std::uint8_t>(8, static_cast<std::uint8_t>(memory_))});
    }
    for (std::size_t i = 0; i < lights_; ++i) {
      if (draw(3) > 0.8) command.orders.push_back(LightOrder{i, draw(4) > 0.5});
    }
    for (std::size_t i = 0; i < grippers_; ++i) {
      if (draw(5) < 0.95) continue;
      command.grippers.push_back({i, draw(6) > 0.5 ? FingerCommand::kOpen : FingerCommand::kClose, 20.0 * draw(7)});
    }
    if (camera_ && draw(7) > 0.9) command.orders.push_back(CameraOrder{*camera_, 6.0 * draw(0) - 3.0, draw(1) - 0.5});
    if (draw(4) > 0.97) command.say = "I feel " + std::to_string(memory_);
    return command;
  }

 private:
  std::size_t sensors_;
  std::size_t grippers_;
  std::size_t lights_;
  std::optional<std::size_t> radio_;
  std::optional<std::size_t> camera_;
  std::uint64_t memory_ = 0;
  Twist twist_;
};

}  // namespace

TROUPE_CONTROLLER(Feeling)
