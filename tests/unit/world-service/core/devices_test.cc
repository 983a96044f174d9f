// Lights that robots switch, cameras that they turn, and texts that they say.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>

#include "common/model/states.h"
#include "tests/support/sensor_worlds.h"
#include "tests/support/small_world.h"
#include "world-service/core/edit_world.h"
#include "world-service/core/step.h"
#include "world-service/core/step_workspace.h"

namespace troupe {
namespace {

// Two robots: the first with two lights, of which one is off at load, the second with one. A camera looks at the first.
class DevicesTest : public testing::Test {
 protected:
  DevicesTest() : first_(world_.AddRobot("first", {})), second_(world_.AddRobot("second", {-3.0, 0.0, 0.0, 0.0})) {
    AddLight(second_, "lamp", true);
    AddLight(first_, "left", true);
    AddLight(first_, "right", false);
    test::AddSensor(world_.world(), second_, {0.0, 0.0, 0.45, 0.0}, BlobfinderParameters{.range = 10.0});
    test::AddSensor(world_.world(), second_, {0.0, 0.0, 0.45, 0.0}, CameraParameters{});
    scene_ = std::make_shared<const Scene>(world_.world());
  }

  void AddLight(RobotId robot, const char* name, bool on) {
    const double y = on ? 0.3 : -0.3;
    ModelDescription& light = world_.AddPart(robot, name, {0.0, y, 0.4, 0.0}, 0.2, 0.2, {0.0, 0.2});
    light.color = {1.0, 1.0, 0.0, 1.0};
    light.blinking = {1'000'000'000, 1'000'000'000, on};
  }
  static Proposal Say(RobotId robot, const std::string& text) {
    Proposal proposal{robot, {}};
    proposal.say = text;
    return proposal;
  }
  Proposal Turn(const std::vector<CameraOrder>& cameras) const {
    Proposal proposal{second_, {}};
    proposal.orders.assign(cameras.begin(), cameras.end());
    return proposal;
  }
  static Proposal Switch(RobotId robot, const std::vector<LightOrder>& lights) {
    Proposal proposal{robot, {}};
    proposal.orders.assign(lights.begin(), lights.end());
    return proposal;
  }

