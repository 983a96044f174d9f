#include "transport/dds/convert/convert.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "tests/support/values.h"
#include "tests/unit/transport/dds/convert/random_messages.h"

namespace troupe::dds {
namespace {

constexpr std::uint64_t kSeeds = 300;

// Through the wire type and back, where possible into a message that already has another content.
template <typename Message>
void ExpectRoundTrip(Message (test::RandomMessages::*make)()) {
  test::RandomMessages random(1);
  Message back = (random.*make)();
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    test::RandomMessages messages(seed);
    const Message message = (messages.*make)();
    WireArena arena;
    const auto wire = ToWire(message, arena);
    if constexpr (requires { FromWire(wire, back); }) {
      const Status failed = FromWire(wire, back);
      ASSERT_TRUE(failed.ok()) << "seed " << seed << ": " << failed.error().message;
    } else {
      back = test::ValueOf(FromWire(wire));
    }
    ASSERT_TRUE(back == message) << "seed " << seed;
  }
}

TEST(ConvertTest, ASessionKeepsEveryField) {
  ExpectRoundTrip(&test::RandomMessages::Session);
}
TEST(ConvertTest, AJoinKeepsEveryField) {
  ExpectRoundTrip(&test::RandomMessages::Join);
}
TEST(ConvertTest, AdmissionsKeepEveryField) {
  ExpectRoundTrip(&test::RandomMessages::Admissions);
}
TEST(ConvertTest, AFrameKeepsEveryField) {
  ExpectRoundTrip(&test::RandomMessages::Frame);
}
TEST(ConvertTest, AHistoryKeepsEveryField) {
  ExpectRoundTrip(&test::RandomMessages::History);
}
TEST(ConvertTest, AProposalKeepsEveryField) {
  ExpectRoundTrip(&test::RandomMessages::Proposal);
}
TEST(ConvertTest, AStatusKeepsEveryField) {
  ExpectRoundTrip(&test::RandomMessages::Status);
}

TEST(ConvertTest, AControlRequestKeepsEveryField) {
  ExpectRoundTrip(&test::RandomMessages::Request);
}
TEST(ConvertTest, AControlReplyKeepsEveryField) {
  ExpectRoundTrip(&test::RandomMessages::Reply);
}

TEST(ConvertTest, TheHashOfTheWorldSurvives) {
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    const SessionMessage session = test::RandomMessages(seed).Session();
    WireArena arena;
    ASSERT_EQ(Hash(session.world), Hash(test::ValueOf(FromWire(ToWire(session, arena))).world)) << "seed " << seed;
  }
}

FrameMessage SomeFrame() {
  FrameMessage frame;
  frame.state.robots.resize(3);
  frame.state.joints.resize(3);
  frame.state.grippers.resize(2);
  frame.state.objects.resize(2);
  frame.state.objects[1].mode = ObjectMode::kHeld;
  frame.state.objects[1].holder = GripperId(1);
  frame.events.resize(2);
  return frame;
}

struct BadFrame {
  const char* what;
  std::function<void(troupe_wire_Frame&)> spoil;
};

