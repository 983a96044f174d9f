#include "transport/wire/message_bytes.h"

#include <dds/ddsi/ddsi_serdata.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "common/base/hash.h"
#include "tests/support/dds_domain.h"
#include "tests/support/values.h"
#include "tests/unit/transport/dds/convert/random_messages.h"
#include "transport/dds/binding/data_reader.h"
#include "transport/dds/binding/data_writer.h"
#include "transport/dds/convert/convert.h"
#include "transport/dds/transport/qos_profiles.h"
#include "transport/wire/cdr.h"

namespace troupe::wire {
namespace {

using Bytes = std::vector<std::byte>;

FrameRequest RandomMessage(test::RandomMessages&, std::uint64_t seed, FrameRequest) {
  return {seed * 0x9e3779b97f4a7c15};
}

ControlRequest RandomMessage(test::RandomMessages& random, std::uint64_t, ControlRequest) {
  return random.Request();
}
ControlReply RandomMessage(test::RandomMessages& random, std::uint64_t, ControlReply) {
  return random.Reply();
}
SessionMessage RandomMessage(test::RandomMessages& random, std::uint64_t, SessionMessage) {
  return random.Session();
}
JoinMessage RandomMessage(test::RandomMessages& random, std::uint64_t, JoinMessage) {
  return random.Join();
}
std::vector<AdmissionMessage> RandomMessage(test::RandomMessages& random, std::uint64_t,
                                            std::vector<AdmissionMessage>) {
  return random.Admissions();
}
FrameMessage RandomMessage(test::RandomMessages& random, std::uint64_t, FrameMessage) {
  return random.Frame();
}
HistoryMessage RandomMessage(test::RandomMessages& random, std::uint64_t, HistoryMessage) {
  return random.History();
}
ProposalMessage RandomMessage(test::RandomMessages& random, std::uint64_t, ProposalMessage) {
  return random.Proposal();
}
StatusMessage RandomMessage(test::RandomMessages& random, std::uint64_t, StatusMessage) {
  return random.Status();
}

template <typename Message>
Message RandomMessage(std::uint64_t seed) {
  test::RandomMessages random(seed);
  return RandomMessage(random, seed, Message());
}

template <typename Message>
class MessageBytesTest : public testing::Test {};

using Messages = testing::Types<SessionMessage, JoinMessage, std::vector<AdmissionMessage>, FrameMessage, FrameRequest,
                                HistoryMessage, ProposalMessage, ControlRequest, ControlReply, StatusMessage>;
TYPED_TEST_SUITE(MessageBytesTest, Messages);

TYPED_TEST(MessageBytesTest, EveryFieldSurvives) {
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    const auto message = RandomMessage<TypeParam>(seed);
    ASSERT_TRUE(test::ValueOf(FromBytes<TypeParam>(ToBytes(message))) == message) << "seed " << seed;
  }
}

TYPED_TEST(MessageBytesTest, TheyStartWithTheHeaderOfLittleEndianCdr) {
  const Bytes bytes = ToBytes(RandomMessage<TypeParam>(1));
  EXPECT_EQ(bytes.at(0), std::byte{0});
  EXPECT_EQ(bytes.at(1), std::byte{1});
  EXPECT_EQ(bytes.size() % 4, 0u);
}

TYPED_TEST(MessageBytesTest, ATruncatedSampleIsRefused) {
  for (std::uint64_t seed = 0; seed < 3; ++seed) {
    const Bytes bytes = ToBytes(RandomMessage<TypeParam>(seed));
    const auto padding = std::to_integer<std::size_t>(bytes[3]);
    const std::size_t step = std::max<std::size_t>(1, bytes.size() / 500);
    for (std::size_t size = 0; size < bytes.size(); size += step) {
      Bytes cut(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size));
      if (cut.size() > 3) cut[3] = std::byte{0};
      if (size >= bytes.size() - padding) continue;  // still whole
      EXPECT_FALSE(FromBytes<TypeParam>(cut).ok()) << size << " of " << bytes.size();
    }
    Bytes longer = bytes;
    longer.resize(bytes.size() + 4);
    EXPECT_FALSE(FromBytes<TypeParam>(longer).ok());
  }
}

