// Frames with the changes since the frame before.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <optional>
#include <random>

#include "common/model/states.h"
#include "transport/dds/convert/convert.h"

namespace troupe::dds {
namespace {

FrameMessage FirstFrame() {
  FrameMessage frame{.run = 7, .edition = 2};
  frame.state.tick = 10;
  frame.state.robots.resize(5);
  frame.state.joints.resize(4);
  frame.state.grippers.resize(2);
  frame.state.objects.resize(6);
  frame.state.stores.resize(3);
  frame.state.imus.resize(2);
  frame.state.lights.resize(3);
  frame.state.cameras.resize(2);
  frame.state.people.resize(2);
  return frame;
}

FrameMessage Next(const FrameMessage& frame) {
  FrameMessage next = frame;
  ++next.state.tick;
  return next;
}

class Changes {
 public:
  explicit Changes(std::uint64_t seed) : engine_(seed) {}

  // Changes some values of each kind, and often none of one kind.
  void Make(WorldState& state) {
    for (RobotState& robot : state.robots) {
      for (double* number : {&robot.X_WR.x, &robot.X_WR.y, &robot.X_WR.z, &robot.X_WR.heading, &robot.twist.vx,
                             &robot.twist.vy, &robot.twist.wz}) {
        Change(*number);
      }
      if (Chance(0.1)) robot.stalled = !robot.stalled;
    }
    for (JointState& joint : state.joints) {
      Change(joint.position);
      Change(joint.velocity);
      if (Chance(0.1)) joint.blocked = !joint.blocked;
    }
    for (GripperState& gripper : state.grippers) {
      Change(gripper.left_contact, 100);
      Change(gripper.right_contact, 100);
      Change(gripper.clamped, state.objects.size());
    }
    for (ObjectState& object : state.objects) {
      for (double* number :
           {&object.X_WO.x, &object.X_WO.y, &object.X_WO.z, &object.X_WO.heading, &object.fall_speed}) {
        Change(*number);
      }
      Change(object.support, 100);
      if (!Chance(0.1)) continue;
      object.mode = static_cast<ObjectMode>(Below(4));
      object.holder.reset();
      if (object.mode == ObjectMode::kHeld) object.holder = GripperId(Below(state.grippers.size()));
    }
    for (StoreState& store : state.stores) {
      Change(store.joules);
      Change(store.charge_watts);
    }
    for (LightState& light : state.lights) {
      if (Chance(0.1)) light.is_switched_on = !light.is_switched_on;
    }
    for (CameraState& camera : state.cameras) {
      Change(camera.pan);
      Change(camera.tilt);
    }
    for (DoorState& door : state.doors) {
      Change(door.opening);
      Change(door.target);
      if (Chance(0.1)) door.blocked = !door.blocked;
    }
    for (LiftState& lift : state.lifts) {
      Change(lift.z);
      Change(lift.session, state.robots.size());
      if (Chance(0.1)) lift.floor = static_cast<std::uint32_t>(Below(9));
    }
    for (PersonState& person : state.people) {
      for (double* number : {&person.X_WP.x, &person.X_WP.heading, &person.vx, &person.vy}) Change(*number);
      if (Chance(0.1)) ++person.goals_chosen;
    }
    for (ImuState& imu : state.imus) {
      for (double* number : {&imu.vx, &imu.vy, &imu.vz}) Change(*number);
    }
    state.transmissions.resize(Chance(0.5) ? 0 : Below(4));
    for (RadioTransmission& transmission : state.transmissions) {
      transmission.from = RobotId(Below(state.robots.size()));
      transmission.due = state.tick + Below(3);
      transmission.message.bytes.assign(Below(9), 7);
    }
    state.traffic_robots.resize(Below(4));
    for (TrafficRobot& robot : state.traffic_robots) {
      robot.robot = RobotId(Below(state.robots.size()));
      robot.finished = static_cast<std::uint32_t>(Below(9));
    }
    state.traffic_moves.resize(Below(4));
    for (TrafficMove& move : state.traffic_moves) move.robot = RobotId(Below(state.robots.size()));
    state.lane_closures.assign(Below(3), {1, 9, 3});
    state.lane_rules.assign(Below(3), {2, 0.5});
    state.charging_robots.resize(Below(4));
    for (ChargingRobot& robot : state.charging_robots) robot.robot = RobotId(Below(state.robots.size()));
    state.jobs.assign(Below(3), {.flow = 1, .number = 2, .since = 3, .due = 4});
    for (CoverageState& row : state.coverage) row.cells |= Chance(0.2) ? 1U << Below(32) : 0U;
    state.waits.assign(Below(3), {RobotId(Below(state.robots.size())), 2, ModelId(3), 4});
  }

 private:
  std::size_t Below(std::size_t count) { return engine_() % count; }
  bool Chance(double probability) { return std::uniform_real_distribution<double>(0.0, 1.0)(engine_) < probability; }
  void Change(double& number) {
    if (Chance(0.8)) return;
    number = Chance(0.3) ? -number : std::uniform_real_distribution<double>(-9.0, 9.0)(engine_);  // -0.0 from 0.0
  }
  template <typename Id>
  void Change(std::optional<Id>& id, std::size_t count) {
    if (Chance(0.9)) return;
    id.reset();
    if (Chance(0.7)) id = Id(Below(count));
  }

