#include <gtest/gtest.h>

#include <limits>

#include "tests/support/test_world.h"
#include "world-service/core/step.h"

namespace troupe {
namespace {

class ValidateProposalTest : public testing::Test {
 protected:
  ValidateProposalTest() {
    test_.AddRobot(test::Square(0.4), {0.0, 0.5}, {});
    DriveDescription& drive = test_.world.robots[0].drive;
    drive.type = DriveType::kDifferential;
    drive.velocity = {{-1.0, 1.0}, {0.0, 0.0}, {-2.0, 2.0}};
    drive.acceleration = {{-1.0, 1.0}, {0.0, 0.0}, {-10.0, 10.0}};
    state_ = PlacedState(test_.world);
  }
  // The message of the error, if any.
  std::string Check(const Proposal& proposal) const {
    const Status valid = ValidateProposal(test_.world, state_, proposal);
    return valid.ok() ? "" : valid.error().message;
  }

  test::TestWorld test_;
  WorldState state_;
};

TEST_F(ValidateProposalTest, AcceptsMotionsWithinTheLimits) {
  EXPECT_EQ(Check({RobotId(0), {}}), "");
  EXPECT_EQ(Check({RobotId(0), {.vx = 0.1, .wz = -1.0}}), "");
  state_.robots[0].twist = {.vx = 0.95};
  EXPECT_EQ(Check({RobotId(0), {.vx = 1.0}}), "");
}

TEST_F(ValidateProposalTest, RefusesAnUnknownRobot) {
  EXPECT_EQ(Check({RobotId(1), {}}), "found robot 1, expected one of 1 robots");
}

TEST_F(ValidateProposalTest, RefusesNumbersThatAreNotFinite) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  for (double bad : {nan, infinity, -infinity}) {
    EXPECT_NE(Check({RobotId(0), {.vx = bad}}), "");
    EXPECT_NE(Check({RobotId(0), {.vy = bad}}), "");
    EXPECT_NE(Check({RobotId(0), {.wz = bad}}), "");
  }
}

TEST_F(ValidateProposalTest, RefusesTooMuchSpeedOrAcceleration) {
  EXPECT_EQ(Check({RobotId(0), {.vx = 0.2}}),
            "found the twist (0.2 m/s, 0 m/s, 0 rad/s) after (0 m/s, 0 m/s, 0 rad/s), expected one within the drive's "
            "bounds: (0.1 m/s, 0 m/s, 0 rad/s) is the nearest");
  EXPECT_NE(Check({RobotId(0), {.vy = 0.1}}), "") << "a differential drive does not move sideways";
  state_.robots[0].twist = {.vx = 1.0};
  EXPECT_NE(Check({RobotId(0), {.vx = 1.05}}), "");
  EXPECT_NE(Check({RobotId(0), {}}), "") << "it cannot brake that hard";
}

}  // namespace
}  // namespace troupe