  SmallWorld world_;
  RobotId first_;
  RobotId second_;
  std::shared_ptr<const Scene> scene_;
};

TEST_F(DevicesTest, LightsAreInTheOrderOfRobotsAndAsAtLoad) {
  const WorldState state = InitialState(*scene_);
  EXPECT_EQ(state.lights, (std::vector<LightState>{{true}, {false}, {true}}));
  EXPECT_EQ(scene_->lights_of(first_).size(), 2u);
  EXPECT_EQ(scene_->first_light_of(second_), 2u);
  EXPECT_EQ(scene_->light_of(scene_->lights()[1].model), 1u);
  EXPECT_FALSE(scene_->light_of(ModelId(0)));
}

TEST_F(DevicesTest, ALightStaysAsItWasSwitchedLast) {
  WorldState state = InitialState(*scene_);
  const std::uint64_t before = StateHash(state);
  state =
      Step(*scene_, state, {{Switch(first_, {{0, true}, {0, false}, {1, true}}), Switch(second_, {{0, false}})}}).state;
  EXPECT_EQ(state.lights, (std::vector<LightState>{{false}, {true}, {false}}));
  EXPECT_NE(StateHash(state), before);
  state = Step(*scene_, state, {{Proposal{first_, {}}}}).state;
  EXPECT_EQ(state.lights, (std::vector<LightState>{{false}, {true}, {false}}));
  EXPECT_TRUE(CheckState(scene_->world(), state).ok());
  state.lights.pop_back();
  EXPECT_FALSE(CheckState(scene_->world(), state).ok());
}

TEST_F(DevicesTest, OthersSeeWhetherALightIsOn) {
  WorldState state = InitialState(*scene_);
  const Color bright = scene_->world().model(scene_->lights()[0].model).color;
  const auto blobs = [&] {
    std::vector<Color> colors;
    for (const Blob& blob : test::SensedScene(world_.world(), state).MeasureAs<BlobfinderReading>(second_, 0).blobs) {
      colors.push_back(blob.color);
    }
    return colors;
  };
  ASSERT_EQ(blobs().size(), 2u);
  EXPECT_EQ(blobs()[0], bright) << "the left one";
  EXPECT_NE(blobs()[1], bright);
  state = Step(*scene_, state, {{Switch(first_, {{0, false}, {1, true}})}}).state;
  ASSERT_EQ(blobs().size(), 2u);
  EXPECT_NE(blobs()[0], bright);
  EXPECT_EQ(blobs()[1], bright);
}

TEST_F(DevicesTest, ACameraStaysAsItWasTurnedLast) {
  WorldState state = InitialState(*scene_);
  EXPECT_EQ(state.cameras, (std::vector<CameraState>{{0.0, 0.0}}));
  const std::uint64_t before = StateHash(state);
  state = Step(*scene_, state, {{Turn({{1, 0.5, 0.25}, {1, -0.5, 0.125}})}}).state;
  EXPECT_EQ(state.cameras, (std::vector<CameraState>{{-0.5, 0.125}}));
  EXPECT_NE(StateHash(state), before);
  state = Step(*scene_, state, {{Proposal{second_, {}}}}).state;
  EXPECT_EQ(state.cameras, (std::vector<CameraState>{{-0.5, 0.125}}));
}

TEST_F(DevicesTest, ATurnedCameraSeesAsOneThatIsMountedSo) {
  const CameraParameters& camera = *FindCamera(world_.world().robot(second_), 1);
  CameraParameters mounted = camera;
  mounted.X_MS = camera.X_MS * Pose{0.0, 0.0, 0.0, 0.25};
  mounted.elevation = {camera.elevation.min - 0.125, camera.elevation.max - 0.125};
  test::AddSensor(world_.world(), second_, {0.0, 0.0, 0.45, 0.0}, mounted);
  WorldState state = PlacedState(world_.world());
  state.cameras[0] = {0.25, -0.125};
  test::SensedScene sensed(world_.world(), state);
  const CameraReading turned = sensed.MeasureAs<CameraReading>(second_, 1);
  EXPECT_TRUE(turned == sensed.MeasureAs<CameraReading>(second_, 2));
  EXPECT_NE(std::count_if(turned.models.begin(), turned.models.end(), [](std::int32_t model) { return model >= 0; }),
            0);
  state.cameras[0] = {};
  EXPECT_FALSE(turned == test::SensedScene(world_.world(), state).MeasureAs<CameraReading>(second_, 1));
}

TEST_F(DevicesTest, DirectionsThatNoCameraCanHaveAreRefused) {
  const WorldState state = InitialState(*scene_);
  const auto is_valid = [&](const CameraOrder& order) { return ValidateProposal(*scene_, state, Turn({order})).ok(); };
  const Interval limits = FindCamera(scene_->world().robot(second_), 1)->TiltLimits();
  EXPECT_NEAR(limits.max, DegreesToRadians(65.0), 1e-9);
  EXPECT_TRUE(is_valid({1, kPi, limits.min}));
  EXPECT_TRUE(is_valid({1, -kPi, limits.max}));
  EXPECT_FALSE(is_valid({0, 0.0, 0.0})) << "a blobfinder";
  EXPECT_FALSE(is_valid({2, 0.0, 0.0})) << "no sensor";
  EXPECT_FALSE(is_valid({1, 3.2, 0.0}));
  EXPECT_FALSE(is_valid({1, 0.0, limits.max + 1e-6}));
  EXPECT_FALSE(is_valid({1, std::nan(""), 0.0}));
  EXPECT_FALSE(is_valid({1, 0.0, std::nan("")}));
}

TEST_F(DevicesTest, ATextIsAnEvent) {
  const StepResult result = Step(*scene_, InitialState(*scene_), {{Say(first_, "hello"), Say(second_, "")}});
  ASSERT_EQ(result.events.size(), 1u);
  EXPECT_EQ(result.events[0], (Event{.tick = 1, .type = EventType::kSaid, .robot = first_, .detail = "hello"}));
}

TEST_F(DevicesTest, UnknownLightsAndTextsThatAreLongOrControlATerminalAreRefused) {
  const WorldState state = InitialState(*scene_);
  const auto problem = [&](const Proposal& proposal) {
    const Status status = ValidateProposal(*scene_, state, proposal);
    return status.ok() ? "" : status.error().message;
  };
  EXPECT_EQ(problem(Switch(first_, {{1, true}})), "");
  EXPECT_EQ(problem(Switch(first_, {{2, true}})), "found light 2, expected one of the robot's 2");
  EXPECT_EQ(problem(Say(first_, std::string(200, 'a'))), "");
  EXPECT_EQ(problem(Say(first_, std::string(201, 'a'))), "found a text of 201 bytes, expected at most 200");
  EXPECT_EQ(problem(Say(first_, "\x1b[2J")),
            "found a text with a control character or a byte that is not UTF-8, expected a line of UTF-8");
  EXPECT_NE(problem(Say(first_, "\xc2\x9b 2J")), "") << "the same command in one character";
  EXPECT_NE(problem(Say(first_, "gr\xfc\xdf")), "") << "Latin-1";
  EXPECT_EQ(problem(Say(first_, "gr\u00fc\u00df")), "");
}

TEST_F(DevicesTest, LightsOfASpawnedRobotFollowThoseOfOthers) {
  WorldState state = Step(*scene_, InitialState(*scene_), {{Switch(first_, {{1, true}})}}).state;
  const WorldDescription copy = ExtractEntity(scene_->world(), scene_->world().robot(first_).root);
  const Result<EditedWorld> edited = SpawnEntity(scene_, state, copy, "third", {5.0, 5.0, 0.0, 0.0});
  ASSERT_TRUE(edited.ok()) << edited.error().message;
  EXPECT_EQ(edited.value().state.lights, (std::vector<LightState>{{true}, {true}, {true}, {true}, {false}}));
  EXPECT_TRUE(CheckState(edited.value().scene->world(), edited.value().state).ok());
}

// The radio messages of steps and edits.

class TransmitTest : public testing::Test {
 protected:
  TransmitTest() : a_(world_.AddRobot("a", {})), b_(world_.AddRobot("b", {4.0, 0.0, 0.0, 0.0})) {
    test::AddSensor(world_.world(), a_, {}, RadioParameters{.bandwidth = 100.0});
    test::AddSensor(world_.world(), a_, {}, RadioParameters{.bandwidth = 100.0, .delay = 0.2});
    test::AddSensor(world_.world(), b_, {}, RadioParameters{});
    scene_ = std::make_shared<const Scene>(world_.world());
  }
  static Proposal Send(RobotId robot, std::vector<RadioMessage> messages) {
    Proposal proposal{robot, {}};
    proposal.messages = std::move(messages);
    return proposal;
  }

