// Edits of running worlds with --ros: after each one the graph of ROS has the robots of the world, and the run steps
// on.
#include <gtest/gtest.h>

#include <fstream>

#include "tests/process/ros_edit_run.h"
#include "tests/support/files.h"

namespace troupe::test {
namespace {

const std::vector<std::string> kPen = {"r0", "r1", "r2", "r3"};

// A robot with a gripper, whose topics name all objects: its gateway is made anew by a reset.
TEST(RosEdit, AResetKeepsARobotWithAGripper) {
  RosEditRun run(WorldPath("../../../worlds/scenarios/stage_stacking.json"), {"--paused", "--ticks", "100000"});
  const std::uint64_t hash = run.Step(30).state_hash;
  run.ExpectRobots({"r"});
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(run.Reset().tick, 0u);
    EXPECT_EQ(run.Step(30).state_hash, hash);
    run.ExpectRobots({"r"});
  }
  run.End();
}

TEST(RosEdit, AResetOfAPlayingRunPlaysOn) {
  RosEditRun run(WorldPath("../../../worlds/scenarios/stage_stacking.json"), {"--speed", "10", "--ticks", "100000"});
  for (int i = 0; i < 3; ++i) {
    run.Reset();
    ControlReply status;
    EXPECT_TRUE(Eventually([&] {
      control::GetStatus request;
      status = run.Ask(request);
      return status.tick >= 5;
    })) << "at tick "
        << status.tick;
    EXPECT_EQ(status.state, RunState::kPlaying);
  }
  run.ExpectRobots({"r"});
  run.End();
}

TEST(RosEdit, TheDeletionOfOneOfTwoRobotsOfAProcessKeepsTheOther) {
  RosEditRun run(WorldPath("pen.world"), {"--paused", "--robots-per-process", "2"});
  run.ExpectRobots(kPen);
  const std::vector<pid_t> agents = run.AgentsOf("r1");
  ASSERT_EQ(agents.size(), 1u);
  run.Delete("r1");
  run.Step(5);
  run.ExpectRobots({"r0", "r2", "r3"});
  run.ExpectNoTopicsOf("r1");
  EXPECT_EQ(run.AgentsOf("r0"), agents);
  run.Delete("r0");
  run.Step(5);
  run.ExpectRobots({"r2", "r3"});
  run.Reset();
  run.Step(5);
  run.ExpectRobots(kPen);
  run.End();
}

TEST(RosEdit, TheAgentOfADeletedRobotLeavesAndASpawnOfItsNameGetsAnother) {
  RosEditRun run(WorldPath("pen.world"), {"--paused", "--robots-per-process", "1"});
  run.ExpectRobots(kPen);
  for (int i = 0; i < 2; ++i) {
    const std::vector<pid_t> agents = run.AgentsOf("r1");
    ASSERT_EQ(agents.size(), 1u);
    run.Delete("r1");
    EXPECT_TRUE(IsGoneSoon(agents.front()));
    run.Step(5);
    run.ExpectRobots({"r0", "r2", "r3"});
    run.ExpectNoTopicsOf("r1");
    run.Spawn("r1", {2.0, -2.0, 0.0, 0.5});
    run.Step(5);
    run.ExpectRobots(kPen);
  }
  run.End();
}

// Another world in which all robots are the same, and have the same names.
std::string OtherWorld(const TemporaryFolder& folder) {
  std::ofstream(folder.Path("other.world"))
      << std::ifstream(WorldPath("pen.world")).rdbuf() << "wall ( name \"more\" pose [0 0 0 0] size [0.2 0.2 0.2] )\n";
  return folder.Path("other.world");
}

TEST(RosEdit, ALoadedWorldWithTheSameNamesKeepsTheRobots) {
  for (const char* robots_per_process : {"1", "4"}) {
    const TemporaryFolder folder;
    RosEditRun run(WorldPath("pen.world"),
                   {"--paused", "--allow-files", folder.Path(""), "--robots-per-process", robots_per_process});
    run.Step(5);
    run.ExpectRobots(kPen);
    const std::vector<pid_t> agents = run.AgentsOf("r3");
    ASSERT_EQ(agents.size(), 1u);
    run.Load(OtherWorld(folder));
    run.Step(5);
    run.ExpectRobots(kPen);
    run.Load(WorldPath("pen.world"));
    run.Step(5);
    run.ExpectRobots(kPen);
    EXPECT_EQ(run.AgentsOf("r3"), agents);
    run.End();
  }
}

}  // namespace
}  // namespace troupe::test