const BadFrame kBadFrames[] = {
    {"no column y", [](troupe_wire_Frame& f) { f.state.robots.y._length = 0; }},
    {"long column x", [](troupe_wire_Frame& f) { f.state.robots.x._length = 2; }},
    {"short column z", [](troupe_wire_Frame& f) { f.state.robots.z._length = 2; }},
    {"short column heading", [](troupe_wire_Frame& f) { f.state.robots.heading._length = 2; }},
    {"short column vx", [](troupe_wire_Frame& f) { f.state.robots.vx._length = 2; }},
    {"short column vy", [](troupe_wire_Frame& f) { f.state.robots.vy._length = 2; }},
    {"short column wz", [](troupe_wire_Frame& f) { f.state.robots.wz._length = 2; }},
    {"short column stalled", [](troupe_wire_Frame& f) { f.state.robots.stalled._length = 2; }},
    {"unknown flag", [](troupe_wire_Frame& f) { f.state.robots.stalled._buffer[1] = 2; }},
    {"short column joint_position", [](troupe_wire_Frame& f) { f.state.joints.position._length = 2; }},
    {"short column joint_velocity", [](troupe_wire_Frame& f) { f.state.joints.velocity._length = 2; }},
    {"short column blocked", [](troupe_wire_Frame& f) { f.state.joints.blocked._length = 2; }},
    {"unknown joint flag", [](troupe_wire_Frame& f) { f.state.joints.blocked._buffer[2] = 8; }},
    {"short column of left contacts", [](troupe_wire_Frame& f) { f.state.grippers.left_contact._length = 1; }},
    {"short column of right contacts", [](troupe_wire_Frame& f) { f.state.grippers.right_contact._length = 1; }},
    {"short column clamped", [](troupe_wire_Frame& f) { f.state.grippers.clamped._length = 0; }},
    {"contact with a negative model", [](troupe_wire_Frame& f) { f.state.grippers.left_contact._buffer[0] = -2; }},
    {"contact with another negative model",
     [](troupe_wire_Frame& f) { f.state.grippers.right_contact._buffer[1] = -2; }},
    {"clamped negative object", [](troupe_wire_Frame& f) { f.state.grippers.clamped._buffer[1] = -2; }},
    {"short column object_x", [](troupe_wire_Frame& f) { f.state.objects.x._length = 1; }},
    {"short column object_y", [](troupe_wire_Frame& f) { f.state.objects.y._length = 1; }},
    {"short column object_z", [](troupe_wire_Frame& f) { f.state.objects.z._length = 1; }},
    {"short column object_heading", [](troupe_wire_Frame& f) { f.state.objects.heading._length = 1; }},
    {"short column object_mode", [](troupe_wire_Frame& f) { f.state.objects.mode._length = 1; }},
    {"short column object_fall_speed", [](troupe_wire_Frame& f) { f.state.objects.fall_speed._length = 1; }},
    {"short column object_holder", [](troupe_wire_Frame& f) { f.state.objects.holder._length = 1; }},
    {"short column object_support", [](troupe_wire_Frame& f) { f.state.objects.support._length = 1; }},
    {"unknown object mode", [](troupe_wire_Frame& f) { f.state.objects.mode._buffer[0] = 5; }},
    {"supported by a negative model", [](troupe_wire_Frame& f) { f.state.objects.support._buffer[0] = -2; }},
    {"short column of objects of events", [](troupe_wire_Frame& f) { f.events.object._length = 1; }},
    {"event of a negative object", [](troupe_wire_Frame& f) { f.events.object._buffer[1] = -5; }},
    {"short column of robots of events", [](troupe_wire_Frame& f) { f.events.robot._length = 1; }},
    {"short column of others", [](troupe_wire_Frame& f) { f.events.other._length = 1; }},
    {"short column of details", [](troupe_wire_Frame& f) { f.events.detail._length = 1; }},
    {"event type", [](troupe_wire_Frame& f) { f.events.type._buffer[0] = 200; }},
    {"event of a robot that does not exist", [](troupe_wire_Frame& f) { f.events.robot._buffer[0] = 3; }},
    {"event of a negative robot", [](troupe_wire_Frame& f) { f.events.robot._buffer[0] = -2; }},
    {"event of a negative model", [](troupe_wire_Frame& f) { f.events.other._buffer[1] = -5; }},
    {"length without a buffer", [](troupe_wire_Frame& f) { f.state.robots.x._buffer = nullptr; }},
};

TEST(ConvertTest, MalformedFramesAreRefused) {
  {
    WireArena arena;
    FrameMessage message;
    const Status failed = FromWire(ToWire(SomeFrame(), arena), message);
    ASSERT_TRUE(failed.ok()) << failed.error().message;
  }
  for (const BadFrame& bad : kBadFrames) {
    WireArena arena;
    troupe_wire_Frame wire = ToWire(SomeFrame(), arena);
    bad.spoil(wire);
    FrameMessage message;
    EXPECT_FALSE(FromWire(wire, message).ok()) << bad.what;
  }
}

struct BadProposal {
  const char* what;
  std::function<void(troupe_wire_Proposal&)> spoil;
};