  SmallWorld world_;
  RobotId a_;
  RobotId b_;
  std::shared_ptr<const Scene> scene_;
};

TEST_F(TransmitTest, AMessageIsInTheStatesFromItsTickToItsArrival) {
  const WorldState start = InitialState(*scene_);
  WorldState state = Step(*scene_, start, {{Send(a_, {{0, b_, {1}}, {1, {}, {2, 3}}})}}).state;
  ASSERT_EQ(state.transmissions.size(), 2u);
  EXPECT_EQ(state.transmissions[0], (RadioTransmission{a_, 1, 1, 0, {0, b_, {1}}}));
  EXPECT_EQ(state.transmissions[1], (RadioTransmission{a_, 1, 3, 1, {1, std::nullopt, {2, 3}}}));
  EXPECT_TRUE(CheckState(scene_->world(), state).ok());
  state = Step(*scene_, state, {{Send(b_, {{0, {}, {}}})}}).state;
  ASSERT_EQ(state.transmissions.size(), 2u);
  EXPECT_EQ(state.transmissions[0].due, 3u);
  EXPECT_EQ(state.transmissions[1], (RadioTransmission{b_, 2, 2, 0, {0, std::nullopt, {}}}));
  state = Step(*scene_, state, {}).state;
  EXPECT_EQ(state.transmissions.size(), 1u);
  EXPECT_TRUE(Step(*scene_, state, {}).state.transmissions.empty());
}

TEST_F(TransmitTest, EveryPartOfAMessageChangesTheHash) {
  WorldState state = Step(*scene_, InitialState(*scene_), {{Send(a_, {{0, b_, {1, 2}}})}}).state;
  const std::uint64_t hash = StateHash(state);
  const auto changes = [&](auto change) {
    WorldState other = state;
    change(other.transmissions[0]);
    return StateHash(other) != hash;
  };
  EXPECT_TRUE(changes([&](RadioTransmission& t) { t.from = b_; }));
  EXPECT_TRUE(changes([](RadioTransmission& t) { ++t.sent; }));
  EXPECT_TRUE(changes([](RadioTransmission& t) { ++t.due; }));
  EXPECT_TRUE(changes([](RadioTransmission& t) { ++t.number; }));
  EXPECT_TRUE(changes([](RadioTransmission& t) { t.message.radio = 1; }));
  EXPECT_TRUE(changes([](RadioTransmission& t) { t.message.to.reset(); }));
  EXPECT_TRUE(changes([](RadioTransmission& t) { t.message.bytes[1] = 3; }));
  EXPECT_TRUE(changes([](RadioTransmission& t) { t.message.bytes.pop_back(); }));
}

TEST_F(TransmitTest, ProposalsBeyondTheRadiosAreRefused) {
  const WorldState state = InitialState(*scene_);
  const auto problem = [&](std::vector<RadioMessage> messages) {
    const Status status = ValidateProposal(*scene_, state, Send(a_, std::move(messages)));
    return status.ok() ? "" : status.error().message;
  };
  EXPECT_EQ(problem({{0, b_, std::vector<std::uint8_t>(10)}, {1, {}, std::vector<std::uint8_t>(10)}}), "");
  EXPECT_EQ(problem({{0, b_, std::vector<std::uint8_t>(11)}}),
            "found a radio message of 11 bytes beyond the bandwidth of 'radio:0', expected at most 10 bytes in a tick");
  EXPECT_NE(problem({{0, b_, std::vector<std::uint8_t>(6)}, {0, b_, std::vector<std::uint8_t>(6)}}), "");
  EXPECT_EQ(problem({{2, {}, {}}}), "found a message of sensor 2, expected a radio of the robot");
  EXPECT_EQ(problem({{0, RobotId(2), {}}}), "found a radio message to robot 2, expected one of 2 robots");
  EXPECT_NE(problem(std::vector<RadioMessage>(kMaxRadioMessages + 1, {0, {}, {}})), "");
}

TEST_F(TransmitTest, ADeletedRobotTakesItsMessagesAlong) {
  const WorldState state =
      Step(*scene_, InitialState(*scene_), {{Send(a_, {{1, {}, {1}}}), Send(b_, {{0, {}, {2}}, {0, a_, {3}}})}}).state;
  ASSERT_EQ(state.transmissions.size(), 3u);
  const Result<EditedWorld> edited = DeleteEntity(scene_, state, "a");
  ASSERT_TRUE(edited.ok());
  ASSERT_EQ(edited.value().state.transmissions.size(), 1u);
  EXPECT_EQ(edited.value().state.transmissions[0].message.bytes.front(), 2);
  EXPECT_TRUE(CheckState(edited.value().scene->world(), edited.value().state).ok());
}

TEST_F(TransmitTest, AResetOfTimeEndsAllMessages) {
  const WorldState state = Step(*scene_, InitialState(*scene_), {{Send(a_, {{1, {}, {1}}})}}).state;
  EXPECT_TRUE(ResetWorld(scene_, scene_, state, {.time = true, .state = false, .spawned = false, .deleted = false})
                  .state.transmissions.empty());
}

}  // namespace
}  // namespace troupe