  std::mt19937_64 engine_;
};

TEST(FrameChangesTest, BringTheFrameBeforeUpToTheSameBits) {
  Changes changes(1);
  FrameMessage frame = FirstFrame();
  FrameMessage received;
  {
    WireArena arena;
    ASSERT_TRUE(FromWire(ToWire(frame, arena), received).ok());
  }
  for (int tick = 0; tick < 2000; ++tick) {
    FrameMessage next = Next(frame);
    if (tick % 3 != 0) changes.Make(next.state);
    WireArena arena;
    const troupe_wire_Frame wire = ToWire(next, &frame.state, arena);
    ASSERT_TRUE(CanRead(wire, received));
    const Status problem = FromWire(wire, received);
    ASSERT_TRUE(problem.ok()) << problem.error().message;
    ASSERT_EQ(received, next) << "tick " << tick;
    ASSERT_EQ(StateHash(received.state), StateHash(next.state)) << "tick " << tick;
    frame = next;
  }
}

TEST(FrameChangesTest, RowsWithoutChangesDoNotTravel) {
  const FrameMessage frame = FirstFrame();
  WireArena arena;
  const troupe_wire_Frame wire = ToWire(Next(frame), &frame.state, arena);
  EXPECT_FALSE(wire.whole);
  EXPECT_EQ(wire.state.robots.row._length, 0u);
  EXPECT_EQ(wire.state.robots.x._length, 0u);
  EXPECT_EQ(wire.state.joints.position._length, 0u);
  EXPECT_EQ(wire.state.grippers.clamped._length, 0u);
  EXPECT_EQ(wire.state.objects.x._length, 0u);
  EXPECT_EQ(wire.state.objects.mode._length, 0u);
}

TEST(FrameChangesTest, OnlyTheRowsAndColumnsThatChangedTravel) {
  const FrameMessage frame = FirstFrame();
  FrameMessage next = Next(frame);
  next.state.robots[3].X_WR.x = 1.5;
  next.state.robots[1].X_WR.heading = -0.0;
  WireArena arena;
  const troupe_wire_Frame wire = ToWire(next, &frame.state, arena);
  ASSERT_EQ(wire.state.robots.row._length, 2u);
  EXPECT_EQ(wire.state.robots.row._buffer[0], 1u);
  EXPECT_EQ(wire.state.robots.row._buffer[1], 3u);
  ASSERT_EQ(wire.state.robots.x._length, 2u);
  EXPECT_EQ(wire.state.robots.x._buffer[1], 1.5);
  ASSERT_EQ(wire.state.robots.heading._length, 2u);
  EXPECT_TRUE(std::signbit(wire.state.robots.heading._buffer[0]));
  EXPECT_EQ(wire.state.robots.y._length, 0u);
  EXPECT_EQ(wire.state.robots.vx._length, 0u);
  EXPECT_EQ(wire.state.robots.stalled._length, 0u);
}

TEST(FrameChangesTest, RowsAreNotNumberedWhereAllChanged) {
  const FrameMessage frame = FirstFrame();
  FrameMessage next = Next(frame);
  for (RobotState& robot : next.state.robots) robot.twist.vx = 0.25;
  WireArena arena;
  const troupe_wire_Frame wire = ToWire(next, &frame.state, arena);
  EXPECT_EQ(wire.state.robots.row._length, 0u);
  EXPECT_EQ(wire.state.robots.vx._length, 5u);
  EXPECT_EQ(wire.state.robots.x._length, 0u);
}

TEST(FrameChangesTest, AreAppliedOnlyToTheFrameBefore) {
  const FrameMessage frame = FirstFrame();
  const FrameMessage next = Next(frame);
  WireArena arena;
  const troupe_wire_Frame changes = ToWire(next, &frame.state, arena);
  EXPECT_TRUE(CanRead(changes, frame));
  EXPECT_FALSE(CanRead(changes, next));
  EXPECT_FALSE(CanRead(changes, Next(next)));
  EXPECT_FALSE(CanRead(changes, FrameMessage{}));
  FrameMessage other = frame;
  other.run = 8;
  EXPECT_FALSE(CanRead(changes, other));
  other = frame;
  other.edition = 3;
  EXPECT_FALSE(CanRead(changes, other));
  const troupe_wire_Frame whole = ToWire(next, arena);
  EXPECT_TRUE(CanRead(whole, other));
  EXPECT_TRUE(CanRead(whole, FrameMessage{}));
}

struct BadChanges {
  const char* what;
  std::function<void(troupe_wire_Frame&)> spoil;
};

TEST(FrameChangesTest, MalformedOnesAreRefusedAndSoAreChangesSinceThem) {
  const FrameMessage frame = FirstFrame();
  FrameMessage next = Next(frame);
  next.state.robots[1].X_WR.x = 2.0;
  next.state.robots[4].X_WR.y = 2.0;
  next.state.objects[2].mode = ObjectMode::kHeld;
  next.state.objects[2].holder = GripperId(1);
  next.state.joints[0].position = 0.5;
  const BadChanges cases[] = {
      {"a robot that does not exist", [](troupe_wire_Frame& f) { f.state.robots.row._buffer[1] = 5; }},
      {"an object that does not exist", [](troupe_wire_Frame& f) { f.state.objects.row._buffer[0] = 6; }},
      {"more rows than values", [](troupe_wire_Frame& f) { f.state.robots.x._length = 1; }},
      {"values without rows", [](troupe_wire_Frame& f) { f.state.robots.row._length = 0; }},
      {"an unknown mode", [](troupe_wire_Frame& f) { f.state.objects.mode._buffer[0] = 5; }},
      {"whole, with numbered rows", [](troupe_wire_Frame& f) { f.whole = true; }},
  };
  for (const BadChanges& bad : cases) {
    WireArena arena;
    troupe_wire_Frame wire = ToWire(next, &frame.state, arena);
    bad.spoil(wire);
    FrameMessage message = frame;
    EXPECT_FALSE(FromWire(wire, message).ok()) << bad.what;
    EXPECT_FALSE(CanRead(ToWire(Next(next), &next.state, arena), message)) << bad.what;
  }
}

}  // namespace
}  // namespace troupe::dds
