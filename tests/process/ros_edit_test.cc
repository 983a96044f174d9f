// Edits of running worlds with --ros: after each one the graph of ROS has the robots of the world, and the run steps
// on.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <algorithm>
#include <fstream>
#include <utility>

#include "common/dds/tools/control_client.h"
#include "tests/process/output_folder.h"
#include "tests/process/programs.h"
#include "tests/support/dds_domain.h"
#include "tests/support/ros_graph.h"

namespace troupe::test {
namespace {

using testing::ElementsAreArray;
using testing::IsEmpty;

constexpr double kSeconds = 60.0;  // that an answer may take on the slowest machine

// A run with --ros, a tool that edits its world, and a tool of ROS that lists its nodes.
class RosEditRun {
 public:
  RosEditRun(const std::string& file, std::vector<std::string> more)
      : session_(TestSession("ros-edit")), run_(Troupe(Arguments(file, std::move(more)))) {
    run_.WaitForLine(", ready");
  }

  Program& program() { return run_; }

  ControlReply Ask(ControlRequest request) {
    const Result<ControlReply> reply = client_.Call(std::move(request), kSeconds);
    if (reply.ok()) {
      EXPECT_TRUE(reply.value().done) << reply.value().problem;
      return reply.value();
    }
    ADD_FAILURE() << reply.error().message << "\n" << run_.output();
    return {};
  }
  ControlReply Step(std::uint64_t ticks) {
    ControlRequest request = {};
    request.command = ControlCommand::kStep;
    request.ticks = ticks;
    const ControlReply reply = Ask(request);
    const ControlReply before = std::exchange(newest_, reply);
    if (reply.edition == before.edition) {
      EXPECT_EQ(reply.tick, before.tick + ticks);
    }
    return reply;
  }
  ControlReply Reset() { return Edit(ControlCommand::kReset); }
  ControlReply Delete(const std::string& name) { return Edit(ControlCommand::kDelete, name); }
  ControlReply Load(const std::string& file) { return Edit(ControlCommand::kLoadWorld, "", file); }
  ControlReply Spawn(const std::string& name, const Pose& pose) {
    return Edit(ControlCommand::kSpawn, name, "rover", pose);
  }

  // Awaits a graph with these robots, each with one node and topics, and the node of the world.
  void ExpectRobots(const std::vector<std::string>& robots) {
    std::vector<std::string> expected = {"/world"};
    for (const std::string& robot : robots) expected.push_back("/" + robot + "/robot");
    std::sort(expected.begin(), expected.end());
    std::vector<std::string> nodes;
    EXPECT_TRUE(Eventually([&] { return (nodes = graph_.Nodes()) == expected; }, kSeconds))
        << testing::PrintToString(nodes) << "\n"
        << run_.output();
    for (const std::string& robot : robots) {
      EXPECT_TRUE(Eventually([&] { return graph_.Topics("/" + robot + "/").contains("/" + robot + "/odom"); }));
    }
  }
  void ExpectNoTopicsOf(const std::string& robot) {
    EXPECT_TRUE(Eventually([&] { return graph_.Topics("/" + robot + "/").empty(); }))
        << testing::PrintToString(graph_.Topics("/" + robot + "/"));
  }

  // The processes of agents that simulate a robot.
  std::vector<pid_t> AgentsOf(const std::string& robot) const {
    std::vector<pid_t> agents;
    for (const pid_t child : ChildrenOf(run_.pid())) {
      if ((CommandLineOf(child) + " ").find("--robot=" + robot + " ") != std::string::npos) agents.push_back(child);
    }
    return agents;
  }

  void End() {
    run_.Signal(SIGINT);
    EXPECT_EQ(run_.Wait(), 130) << run_.output();
    EXPECT_THAT(run_.output(), testing::Not(testing::HasSubstr("the agent (process"))) << "an agent failed";
  }

 private:
  std::vector<std::string> Arguments(const std::string& file, std::vector<std::string> more) const {
    std::vector<std::string> arguments = {"run",
                                          file,
                                          "--headless",
                                          "--domain",
                                          std::to_string(TestDomain()),
                                          "--session",
                                          session_,
                                          "--ros",
                                          "--ros-interface",
                                          "lo",
                                          "--ros-domain",
                                          std::to_string(TestRosOptions().domain)};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }
  ControlReply Edit(ControlCommand command, const std::string& name = "", const std::string& source = "",
                    const Pose& pose = {}) {
    ControlRequest request = {};
    request.command = command;
    request.name = name;
    request.source = source;
    request.pose = pose;
    return newest_ = Ask(request);
  }

  const std::string session_;
  RosGraph graph_;
  Program run_;
  ControlClient client_{TestDomain(), session_, "lo"};
  ControlReply newest_;
};

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
      ControlRequest request = {};
      request.command = ControlCommand::kStatus;
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
std::string OtherWorld(const OutputFolder& folder) {
  std::ofstream(folder.Path("other.world"))
      << std::ifstream(WorldPath("pen.world")).rdbuf() << "wall ( name \"more\" pose [0 0 0 0] size [0.2 0.2 0.2] )\n";
  return folder.Path("other.world");
}

TEST(RosEdit, ALoadedWorldWithTheSameNamesKeepsTheRobots) {
  for (const char* robots_per_process : {"1", "4"}) {
    const OutputFolder folder;
    RosEditRun run(WorldPath("pen.world"), {"--paused", "--robots-per-process", robots_per_process});
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
