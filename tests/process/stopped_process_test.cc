// Processes of a run that are stopped, and then continue: as by swapping, a debugger or a laptop that sleeps.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include <nlohmann/json.hpp>

#include "tests/process/programs.h"
#include "tests/support/dds_domain.h"
#include "tests/support/files.h"
#include "tests/support/values.h"
#include "transport/dds/tools/control_client.h"

namespace troupe::test {
namespace {

using testing::HasSubstr;

const std::vector<std::string>& Robots() {
  static const std::vector<std::string> robots = {"r0", "r1", "r2", "r3"};
  return robots;
}

void SignalAll(const std::vector<pid_t>& processes, int signal) {
  for (const pid_t process : processes) kill(process, signal);
}

// The hashes of 100 ticks without any fault.
const std::string& ExpectedHashes() {
  static const std::string hashes = [] {
    const TemporaryFolder folder;
    OutputOf(RunPen({"--in-process", "--ticks", "100", "--hash-log", folder.Path("hashes")}));
    return folder.Read("hashes");
  }();
  return hashes;
}

// A run of 100 ticks in 2 s that waits for lost robots.
class StoppedProcess : public testing::Test {
 protected:
  StoppedProcess()
      : session_(TestSession("stopped")),
        program_(RunPen({"--paused", "--speed", "5", "--lease", "0.5", "--ticks", "100", "--on-agent-loss", "pause",
                         "--hash-log", folder_.Path("hashes"), "--summary", folder_.Path("summary"), "--session",
                         session_})) {
    program_.WaitForLine("4 robots in 4 agent processes, ready");
    // An agent that the service has accepted learns of that by its first frame: without one it would look for a
    // service, and not miss one.
    ControlClient client(NetworkOf(session_));
    const Status found = client.WaitForService(kSeconds);
    EXPECT_TRUE(found.ok()) << found.error().message;
    EXPECT_TRUE(ValueOf(client.Call(control::Step{.ticks = 1}, kSeconds)).done);
    EXPECT_TRUE(ValueOf(client.Call(control::Play(), kSeconds)).done);
  }
  // The agents have returned with the memory of their controllers.
  void ExpectTheHashesOfAnUndisturbedRun() {
    EXPECT_EQ(program_.Wait(), 0) << program_.output();
    EXPECT_EQ(folder_.Read("hashes"), ExpectedHashes()) << program_.output();
    const nlohmann::json summary = nlohmann::json::parse(folder_.Read("summary"), nullptr, false);
    EXPECT_EQ(summary["lost"], nlohmann::json::array());
  }

