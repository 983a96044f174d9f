#include "common/dds/convert.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "tests/unit/dds/random_messages.h"

namespace troupe::dds {
namespace {

constexpr std::uint64_t kSeeds = 300;

// Through the wire type and back, into a message that already holds something else.
template <typename Message>
void ExpectRoundTrip(Message (test::RandomMessages::*make)()) {
  test::RandomMessages random(1);
  Message back = (random.*make)();
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    test::RandomMessages messages(seed);
    const Message message = (messages.*make)();
    WireArena arena;
    const auto wire = ToWire(message, arena);
    const Status failed = FromWire(wire, back);
    ASSERT_FALSE(failed) << "seed " << seed << ": " << failed->message;
    ASSERT_TRUE(back == message) << "seed " << seed;
  }
}

TEST(ConvertTest, ASessionKeepsEveryField) {
  ExpectRoundTrip(&test::RandomMessages::Session);
}
TEST(ConvertTest, AJoinKeepsEveryField) {
  ExpectRoundTrip(&test::RandomMessages::Join);
}
TEST(ConvertTest, AnAdmissionKeepsEveryField) {
  ExpectRoundTrip(&test::RandomMessages::Admission);
}
TEST(ConvertTest, AFrameKeepsEveryField) {
  ExpectRoundTrip(&test::RandomMessages::Frame);
}
TEST(ConvertTest, AProposalKeepsEveryField) {
  ExpectRoundTrip(&test::RandomMessages::Proposal);
}
TEST(ConvertTest, AStatusKeepsEveryField) {
  ExpectRoundTrip(&test::RandomMessages::Status);
}

TEST(ConvertTest, TheHashOfTheWorldSurvives) {
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    const SessionMessage session = test::RandomMessages(seed).Session();
    WireArena arena;
    SessionMessage back;
    ASSERT_FALSE(FromWire(ToWire(session, arena), back));
    ASSERT_EQ(Hash(session.world), Hash(back.world)) << "seed " << seed;
  }
}

FrameMessage SomeFrame() {
  FrameMessage frame;
  frame.state.robots.resize(3);
  frame.events.resize(2);
  return frame;
}

struct BadFrame {
  const char* what;
  std::function<void(troupe_wire_Frame&)> spoil;
};

TEST(ConvertTest, MalformedFramesAreRefused) {
  const double nan = std::nan("");
  const BadFrame cases[] = {
      {"no column y", [](troupe_wire_Frame& f) { f.y._length = 0; }},
      {"long column x", [](troupe_wire_Frame& f) { f.x._length = 2; }},
      {"short column z", [](troupe_wire_Frame& f) { f.z._length = 2; }},
      {"short column heading", [](troupe_wire_Frame& f) { f.heading._length = 2; }},
      {"short column vx", [](troupe_wire_Frame& f) { f.vx._length = 2; }},
      {"short column vy", [](troupe_wire_Frame& f) { f.vy._length = 2; }},
      {"short column wz", [](troupe_wire_Frame& f) { f.wz._length = 2; }},
      {"short column flags", [](troupe_wire_Frame& f) { f.flags._length = 2; }},
      {"unknown flag", [](troupe_wire_Frame& f) { f.flags._buffer[1] = 2; }},
      {"x not a number", [=](troupe_wire_Frame& f) { f.x._buffer[2] = nan; }},
      {"heading infinite",
       [](troupe_wire_Frame& f) { f.heading._buffer[0] = std::numeric_limits<double>::infinity(); }},
      {"speed not a number", [=](troupe_wire_Frame& f) { f.wz._buffer[2] = nan; }},
      {"short column of robots of events", [](troupe_wire_Frame& f) { f.event_robot._length = 1; }},
      {"short column of others", [](troupe_wire_Frame& f) { f.event_other._length = 1; }},
      {"short column of details", [](troupe_wire_Frame& f) { f.event_detail._length = 1; }},
      {"event type", [](troupe_wire_Frame& f) { f.event_type._buffer[0] = 200; }},
      {"event of a robot that does not exist", [](troupe_wire_Frame& f) { f.event_robot._buffer[0] = 3; }},
      {"event of a negative robot", [](troupe_wire_Frame& f) { f.event_robot._buffer[0] = -2; }},
      {"event of a negative model", [](troupe_wire_Frame& f) { f.event_other._buffer[1] = -5; }},
      {"length without a buffer", [](troupe_wire_Frame& f) { f.x._buffer = nullptr; }},
  };
  for (const BadFrame& bad : cases) {
    WireArena arena;
    troupe_wire_Frame wire = ToWire(SomeFrame(), arena);
    bad.spoil(wire);
    FrameMessage message;
    EXPECT_TRUE(FromWire(wire, message)) << bad.what;
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
      {"robots out of order", [](troupe_wire_Proposal& p) { std::swap(p.robot._buffer[0], p.robot._buffer[1]); }},
      {"a robot twice", [](troupe_wire_Proposal& p) { p.robot._buffer[1] = p.robot._buffer[0]; }},
  };
  ProposalMessage good;
  good.proposals = {{RobotId(1), {}}, {RobotId(2), {}}};
  for (const BadProposal& bad : cases) {
    WireArena arena;
    troupe_wire_Proposal wire = ToWire(good, arena);
    bad.spoil(wire);
    ProposalMessage message;
    EXPECT_TRUE(FromWire(wire, message)) << bad.what;
  }
}

