// One measurement, the same bits everywhere: in the agent's scan log, from a robot, from a sensor by itself, in a
// picture.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>

#include "common/sensing/sensor_suite.h"
#include "library/save_picture.h"
#include "robot-agent/robot/robot.h"
#include "tests/support/files.h"
#include "tests/support/values.h"
#include "world-service/core/step.h"
#include "worldfile/load_world.h"

namespace troupe {
namespace {

constexpr Tick kTicks = 20;

class SameReadingsTest : public ::testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    const char* const source = std::getenv("TROUPE_SOURCE_DIR");
    if (source == nullptr) GTEST_SKIP() << "TROUPE_SOURCE_DIR is not set";
    LoadedWorld loaded = test::ValueOf(LoadWorld(std::string(source) + "/worlds/scenarios/" + GetParam() + ".json"));
    scene_ = std::make_unique<Scene>(std::move(loaded).world);
    bodies_ = std::make_unique<BodyIndex>(*scene_);
    log_ = test::ValueOf(ScanLog::Open(path_));
    for (std::size_t i = 0; i < scene_->world().robots.size(); ++i) {
      robots_.push_back(test::ValueOf(Robot::Create(*scene_, RobotId(i), {log_.get(), {}})));
      sensors_.push_back(MakeSensors(*scene_, RobotId(i)));
    }
  }
  void TearDown() override { std::filesystem::remove(path_); }

  std::vector<Proposal> Decide(const WorldState& state) {
    bodies_->Assign(state);
    std::vector<Proposal> proposals;
    for (const auto& robot : robots_) proposals.push_back(robot->Decide(state, *bodies_));
    return proposals;
  }

  // The lines that a log of this tick has, from sensors by themselves, which robots measure alike.
  std::string Lines(const WorldState& state) {
    std::string lines;
    for (std::size_t i = 0; i < sensors_.size(); ++i) {
      for (const auto& sensor : sensors_[i]) {
        const SensorReading reading = sensor->Measure({*scene_, *bodies_, &state}, state.tick);
        EXPECT_EQ(robots_[i]->Measure(sensor->index(), state, *bodies_), reading);
        if (sensor->IsDueAt(state.tick)) lines += sensor->JsonLines(scene_->world(), reading);
      }
    }
    return lines;
  }

  void ExpectSameFans(const WorldState& state) {
    BodyIndex bodies(*scene_);
    bodies.Assign(state);
    const std::vector<ScanFan> fans = MeasureFans(*scene_, bodies, state);
    auto fan = fans.begin();
    for (const auto& of_robot : sensors_) {
      for (const auto& sensor : of_robot) {
        const SensorReading reading = sensor->Measure({*scene_, *bodies_, &state}, state.tick);
        if (reading.ranger() == nullptr) continue;
        for (const RangeScan& scan : reading.ranger()->scans()) {
          ASSERT_NE(fan, fans.end());
          const auto plane = scan.ranges.begin() + static_cast<std::ptrdiff_t>(FlattestPlane(scan) * scan.fan.count);
          EXPECT_EQ(fan->ranges, std::vector<double>(plane, plane + static_cast<std::ptrdiff_t>(scan.fan.count)));
          for (std::size_t i = 0; i < scan.fan.count; ++i) EXPECT_EQ(fan->bearings[i], scan.fan.Bearing(i));
          ++fan;
        }
      }
    }
    EXPECT_EQ(fan, fans.end());
  }

  std::string path_ = ::testing::TempDir() + "/troupe_same_readings_" + std::to_string(getpid());
  std::unique_ptr<Scene> scene_;
  std::unique_ptr<BodyIndex> bodies_;
  std::unique_ptr<ScanLog> log_;
  std::vector<std::unique_ptr<Robot>> robots_;
  std::vector<std::vector<std::unique_ptr<const Sensor>>> sensors_;  // by robot
};

TEST_P(SameReadingsTest, InTheAgentAPictureAndASensorByItself) {
  WorldState state = PlacedState(scene_->world());
  std::string expected;
  while (state.tick < kTicks) {
    const std::vector<Proposal> proposals = Decide(state);
    expected += Lines(state);
    ExpectSameFans(state);
    state = Step(*scene_, state, proposals).state;
  }
  ASSERT_TRUE(log_->Flush().ok());
  EXPECT_EQ(test::TextOf(path_), expected);
  EXPECT_FALSE(expected.empty());
}

// Scanners and sonars, with scripts and with controllers that read them; grippers with break beams; all other kinds.
INSTANTIATE_TEST_SUITE_P(Worlds, SameReadingsTest, ::testing::Values("demo", "lab", "relay", "sensors"),
                         [](const auto& scenario) { return std::string(scenario.param); });

}  // namespace
}  // namespace troupe
