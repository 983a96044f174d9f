#include "viewer/gateway/state_rows.h"

namespace troupe {
namespace {

template <typename Row>
void Note(const std::vector<Row>& before, const std::vector<Row>& now, std::uint64_t number, bool fresh,
          std::vector<std::uint64_t>& changed) {
  changed.resize(now.size(), number);
  for (std::size_t i = 0; i < now.size(); ++i) {
    if (fresh || i >= before.size() || !(before[i] == now[i])) changed[i] = number;
  }
}

void Write(ByteWriter& writer, const RobotState& robot) {
  writer.WritePose(robot.X_WR);
  writer.WriteFloat(robot.twist.vx);
  writer.WriteFloat(robot.twist.vy);
  writer.WriteFloat(robot.twist.wz);
  writer.WriteByte(robot.stalled);
}

void Write(ByteWriter& writer, const JointState& joint) {
  writer.Write(joint.position);
  writer.WriteByte(joint.blocked);
}

void Write(ByteWriter& writer, const GripperState& gripper) {
  writer.WriteId(gripper.clamped);
}

void Write(ByteWriter& writer, const ObjectState& object) {
  writer.WritePose(object.X_WO);
  writer.Write(static_cast<std::uint8_t>(object.mode));
  writer.WriteId(object.holder);
}

void Write(ByteWriter& writer, const StoreState& store) {
  writer.Write(store.joules);
  writer.Write(store.charge_watts);
}

void Write(ByteWriter& writer, const LightState& light) {
  writer.WriteByte(light.is_switched_on);
}

template <typename Row>
void WriteChanged(ByteWriter& writer, const std::vector<Row>& rows, const std::vector<std::uint64_t>& changed,
                  std::uint64_t since) {
  const std::size_t place = writer.ReserveCount();
  std::size_t count = 0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (changed[i] <= since) continue;
    writer.WriteCount(i);
    Write(writer, rows[i]);
    ++count;
  }
  writer.FillCount(place, count);
}

}  // namespace

void StateRows::Assign(const WorldState& state, std::uint64_t number, bool fresh) {
  Note(state_.robots, state.robots, number, fresh, robots_);
  Note(state_.joints, state.joints, number, fresh, joints_);
  Note(state_.grippers, state.grippers, number, fresh, grippers_);
  Note(state_.objects, state.objects, number, fresh, objects_);
  Note(state_.stores, state.stores, number, fresh, stores_);
  Note(state_.lights, state.lights, number, fresh, lights_);
  state_ = state;
}

void StateRows::Write(ByteWriter& writer, std::uint64_t since) const {
  WriteChanged(writer, state_.robots, robots_, since);
  WriteChanged(writer, state_.joints, joints_, since);
  WriteChanged(writer, state_.grippers, grippers_, since);
  WriteChanged(writer, state_.objects, objects_, since);
  WriteChanged(writer, state_.stores, stores_, since);
  WriteChanged(writer, state_.lights, lights_, since);
}

}  // namespace troupe