// They may happen to be a message, but are never read beyond their end, which sanitizers would report.
TYPED_TEST(MessageBytesTest, SpoiledBytesAreSafe) {
  std::mt19937_64 engine(7);
  for (int round = 0; round < 2000; ++round) {
    Bytes bytes = ToBytes(RandomMessage<TypeParam>(engine() % 20));
    for (std::uint64_t count = 1 + engine() % 4; count > 0; --count) {
      bytes[engine() % bytes.size()] = static_cast<std::byte>(engine());
    }
    (void)FromBytes<TypeParam>(bytes).ok();
  }
}

TYPED_TEST(MessageBytesTest, RandomBytesAreSafe) {
  std::mt19937_64 engine(8);
  for (int round = 0; round < 2000; ++round) {
    Bytes bytes(4 + engine() % 400);
    const bool small_numbers = engine() % 2 == 0;  // which are plausible lengths
    for (std::byte& byte : bytes) byte = static_cast<std::byte>(small_numbers && engine() % 4 != 0 ? 0 : engine());
    bytes[0] = std::byte{0};
    bytes[1] = static_cast<std::byte>(engine() % 2);
    (void)FromBytes<TypeParam>(bytes).ok();
  }
}

TEST(WireBytesTest, AnotherRepresentationIsRefused) {
  for (const int second : {2, 3, 6, 7, 0x10}) {
    Bytes bytes = ToBytes(RandomMessage<JoinMessage>(1));
    bytes[1] = static_cast<std::byte>(second);
    EXPECT_FALSE(FromBytes<JoinMessage>(bytes).ok()) << second;
  }
}

TEST(WireBytesTest, BigEndianBytesAreRead) {
  const Bytes bytes = {std::byte{0}, std::byte{0}, std::byte{0}, std::byte{0},  // header
                       std::byte{0}, std::byte{0}, std::byte{0}, std::byte{0},
                       std::byte{0}, std::byte{0}, std::byte{1}, std::byte{2}};
  EXPECT_EQ(test::ValueOf(FromBytes<FrameRequest>(bytes)).observer, 0x102u);
}

TEST(WireBytesTest, AFrameOfChangesIsRefused) {
  FrameMessage frame = RandomMessage<FrameMessage>(3);
  frame.run = 0;
  frame.edition = 0;
  frame.state.tick = 1;
  dds::WireArena arena;
  const Result<FrameMessage> read = FromBytes<FrameMessage>(ToCdr(dds::ToWire(frame, &frame.state, arena)));
  ASSERT_FALSE(read.ok());
  EXPECT_NE(read.error().message.find("expected a whole one"), std::string::npos);
}

// The bytes of the sample that a reader received.
template <typename Wire>
Bytes ReceivedBytes(const dds::DataReader<Wire>& reader) {
  ddsi_serdata* data = nullptr;
  dds_sample_info_t info;
  if (dds_takecdr(reader.handle(), &data, 1, &info, DDS_ANY_STATE) != 1) return {};
  Bytes bytes(ddsi_serdata_size(data));
  ddsi_serdata_to_ser(data, 0, bytes.size(), bytes.data());
  ddsi_serdata_unref(data);
  return bytes;
}

TEST(WireBytesTest, TheyAreThoseThatTravelOverDds) {
  const dds::DomainParticipant writing(test::TestConfig());
  const dds::DomainParticipant reading(test::TestConfig());
  const std::string session = test::TestSession("bytes");
  const dds::Publisher publisher(writing, dds::qos_profiles::Session(session));
  const dds::Subscriber subscriber(reading, dds::qos_profiles::Session(session));
  const dds::Topic<troupe_wire_Session> writer_topic(writing, "bytes");
  const dds::Topic<troupe_wire_Session> reader_topic(reading, "bytes");
  dds::DataWriter<troupe_wire_Session> writer(publisher, writer_topic, dds::qos_profiles::Description());
  dds::DataReader<troupe_wire_Session> reader(subscriber, reader_topic, dds::qos_profiles::Description());
  for (std::uint64_t seed = 1; seed < 5; ++seed) {
    const auto message = RandomMessage<SessionMessage>(seed);
    dds::WireArena arena;
    writer.write(dds::ToWire(message, arena));
    Bytes received;
    ASSERT_TRUE(test::Eventually([&] {
      received = ReceivedBytes(reader);
      return !received.empty();
    }));
    EXPECT_EQ(received, ToBytes(message)) << "seed " << seed;
  }
}

