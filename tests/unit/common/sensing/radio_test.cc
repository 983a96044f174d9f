#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "common/sensing/sensor_kinds.h"
#include "tests/support/sensor_worlds.h"
#include "tests/support/small_world.h"
#include "troupe/radio_limits.h"

namespace troupe::test {
namespace {

constexpr Tick kTick = 20;

// Two robots with radios 4 m apart, 0.5 m above the ground; `a` sends, `b` receives.
class RadioTest : public testing::Test {
 protected:
  RadioTest() : a_(world_.AddRobot("a", {})), b_(world_.AddRobot("b", {4.0, 0.0, 0.0, 0.5 * kPi})) {}

  // The receptions of `b` in a state at kTick with these messages.
  std::vector<RadioReception> Receive(const RadioParameters& radio, std::vector<RadioTransmission> transmissions) {
    return Sensed(radio, std::move(transmissions)).MeasureAs<RadioReading>(b_, 0).receptions;
  }
  std::vector<RadioReception> Receive(const RadioParameters& radio = {}) { return Receive(radio, {Message()}); }

  SensedScene Sensed(const RadioParameters& radio, std::vector<RadioTransmission> transmissions) {
    WorldDescription world = world_.world();
    for (const RobotId robot : {a_, b_}) AddSensor(world, robot, {0.0, 0.0, 0.5, 0.0}, radio);
    for (std::size_t i = b_.index() + 1; i < world.robots.size(); ++i) AddSensor(world, RobotId(i), {}, radio);
    if (change_) change_(world);
    WorldState state = PlacedState(world);
    state.tick = kTick;
    state.transmissions = std::move(transmissions);
    return SensedScene(world, state);
  }

  RadioTransmission Message(std::vector<std::uint8_t> bytes = {1, 2}) const {
    return {.from = a_, .sent = kTick, .due = kTick, .message = {.radio = 0, .bytes = std::move(bytes)}};
  }

