#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>

#include "tests/support/files.h"
#include "tests/unit/robot-agent/controller/controlled_robot.h"

namespace troupe {
namespace {

// Builds examples/own_controller against the installed package, in a folder of its own that is removed with the test.
class OwnControllerTest : public ::testing::Test {
 protected:
  void SetUp() override {
    const char* source = std::getenv("TROUPE_SOURCE_DIR");
    const char* binary = std::getenv("TROUPE_BINARY_DIR");
    if (source == nullptr || binary == nullptr) GTEST_SKIP() << "TROUPE_SOURCE_DIR or TROUPE_BINARY_DIR is not set";
    std::filesystem::create_directories(folder_);
    Run("cmake -S '" + std::string(source) + "/examples/own_controller' -B '" + folder_ + "' -DCMAKE_PREFIX_PATH='" +
        binary + "/installed' -DCMAKE_BUILD_TYPE=Debug");
    Run("cmake --build '" + folder_ + "'");
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  void Run(const std::string& command) {
    const std::string log = folder_ + "/log";
    if (std::system((command + " > '" + log + "' 2>&1").c_str()) == 0) return;
    FAIL() << command << "\n" << test::TextOf(log);
  }

  std::string folder_ = ::testing::TempDir() + "/troupe_own_controller_" + std::to_string(getpid());
};

TEST_F(OwnControllerTest, BuildsOutsideTheTreeAndRuns) {
  const RobotDescription robot = MakeRobot(folder_ + "/follow_wall.so", R"({"speed": 0.4})", {MakeScanner()});
  const Result<std::unique_ptr<Controller>> controller = CreateFor(robot);
  ASSERT_TRUE(controller.ok()) << controller.error().message;
  const auto wall_at_left = Read(robot.sensors[0], [](double bearing) { return bearing > 0.6 ? 0.5 : 7.0; });
  const Command along = controller.value()->Update(At(0, {wall_at_left}));
  EXPECT_EQ(along.twist.vx, 0.4);
  EXPECT_LT(along.twist.wz, 0.0);  // away from the wall, which is nearer than 0.8 m
  const auto corner = Read(robot.sensors[0], [](double) { return 0.5; });
  EXPECT_EQ(controller.value()->Update(At(1, {corner})).twist.vx, 0.0);

  const RobotDescription misspelt = MakeRobot(folder_ + "/follow_wall.so", R"({"sped": 0.4})", {MakeScanner()});
  EXPECT_THAT(CreateFor(misspelt).error().message,
              ::testing::EndsWith("follow_wall: found the key 'sped', expected one of distance, speed; did you "
                                  "mean 'speed'?"));
  const RobotDescription bad = MakeRobot(folder_ + "/follow_wall.so", R"({"speed": -1})", {MakeScanner()});
  const Result<std::unique_ptr<Controller>> refused = CreateFor(bad);
  ASSERT_FALSE(refused.ok());
  EXPECT_THAT(
      refused.error().message,
      ::testing::EndsWith("follow_wall: found the number -1 as 'speed', expected a number between 0.01 and 10"));
}

}  // namespace
}  // namespace troupe
