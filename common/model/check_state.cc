#include "common/model/check_state.h"

#include <cmath>

#include "troupe/radio_limits.h"

namespace troupe {
namespace {

Error StateError(std::string message) {
  return {.where = {}, .message = std::move(message)};
}

Status CheckCount(const char* kind, std::size_t found, std::size_t expected) {
  if (found == expected) return Status();
  return StateError("found a state of " + std::to_string(found) + " " + kind + ", expected " +
                    std::to_string(expected));
}

template <typename Id>
bool IsBelow(const std::optional<Id>& id, std::size_t count) {
  return !id || id->index() < count;
}

}  // namespace

DeviceCounts CountDevices(const WorldDescription& world) {
  return {.stores = FindStores(world).size(),
          .imus = FindImus(world).size(),
          .lights = FindLights(world).size(),
          .cameras = FindCameras(world).size()};
}

Status CheckState(const WorldDescription& world, const WorldState& state) {
  return CheckState(world, CountDevices(world), state);
}

Status CheckState(const WorldDescription& world, const DeviceCounts& devices, const WorldState& state) {
  for (const Status& problem : {CheckCount("robots", state.robots.size(), world.robots.size()),
                                CheckCount("joints", state.joints.size(), world.joints.size()),
                                CheckCount("grippers", state.grippers.size(), world.grippers.size()),
                                CheckCount("objects", state.objects.size(), world.objects.size()),
                                CheckCount("stores of energy", state.stores.size(), devices.stores),
                                CheckCount("inertial measurement units", state.imus.size(), devices.imus),
                                CheckCount("lights", state.lights.size(), devices.lights),
                                CheckCount("cameras", state.cameras.size(), devices.cameras)}) {
    if (!problem.ok()) return problem;
  }
  bool finite = true;
  bool known = true;
  for (const RobotState& robot : state.robots) finite = finite && IsFinite(robot.X_WR) && IsFinite(robot.twist);
  for (const JointState& joint : state.joints) {
    finite = finite && std::isfinite(joint.position) && std::isfinite(joint.velocity);
  }
  for (const GripperState& gripper : state.grippers) {
    known = known && IsBelow(gripper.left_contact, world.models.size()) &&
            IsBelow(gripper.right_contact, world.models.size()) && IsBelow(gripper.clamped, world.objects.size());
  }
  for (const ObjectState& object : state.objects) {
    finite = finite && IsFinite(object.X_WO) && std::isfinite(object.fall_speed);
    known = known && IsBelow(object.holder, world.grippers.size()) && IsBelow(object.support, world.models.size());
    if ((object.mode == ObjectMode::kHeld) != object.holder.has_value()) {
      return StateError("found an object that is held without a holder, or has a holder without being held");
    }
  }
  for (const StoreState& store : state.stores) {
    finite = finite && std::isfinite(store.joules) && std::isfinite(store.charge_watts);
  }
  for (const ImuState& imu : state.imus) {
    finite = finite && std::isfinite(imu.vx) && std::isfinite(imu.vy) && std::isfinite(imu.vz);
  }
  for (const CameraState& camera : state.cameras) {
    finite = finite && std::isfinite(camera.pan) && std::isfinite(camera.tilt);
  }
  for (const RadioTransmission& transmission : state.transmissions) {
    known = known && transmission.from.index() < world.robots.size() &&
            IsBelow(transmission.message.to, world.robots.size()) &&
            FindRadio(world.robot(transmission.from), transmission.message.radio) != nullptr;
    if (transmission.due < state.tick || transmission.sent > state.tick) {
      return StateError("found a radio message that is not on its way");
    }
  }
  if (!finite) return StateError("found a number that is not finite in a state");
  if (!known) return StateError("found an id in a state that the world does not have");
  return Status();
}

}  // namespace troupe