  SmallWorld world_;
  RobotId a_;
  RobotId b_;
  std::function<void(WorldDescription&)> change_;
};

TEST_F(RadioTest, ReceivesBytesSenderStrengthAndTick) {
  RadioTransmission message = Message({9, 0, 255});
  message.sent = kTick - 3;
  const std::vector<RadioReception> received = Receive({}, {message});
  ASSERT_EQ(received.size(), 1u);
  EXPECT_EQ(received[0].from, a_);
  EXPECT_TRUE(received[0].to_all);
  EXPECT_EQ(received[0].bytes, (std::vector<std::uint8_t>{9, 0, 255}));
  EXPECT_EQ(received[0].tick, kTick - 3);
  EXPECT_NEAR(received[0].rssi, 20.0 - 20.0 * std::log10(4.0), 1e-9);
  EXPECT_FALSE(received[0].place);
}

TEST_F(RadioTest, OnlyTheReceiverOfAMessageReceivesIt) {
  RadioTransmission message = Message();
  message.message.to = b_;
  ASSERT_EQ(Receive({}, {message}).size(), 1u);
  EXPECT_FALSE(Receive({}, {message})[0].to_all);
  message.message.to = a_;
  EXPECT_TRUE(Receive({}, {message}).empty());
}

TEST_F(RadioTest, ARobotDoesNotHearItself) {
  EXPECT_TRUE(Sensed({}, {Message()}).MeasureAs<RadioReading>(a_, 0).receptions.empty());
}

TEST_F(RadioTest, ReceivesInTheTickInWhichAMessageIsDue) {
  RadioTransmission later = Message();
  later.due = kTick + 1;
  RadioTransmission earlier = Message();
  earlier.due = kTick - 1;
  EXPECT_TRUE(Receive({}, {earlier, later}).empty());
}

TEST_F(RadioTest, RangeEndsAtTheDistanceInSpace) {
  EXPECT_EQ(Receive({.range = 4.0}).size(), 1u);
  EXPECT_EQ(Receive({.range = 3.999}).size(), 0u);
  change_ = [&](WorldDescription& world) { world.models.back().X_PM.z += 3.0; };  // the antenna of b
  EXPECT_EQ(Receive({.range = 5.0}).size(), 1u);
  EXPECT_EQ(Receive({.range = 4.999}).size(), 0u);
  EXPECT_NEAR(Receive()[0].rssi, 20.0 - 20.0 * std::log10(5.0), 1e-9);
}

TEST_F(RadioTest, ChannelsDoNotHearEachOther) {
  change_ = [&](WorldDescription& world) {
    std::get<RadioParameters>(world.robots[a_.index()].sensors[0].parameters).channel = 3;
  };
  EXPECT_TRUE(Receive().empty());
  EXPECT_EQ(Receive({.channel = 3}).size(), 1u);
}

TEST_F(RadioTest, WallsAtTheHeightOfTheAntennasAttenuate) {
  world_.AddBox("first", 1.0, 0.0, 0.1, 2.0, {0.0, 1.0});
  world_.AddBox("second", 2.0, 0.0, 0.1, 2.0, {0.0, 1.0});
  world_.AddBox("low", 2.5, 0.0, 0.1, 2.0, {0.0, 0.5});
  world_.AddBox("high", 2.7, 0.0, 0.1, 2.0, {0.51, 1.0});
  world_.AddBox("aside", 3.0, 2.0, 0.1, 2.0, {0.0, 1.0});
  world_.AddBox("glass", 3.1, 0.0, 0.1, 2.0, {0.0, 1.0}).ranger_return = -1.0;
  const RadioParameters radio{.range = 40.0, .wall_loss = 6.0};
  ASSERT_EQ(Receive(radio).size(), 1u);
  EXPECT_NEAR(Receive(radio)[0].rssi, 20.0 - 20.0 * std::log10(4.0) - 12.0, 1e-9);
  // 12 dB are a factor of 10^(12/20) in the distance, in free space.
  const double limit = 4.0 * std::pow(10.0, 12.0 / 20.0);
  EXPECT_EQ(Receive({.range = limit + 1e-6, .wall_loss = 6.0}).size(), 1u);
  EXPECT_EQ(Receive({.range = limit - 1e-6, .wall_loss = 6.0}).size(), 0u);
}

TEST_F(RadioTest, PiecesOfAWallCountOnce) {
  world_.AddBox("one half", 2.0, 0.0, 0.1, 2.0, {0.0, 1.0});
  world_.AddBox("other half", 2.1, 0.0, 0.1, 2.0, {0.0, 1.0});
  world_.AddBox("nearly there", 2.24, 0.0, 0.1, 2.0, {0.0, 1.0});
  const RadioParameters radio{.range = 40.0, .wall_loss = 6.0};
  EXPECT_NEAR(Receive(radio)[0].rssi, 20.0 - 20.0 * std::log10(4.0) - 6.0, 1e-9);
}

TEST_F(RadioTest, EachBodyBetweenAttenuatesButNotTheTwoRobots) {
  world_.AddRobot("c", {1.5, 0.0, 0.2, 0.0});
  world_.AddRobot("d", {2.5, 0.1, 0.2, 0.0});
  world_.AddRobot("e", {3.0, 1.0, 0.2, 0.0});
  const RadioParameters radio{.range = 40.0, .body_loss = 2.0};
  EXPECT_NEAR(Receive(radio)[0].rssi, 20.0 - 20.0 * std::log10(4.0) - 4.0, 1e-9);
}

TEST_F(RadioTest, LosesAsManyMessagesAsItSaysWhateverElseIsSent) {
  std::vector<RadioTransmission> messages(5000, Message());
  for (std::size_t i = 0; i < messages.size(); ++i) messages[i].number = i;
  const double count = static_cast<double>(messages.size());
  EXPECT_NEAR(static_cast<double>(Receive({.loss = 0.3}, messages).size()) / count, 0.7, 0.03);
  EXPECT_NEAR(static_cast<double>(Receive({.range = 10.0, .range_loss = 0.5}, messages).size()) / count, 0.8, 0.03);
  EXPECT_NEAR(static_cast<double>(Receive({.range = 8.0, .loss = 0.5, .range_loss = 0.5}, messages).size()) / count,
              0.375, 0.03);
  EXPECT_TRUE(Receive({.loss = 1.0}, messages).empty());
  // Each is lost or not by itself.
  const std::vector<RadioReception> all = Receive({.loss = 0.3}, messages);
  messages.resize(100);
  const std::vector<RadioReception> few = Receive({.loss = 0.3}, messages);
  ASSERT_FALSE(few.empty());
  EXPECT_TRUE(std::equal(few.begin(), few.end(), all.begin()));
  change_ = [](WorldDescription& world) { world.seed = 99; };
  EXPECT_NE(Receive({.loss = 0.3}, messages).size(), 0u);
}

TEST_F(RadioTest, MeasuresRangeAndBearingOfTheSender) {
  change_ = [&](WorldDescription& world) { world.models.back().X_PM.z -= 0.3; };  // the antenna of b, which looks left
  const std::vector<RadioReception> received = Receive({.range_and_bearing = true});
  ASSERT_EQ(received.size(), 1u);
  ASSERT_TRUE(received[0].place);
  EXPECT_NEAR(received[0].place->range, std::sqrt(16.0 + 0.09), 1e-12);
  EXPECT_NEAR(received[0].place->bearing, 0.5 * kPi, 1e-12);
  EXPECT_NEAR(received[0].place->elevation, std::atan2(0.3, 4.0), 1e-12);
}

TEST_F(RadioTest, NoiseOfRangeAndBearingHasTheDeviationsAsked) {
  std::vector<RadioTransmission> messages(4000, Message());
  for (std::size_t i = 0; i < messages.size(); ++i) messages[i].number = i;
  double range = 0.0;
  double bearing = 0.0;
  const RadioParameters radio{.range_and_bearing = true, .range_noise = 0.1, .bearing_noise = 0.02};
  for (const RadioReception& reception : Receive(radio, messages)) {
    range += (reception.place->range - 4.0) * (reception.place->range - 4.0);
    bearing += (reception.place->bearing - 0.5 * kPi) * (reception.place->bearing - 0.5 * kPi);
  }
  EXPECT_NEAR(std::sqrt(range / 4000.0), 0.1, 0.005);
  EXPECT_NEAR(std::sqrt(bearing / 4000.0), 0.02, 0.001);
}

TEST_F(RadioTest, WritesALineForTheScanLog) {
  const SensedScene sensed = Sensed({.range = 4.0}, {Message({0, 171})});
  const std::string line = sensed.JsonLines(b_, 0);
  EXPECT_EQ(line.substr(0, line.find("\"rssi\"")),
            R"({"tick":20,"robot":"b","sensor":"radio:0","received":[{"from":"a","to_all":true,"bytes":"00ab",)");
  EXPECT_EQ(line.substr(line.size() - 13), "\"tick\":20}]}\n");
}

TEST(RadioLimits, BytesOfATickFollowFromTheBandwidth) {
  EXPECT_EQ(BytesPerTick({.bandwidth = 80.0}, 0.1), 8u);
  EXPECT_EQ(BytesPerTick({.bandwidth = 79.0}, 0.1), 7u);
  EXPECT_EQ(BytesPerTick({.bandwidth = 1e9}, 0.1), kMaxRadioBytes);
  EXPECT_EQ(DelayTicks({.delay = 0.0}, 0.1), 0u);
  EXPECT_EQ(DelayTicks({.delay = 0.3}, 0.1), 3u);
  EXPECT_EQ(DelayTicks({.delay = 0.31}, 0.1), 4u);
}

TEST(RadioLimits, MessagesBeyondTheBytesOfATickAreLeftOut) {
  RobotDescription robot;
  robot.sensors.resize(2);
  robot.sensors[0].parameters = RadioParameters{.bandwidth = 80.0};
  robot.sensors[1].parameters = RadioParameters{.bandwidth = 80.0};
  const auto message = [](std::size_t radio, std::size_t size) {
    return RadioMessage{.radio = radio, .bytes = std::vector<std::uint8_t>(size)};
  };
  const std::vector<RadioMessage> all = {message(0, 5), message(0, 4), message(1, 8), message(0, 3), message(0, 0)};
  EXPECT_EQ(WithinLimits(robot, 0.1, all),
            (std::vector<RadioMessage>{message(0, 5), message(1, 8), message(0, 3), message(0, 0)}));
  EXPECT_TRUE(CheckMessages(robot, 0.1, WithinLimits(robot, 0.1, all)).ok());
  EXPECT_FALSE(CheckMessages(robot, 0.1, all).ok());
  EXPECT_FALSE(CheckMessages(robot, 0.1, {{message(2, 0)}}).ok());
  const std::vector<RadioMessage> many(kMaxRadioMessages + 1, message(0, 0));
  EXPECT_FALSE(CheckMessages(robot, 0.1, many).ok());
  EXPECT_EQ(WithinLimits(robot, 0.1, many).size(), kMaxRadioMessages);
}

}  // namespace
}  // namespace troupe::test