TEST(ConvertTest, MalformedProposalsAreRefused) {
  const BadProposal cases[] = {
      {"short column robot", [](troupe_wire_Proposal& p) { p.robot._length = 1; }},
      {"short column vx", [](troupe_wire_Proposal& p) { p.vx._length = 1; }},
      {"short column vy", [](troupe_wire_Proposal& p) { p.vy._length = 1; }},
      {"short column wz", [](troupe_wire_Proposal& p) { p.wz._length = 1; }},
      {"short column joints", [](troupe_wire_Proposal& p) { p.joints._length = 1; }},
      {"fewer joint velocities than counted", [](troupe_wire_Proposal& p) { p.joint_velocity._length = 2; }},
      {"more joint velocities than counted", [](troupe_wire_Proposal& p) { p.joints._buffer[1] = 1; }},
      {"joint counts beyond everything", [](troupe_wire_Proposal& p) { p.joints._buffer[0] = 0xffffffff; }},
      {"robots out of order", [](troupe_wire_Proposal& p) { std::swap(p.robot._buffer[0], p.robot._buffer[1]); }},
      {"a robot twice", [](troupe_wire_Proposal& p) { p.robot._buffer[1] = p.robot._buffer[0]; }},
  };
  ProposalMessage good;
  good.proposals = {{RobotId(1), {}, {0.5}}, {RobotId(2), {}, {0.25, -0.25}}};
  for (const BadProposal& bad : cases) {
    WireArena arena;
    troupe_wire_Proposal wire = ToWire(good, arena);
    bad.spoil(wire);
    ProposalMessage message;
    EXPECT_FALSE(FromWire(wire, message).ok()) << bad.what;
  }
}

// The step refuses it, with an event that names the robot.
TEST(ConvertTest, AProposalThatIsNotFinitePasses) {
  ProposalMessage message;
  message.proposals = {{RobotId(7), {std::nan(""), 0.0, 0.0}, {std::nan("")}}};
  WireArena arena;
  ProposalMessage back;
  ASSERT_TRUE(FromWire(ToWire(message, arena), back).ok());
  EXPECT_TRUE(std::isnan(back.proposals.at(0).twist.vx));
  EXPECT_TRUE(std::isnan(back.proposals.at(0).joint_velocities.at(0)));
}

SessionMessage SomeSession() {
  WorldDescription world;
  world.shapes.resize(1);
  world.shapes[0].blocks = {{{{0.0, 0.0}, {1.0, 0.0}, {1.0, 1.0}}, {0.0, 1.0}}};
  world.shapes[0].rectangles = {{0.0, 0.0, 1.0, 1.0}};
  world.models.resize(2);
  world.models[0].name = "robot";
  world.models[1].name = "robot.child";
  world.models[1].parent = ModelId(0);
  world.robots.resize(1);
  world.robots[0].name = "robot";
  world.robots[0].root = ModelId(0);
  world.robots[0].sensors.resize(1);
  world.robots[0].sensors[0].model = ModelId(0);
  for (const char* name : {"robot.lift", "robot.left", "robot.right", "box"}) {
    world.models.emplace_back().name = name;
    world.models.back().parent = ModelId(0);
  }
  for (std::size_t model : {2u, 3u, 4u}) {
    JointDescription& joint = world.joints.emplace_back();
    joint.name = world.models[model].name;
    joint.robot = RobotId(0);
    joint.model = ModelId(model);
  }
  for (ModelDescription& model : world.models) model.shape = ShapeId(0);
  world.models[3].parent = world.models[4].parent = ModelId(2);
  world.grippers.resize(1);
  GripperDescription& gripper = world.grippers[0];
  gripper = {.name = "lift",
             .robot = RobotId(0),
             .model = ModelId(2),
             .left = JointId(1),
             .right = JointId(2),
             .left_pad = ModelId(3),
             .right_pad = ModelId(4),
             .lift = JointId(0),
             .beams = {{}}};
  world.models[5].parent.reset();
  world.models[5].gripper_return = true;
  world.objects = {ModelId(5)};
  return {.world = std::move(world)};
}