  TemporaryFolder folder_;
  const std::string session_;
  Program program_;
};

TEST_F(StoppedProcess, OneAgentRejoins) {
  const std::vector<pid_t> agent = ChildrenWith(program_, "--robot=r2");
  ASSERT_EQ(agent.size(), 1u);
  SignalAll(agent, SIGSTOP);
  program_.WaitForLine("r2 has lost its agent");
  SignalAll(agent, SIGCONT);
  program_.WaitForLine("r2 has an agent");
  ExpectTheHashesOfAnUndisturbedRun();
}

TEST_F(StoppedProcess, AllAgentsRejoin) {
  const std::vector<pid_t> agents = ChildrenWith(program_, "--robot=");
  ASSERT_EQ(agents.size(), 4u);
  SignalAll(agents, SIGSTOP);
  for (const std::string& robot : Robots()) program_.WaitForLine(robot + " has lost its agent");
  SignalAll(agents, SIGCONT);
  for (const std::string& robot : Robots()) program_.WaitForLine(robot + " has an agent");
  ExpectTheHashesOfAnUndisturbedRun();
}

TEST_F(StoppedProcess, TheAgentsRejoinAServiceThatReturns) {
  const std::vector<pid_t> service = ChildrenWith(program_, "world-service");
  ASSERT_EQ(service.size(), 1u);
  SignalAll(service, SIGSTOP);
  for (const std::string& robot : Robots()) program_.WaitForLine("agent of " + robot + ": the world service is silent");
  SignalAll(service, SIGCONT);
  for (const std::string& robot : Robots()) program_.WaitForLine("agent of " + robot + ": joined the run again");
  ExpectTheHashesOfAnUndisturbedRun();
}

TEST(StoppedAgent, IsWaitedForAndNamedWithoutALease) {
  TemporaryFolder folder;
  Program run = RunPen({"--speed", "5", "--ticks", "100", "--hash-log", folder.Path("hashes")});
  run.WaitForLine("4 robots in 4 agent processes, ready");
  const std::vector<pid_t> agent = ChildrenWith(run, "--robot=r2");
  ASSERT_EQ(agent.size(), 1u);
  SignalAll(agent, SIGSTOP);
  EXPECT_THAT(run.WaitForLine(" waits for the agents of r2 ("), HasSubstr(std::to_string(agent.front())));
  SignalAll(agent, SIGCONT);
  EXPECT_EQ(run.Wait(), 0) << run.output();
  EXPECT_THAT(run.output(), testing::Not(HasSubstr("has lost its agent")));
  EXPECT_EQ(folder.Read("hashes"), ExpectedHashes()) << run.output();
}

TEST(StoppedRun, InOneProcessLosesNothing) {
  TemporaryFolder folder;
  const std::string scenario = folder.Write(
      "pen.json", R"({"world": ")" + WorldPath("pen.world") + R"(", "agent_deadline": 0.3, "on_agent_loss": "abort"})");
  Program run = Troupe({"run", scenario, "--in-process", "--headless", "--speed", "5", "--ticks", "100", "--hash-log",
                        folder.Path("hashes")});
  run.WaitForLine("4 robots in this process, ready");
  run.Signal(SIGSTOP);
  sleep(1);  // beyond the deadline
  run.Signal(SIGCONT);
  EXPECT_EQ(run.Wait(), 0) << run.output();
  EXPECT_EQ(folder.Read("hashes"), ExpectedHashes()) << run.output();
}

TEST(StoppedAgent, RejoinsAWorldThatWasEditedMeanwhile) {
  const std::string session = TestSession("edited-meanwhile");
  Program run = RunPen({"--speed", "5", "--lease", "0.5", "--session", session});
  run.WaitForLine("4 robots in 4 agent processes, ready");
  const std::vector<pid_t> agent = ChildrenWith(run, "--robot=r2");
  ASSERT_EQ(agent.size(), 1u);
  SignalAll(agent, SIGSTOP);
  run.WaitForLine("r2 has lost its agent");
  ControlClient client(NetworkOf(session));
  const Status found = client.WaitForService(kSeconds);
  ASSERT_TRUE(found.ok()) << found.error().message;
  control::Delete removal{.name = "r3"};
  const ControlReply reply = ValueOf(client.Call(removal, kSeconds));
  EXPECT_TRUE(reply.done) << reply.problem;
  SignalAll(agent, SIGCONT);
  run.WaitForLine("r2 has an agent");
  run.Interrupt();
}

TEST(StoppedAgent, GivesUpAServiceThatDoesNotReturn) {
  const std::string session = TestSession("killed-service");
  const std::string domain = std::to_string(TestDomain());
  Program service({ProgramPath("world-service"), WorldPath("pen.world"), "--session", session, "--domain", domain,
                   "--lease", "0.5", "--speed", "5", "--paused"});
  service.WaitForLine("waiting for their agents");
  const auto start_agent = [&](const std::string& robot) {
    return Program({ProgramPath("robot-agent"), "--session", session, "--domain", domain, "--lease", "0.5", "--robot",
                    robot, "--session-timeout", "2"});
  };
  std::vector<Program> agents;
  for (const std::string& robot : Robots()) agents.push_back(start_agent(robot));
  // An agent that does not discover the service in these 2 s, as on a busy machine, is replaced.
  const auto replace_ended = [&] {
    for (std::size_t i = 0; i < agents.size(); ++i) {
      if (agents[i].HasEnded()) agents[i] = start_agent(Robots()[i]);
    }
  };
  ASSERT_TRUE(Eventually(
      [&] {
        replace_ended();
        return service.HasPrinted("all robots have agents");
      },
      kSeconds))
      << service.output();
  // The service prints that before the agents know it. They do when they have answered a tick.
  ControlClient client(NetworkOf(session));
  const Status found = client.WaitForService(kSeconds);
  ASSERT_TRUE(found.ok()) << found.error().message;
  const ControlReply stepped = ValueOf(client.Call(control::Step{.ticks = 1}, kSeconds));
  ASSERT_TRUE(stepped.done) << stepped.problem;
  ValueOf(client.Call(control::Play(), kSeconds));
  service.Signal(SIGKILL);
  for (Program& agent : agents) {
    EXPECT_EQ(agent.Wait(), 3);
    EXPECT_THAT(agent.output(), HasSubstr("error: the world service is gone, and has not returned within 2 s"));
  }
}

}  // namespace
}  // namespace troupe::test
