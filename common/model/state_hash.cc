#include "common/model/state_hash.h"

#include <string_view>

#include "common/base/hash.h"

namespace troupe {

std::uint64_t StateHash(const WorldState& state) {
  Hasher hasher;
  hasher.Add(state.tick);
  for (const RobotState& robot : state.robots) {
    hasher.Add(robot.X_WR.x);
    hasher.Add(robot.X_WR.y);
    hasher.Add(robot.X_WR.z);
    hasher.Add(robot.X_WR.heading);
    hasher.Add(robot.twist.vx);
    hasher.Add(robot.twist.vy);
    hasher.Add(robot.twist.wz);
    hasher.Add(std::uint64_t{robot.stalled});
  }
  for (const JointState& joint : state.joints) {
    hasher.Add(joint.position);
    hasher.Add(joint.velocity);
    hasher.Add(std::uint64_t{joint.blocked});
  }
  const auto add_id = [&](const auto& id) { hasher.Add(std::uint64_t{id ? id->index() + 1 : 0}); };
  for (const GripperState& gripper : state.grippers) {
    add_id(gripper.left_contact);
    add_id(gripper.right_contact);
    add_id(gripper.clamped);
  }
  for (const ObjectState& object : state.objects) {
    hasher.Add(object.X_WO.x);
    hasher.Add(object.X_WO.y);
    hasher.Add(object.X_WO.z);
    hasher.Add(object.X_WO.heading);
    // At tick 0 the poses determine the supports: a state has the same hash before and after they are found.
    const bool implied = state.tick == 0 && object.mode == ObjectMode::kResting;
    hasher.Add(static_cast<std::uint64_t>(implied ? ObjectMode::kPlaced : object.mode));
    hasher.Add(object.fall_speed);
    add_id(object.holder);
    add_id(implied ? std::nullopt : object.support);
  }
  // Only where there are any, so that worlds without energy, radios, IMUs, cameras and lights on robots keep their
  // hashes.
  for (const StoreState& store : state.stores) {
    hasher.Add(store.joules);
    hasher.Add(store.charge_watts);
  }
  for (const ImuState& imu : state.imus) {
    hasher.Add(imu.vx);
    hasher.Add(imu.vy);
    hasher.Add(imu.vz);
  }
  for (const LightState& light : state.lights) hasher.Add(std::uint64_t{light.is_switched_on});
  for (const CameraState& camera : state.cameras) {
    hasher.Add(camera.pan);
    hasher.Add(camera.tilt);
  }
  for (const RadioTransmission& transmission : state.transmissions) {
    hasher.Add(std::uint64_t{transmission.from.index()});
    hasher.Add(transmission.sent);
    hasher.Add(transmission.due);
    hasher.Add(std::uint64_t{transmission.number});
    hasher.Add(std::uint64_t{transmission.message.radio});
    add_id(transmission.message.to);
    const std::vector<std::uint8_t>& bytes = transmission.message.bytes;
    hasher.Add(std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
  }
  return hasher.value();
}

}  // namespace troupe