// The same with a static model that has the area of a bitmap.
SessionMessage SessionWithArea() {
  WorldDescription world = SomeSession().world;
  Bitmap bitmap(70, 3);
  for (int x = 0; x < 70; ++x) bitmap.set_occupied(x, x % 3, true);
  Shape& shape = world.shapes.emplace_back();
  shape.rectangles_z = {0.0, 1.5};
  shape.area =
      PixelArea(std::make_shared<const DenseCover>(std::move(bitmap)), {.center = 35.0, .factor = 0.1},
                {.factor = 0.2, .second_center = 0.1, .second_factor = 0.9, .shift = 3.0}, {1.0, 2.0, 0.0, 0.5});
  ModelDescription& map = world.models.emplace_back();
  map.name = "map";
  map.shape = ShapeId(1);
  return {.world = std::move(world)};
}

TEST(ConvertTest, AnAreaReturnsWithItsPixels) {
  const SessionMessage session = SessionWithArea();
  WireArena arena;
  EXPECT_EQ(test::ValueOf(FromWire(ToWire(session, arena))).world, session.world);
}

TEST(ConvertTest, MalformedAreasAreRefused) {
  using Spoil = std::function<void(troupe_wire_World&, troupe_wire_PixelArea&)>;
  const std::pair<const char*, Spoil> cases[] = {
      {"no width", [](auto&, auto& a) { a.width = 0; }},
      {"no height", [](auto&, auto& a) { a.height = 0; }},
      {"more pixels than bits", [](auto&, auto& a) { a.width = 71 * 64; }},
      {"fewer pixels than bits", [](auto&, auto& a) { a.height = 2; }},
      {"a size that overflows", [](auto&, auto& a) { a.width = a.height = 0xffffffff; }},
      {"a side that is negative as an int", [](auto&, auto& a) { a.width = 0x80000000; }},
      {"no occupied pixel", [](auto&, auto& a) { std::fill_n(a.bits._buffer, a.bits._length, 0); }},
      {"a pixel without width", [](auto&, auto& a) { a.x.factor = 0.0; }},
      {"a place that is no number", [](auto&, auto& a) { a.y.shift = std::nan(""); }},
      {"a heading that is no number", [](auto&, auto& a) { a.lines_in_model.heading = std::nan(""); }},
      {"a place far away", [](auto&, auto& a) { a.lines_in_model.x = 1e9; }},
      {"two areas", [](auto& w, auto&) { w.shapes._buffer[1].areas._length = 2; }},
      {"a list as well", [](auto& w, auto&) { w.shapes._buffer[1].rectangles = w.shapes._buffer[0].rectangles; }},
      {"an area of a robot", [](auto& w, auto&) { w.models._buffer[0].shape = 1; }},
      {"an area of a part of an object", [](auto& w, auto&) { w.models._buffer[6].parent = 5; }},
  };
  for (const auto& [what, spoil] : cases) {
    WireArena arena;
    const SessionMessage good = SessionWithArea();
    troupe_wire_Session wire = ToWire(good, arena);
    spoil(wire.world, wire.world.shapes._buffer[1].areas._buffer[0]);
    EXPECT_FALSE(FromWire(wire).ok()) << what;
  }
}

struct BadSession {
  const char* what;
  std::function<void(troupe_wire_Session&)> spoil;
};