// With a value of its own in each field.
FrameMessage FrameWithEveryField() {
  FrameMessage frame;
  frame.run = 1;
  frame.state.tick = 2;
  frame.state_hash = 3;
  frame.last = true;
  frame.awaited = {4, 5};
  frame.edition = 6;
  frame.world_edition = 7;
  frame.fresh_edition = 8;
  frame.incarnation = 9;
  frame.remembered = true;
  frame.state.robots = {{{1.0, 2.0, 3.0, 0.25}, {4.0, 5.0, 6.0}, true}, {}};
  frame.state.joints = {{0.5, -0.125, true}};
  frame.state.grippers = {{ModelId(3), std::nullopt, ObjectId(0)}};
  frame.state.objects = {{{1.5, 2.5, 3.5, -0.5}, ObjectMode::kHeld, 0.75, GripperId(0), ModelId(9)}};
  frame.state.stores = {{12.5, 7.5}};
  frame.state.imus = {{8.0, 9.0, 10.0}};
  frame.state.lights = {{false}, {true}};
  frame.state.cameras = {{0.5, -0.25}};
  frame.state.transmissions = {{RobotId(1), 1, 9, 3, {2, RobotId(0), {1, 2, 3}}}, {.from = RobotId(0)}};
  frame.state.doors = {{0.25, 1.0, true, false, 3}, {}};
  frame.state.lifts = {{1.5, 2, RobotId(1), true, true}, {}};
  frame.state.people = {{{1.0, 2.0, 3.0, 0.25}, 0.5, -0.5, 1, 2, 3, 4, 5}, {}};
  frame.state.traffic_robots = {{.robot = RobotId(1), .at = 2, .goal = 3, .since = 4, .waits_for = RobotId(0)}};
  frame.state.traffic_moves = {{RobotId(1), 5, 6, true}};
  frame.state.lane_closures = {{7, 8, 9}};
  frame.state.lane_rules = {{3, 0.5}};
  frame.state.zones = {{false, 7}, {}};
  frame.state.coverage = {{10}, {11}};
  frame.state.charging_robots = {{RobotId(1), 5, 9, true}};
  frame.state.flows = {{1, 2, 3, 4, 5}};
  frame.state.jobs = {{0, 1, 2, 3, RobotId(1), true}};
  frame.state.waits = {{RobotId(1), 2, ModelId(3), 4}, {RobotId(2)}};
  frame.events = {{2, EventType::kGripped, RobotId(1), ModelId(5), "text", ModelId(6)}};
  frame.commands = {{.robot = RobotId(1),
                     .twist = Twist{0.5, 1.0, 1.5},
                     .grippers = {{0, 50.0, std::nullopt}},
                     .messages = {{FleetTopic::kInstantActions, "{}"}}}};
  return frame;
}

ProposalMessage ProposalWithEveryField() {
  ProposalMessage message{.run = 1, .agent = 2, .tick = 3};
  message.proposals = {
      {.robot = RobotId(4), .twist = {1.0, 2.0, 3.0}, .joint_velocities = {0.5, 0.25}},
      {.robot = RobotId(5),
       .twist = {},
       .messages = {{1, std::nullopt, {7, 8}}, {2, RobotId(4), {9}}},
       .orders = {LightOrder{0, true}, LightOrder{3, false}, CameraOrder{4, 0.5, -0.5}, DoorOrder{1, 0.5},
                  LiftOrder{0, 2, false}, TrafficOrder{1, 2, true, 3, 0.5, false}, ChargeOrder{4, true},
                  JobOrder{true, false, true}, WaitOrder{ModelId(7), 8}, LoadOrder{ModelId(9), true, 1.0, 2.0}},
       .say = "hello",
       .fleet = {{FleetTopic::kState, "{}"}}}};
  message.reports = {"a report"};
  message.edition = 6;
  message.incarnation = 7;
  return message;
}

std::uint64_t HashOf(const std::vector<std::byte>& bytes) {
  Hasher hasher;
  for (const std::byte byte : bytes) hasher.Add(std::to_integer<std::uint64_t>(byte));
  return hasher.value();
}

// The bytes of a message change only with the IDL, whose text recordings have in their schemas: one with other fields
// is refused.
TEST(MessageBytesLayoutTest, IsThatOfEarlierRecordings) {
  EXPECT_EQ(HashOf(ToBytes(FrameWithEveryField())), 0x877c0b48855d0c00);
  EXPECT_EQ(HashOf(ToBytes(ProposalWithEveryField())), 0xbb33d46b90d555dd);
}

}  // namespace
}  // namespace troupe::wire