// The step refuses it, with an event that names the robot.
TEST(ConvertTest, AProposalThatIsNotFinitePasses) {
  ProposalMessage message;
  message.proposals = {{RobotId(7), {std::nan(""), 0.0, 0.0}}};
  WireArena arena;
  ProposalMessage back;
  ASSERT_FALSE(FromWire(ToWire(message, arena), back));
  EXPECT_TRUE(std::isnan(back.proposals.at(0).twist.vx));
}

SessionMessage SomeSession() {
  SessionMessage session;
  session.world.shapes.resize(1);
  session.world.shapes[0].blocks = {{{{0.0, 0.0}, {1.0, 0.0}, {1.0, 1.0}}, {0.0, 1.0}}};
  Normalize(session.world.shapes[0].blocks[0].outline);
  session.world.shapes[0].rectangles = {{0.0, 0.0, 1.0, 1.0}};
  session.world.models.resize(2);
  session.world.models[0].name = "robot";
  session.world.models[1].name = "robot.child";
  session.world.models[1].parent = ModelId(0);
  session.world.robots.resize(1);
  session.world.robots[0].name = "robot";
  session.world.robots[0].rangers.resize(1);
  return session;
}

struct BadSession {
  const char* what;
  std::function<void(troupe_wire_Session&)> spoil;
};

TEST(ConvertTest, MalformedSessionsAreRefused) {
  {
    WireArena arena;
    SessionMessage message;
    const Status failed = FromWire(ToWire(SomeSession(), arena), message);
    ASSERT_FALSE(failed) << failed->message;
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
      {"ranger of no model", [](troupe_wire_Session& s) { s.world.robots._buffer[0].rangers._buffer[0].model = 9; }},
      {"drive type", [](troupe_wire_Session& s) { s.world.robots._buffer[0].drive.type = 3; }},
      {"localization type", [](troupe_wire_Session& s) { s.world.robots._buffer[0].localization.type = 2; }},
  };
  for (const BadSession& bad : cases) {
    WireArena arena;
    const SessionMessage good = SomeSession();
    troupe_wire_Session wire = ToWire(good, arena);
    bad.spoil(wire);
    SessionMessage message;
    EXPECT_TRUE(FromWire(wire, message)) << bad.what;
  }
}

TEST(ConvertTest, MissingTextsAreEmpty) {
  const troupe_wire_Admission wire{};
  AdmissionMessage message;
  message.reason = "from before";
  EXPECT_FALSE(FromWire(wire, message));
  EXPECT_EQ("", message.reason);
}

}  // namespace
}  // namespace troupe::dds