TEST(ConvertTest, MalformedSessionsAreRefused) {
  {
    WireArena arena;
    test::ValueOf(FromWire(ToWire(SomeSession(), arena)));
  }
  const BadSession cases[] = {
      {"negative lease", [](troupe_wire_Session& s) { s.lease = -1.0; }},
      {"lease not a number", [](troupe_wire_Session& s) { s.lease = std::nan(""); }},
      {"no tick length", [](troupe_wire_Session& s) { s.world.interval = 0; }},
      {"odd outline", [](troupe_wire_Session& s) { s.world.shapes._buffer[0].blocks._buffer[0].outline._length = 5; }},
      {"outline of two points",
       [](troupe_wire_Session& s) { s.world.shapes._buffer[0].blocks._buffer[0].outline._length = 4; }},
      {"outline that is no number",
       [](troupe_wire_Session& s) { s.world.shapes._buffer[0].blocks._buffer[0].outline._buffer[3] = std::nan(""); }},
      {"rectangle of three numbers", [](troupe_wire_Session& s) { s.world.shapes._buffer[0].rectangles._length = 3; }},
      {"parent after child", [](troupe_wire_Session& s) { s.world.models._buffer[1].parent = 1; }},
      {"parent that does not exist", [](troupe_wire_Session& s) { s.world.models._buffer[1].parent = 4711; }},
      {"parent below none", [](troupe_wire_Session& s) { s.world.models._buffer[1].parent = -7; }},
      {"shape that does not exist", [](troupe_wire_Session& s) { s.world.models._buffer[0].shape = 1; }},
      {"size not a number", [](troupe_wire_Session& s) { s.world.models._buffer[0].size_x = std::nan(""); }},
      {"root that does not exist", [](troupe_wire_Session& s) { s.world.robots._buffer[0].root = 2; }},
      {"root that is a child", [](troupe_wire_Session& s) { s.world.robots._buffer[0].root = 1; }},
      {"ranger of no model", [](troupe_wire_Session& s) { s.world.robots._buffer[0].sensors._buffer[0].model = 9; }},
      {"drive type", [](troupe_wire_Session& s) { s.world.robots._buffer[0].drive.type = 3; }},
      {"joint type", [](troupe_wire_Session& s) { s.world.joints._buffer[0].type = 2; }},
      {"joint of no robot", [](troupe_wire_Session& s) { s.world.joints._buffer[0].robot = 1; }},
      {"joint of no model", [](troupe_wire_Session& s) { s.world.joints._buffer[0].model = 99; }},
      {"joint without an axis", [](troupe_wire_Session& s) { s.world.joints._buffer[0].axis_z = 0.0; }},
      {"joint that starts out of its limits", [](troupe_wire_Session& s) { s.world.joints._buffer[0].start = 7.0; }},
      {"joint limits upside down", [](troupe_wire_Session& s) { s.world.joints._buffer[0].position_min = 7.0; }},
      {"joint speed", [](troupe_wire_Session& s) { s.world.joints._buffer[0].max_speed = std::nan(""); }},
      {"gripper of no robot", [](troupe_wire_Session& s) { s.world.grippers._buffer[0].robot = 1; }},
      {"gripper of no model", [](troupe_wire_Session& s) { s.world.grippers._buffer[0].model = 99; }},
      {"finger that does not exist", [](troupe_wire_Session& s) { s.world.grippers._buffer[0].left = 3; }},
      {"lift that does not exist", [](troupe_wire_Session& s) { s.world.grippers._buffer[0].lift = 3; }},
      {"negative lift", [](troupe_wire_Session& s) { s.world.grippers._buffer[0].lift = -2; }},
      {"pad that does not exist", [](troupe_wire_Session& s) { s.world.grippers._buffer[0].right_pad = 99; }},
      {"beam that is no number",
       [](troupe_wire_Session& s) { s.world.grippers._buffer[0].beams._buffer[0].to_x = std::nan(""); }},
      {"object that does not exist", [](troupe_wire_Session& s) { s.world.objects._buffer[0] = 99; }},
      {"object that is a robot", [](troupe_wire_Session& s) { s.world.objects._buffer[0] = 0; }},
      {"gravity upwards", [](troupe_wire_Session& s) { s.world.gravity = -1.0; }},
      {"localization type", [](troupe_wire_Session& s) { s.world.robots._buffer[0].localization.type = 2; }},
  };
  for (const BadSession& bad : cases) {
    WireArena arena;
    const SessionMessage good = SomeSession();
    troupe_wire_Session wire = ToWire(good, arena);
    bad.spoil(wire);
    EXPECT_FALSE(FromWire(wire).ok()) << bad.what;
  }
}

TEST(ConvertTest, MissingTextsAreEmpty) {
  const troupe_wire_Join wire{};
  EXPECT_EQ("", test::ValueOf(FromWire(wire)).host);
}

}  // namespace
}  // namespace troupe::dds
