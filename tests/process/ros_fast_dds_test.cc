// The services of whole runs, called by programs on Fast DDS that act like rmw_fastrtps_cpp. They share no code with
// the side that answers them.
#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <signal.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "ros/connection/topic_types.h"
#include "tests/process/programs.h"
#include "tests/support/dds_domain.h"
#include "tests/support/ros_client.h"
#include "tests/support/ros_domain.h"
#include "tests/support/ros_graph.h"
#include "troupe/random.h"

namespace troupe::test {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::Not;
using StateClient = TROUPE_SIMULATION_CLIENT(GetSimulationState);

std::string Domain() {
  return std::to_string(TestRosNetwork().domain);
}

Program Caller(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), {ProgramPath("fastdds_caller"), Domain()});
  return Program(std::move(arguments));
}

using Datagram = std::vector<std::uint8_t>;

// A datagram of a stranger on Fast DDS with one submessage; `length`: as that states it.
Datagram WithSubmessage(std::uint8_t kind, std::uint8_t flags, const Datagram& body, std::size_t length) {
  Datagram datagram = {'R', 'T', 'P', 'S', 2, 3, 1, 15, 1, 15, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, kind, flags};
  datagram.push_back(static_cast<std::uint8_t>(length));
  datagram.push_back(static_cast<std::uint8_t>(length >> 8U));
  datagram.insert(datagram.end(), body.begin(), body.end());
  return datagram;
}

// To the ports of the first participants of the domain on this host.
class Stranger {
 public:
  ~Stranger() { close(socket_); }
  void Send(const Datagram& datagram) const {
    constexpr std::uint32_t kFirst = 10;
    constexpr std::uint32_t kPorts = 6;
    sockaddr_in to{};
    to.sin_family = AF_INET;
    to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    for (std::uint32_t port = kFirst; port < kFirst + kPorts; ++port) {
      to.sin_port = htons(static_cast<std::uint16_t>(7400 + 250 * TestRosNetwork().domain + port));
      sendto(socket_, datagram.data(), datagram.size(), 0, reinterpret_cast<const sockaddr*>(&to), sizeof to);
    }
  }

 private:
  const int socket_ = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
};

// The lines of a caller on one topic.
std::vector<json> LinesOn(Program& caller, const std::string& topic) {
  std::vector<json> found;
  std::istringstream lines(caller.output());
  for (std::string text; std::getline(lines, text);) {
    json line = json::parse(text, nullptr, false);
    if (line.is_object() && line["topic"] == topic) found.push_back(std::move(line));
  }
  return found;
}

class RosFastDds : public testing::Test {
 protected:
  void SetUp() override {
    if (!ros::HasFastDds() || !std::filesystem::exists(ProgramPath("fastdds_caller"))) {
      GTEST_SKIP() << "needs libfastrtps-dev and fastddsgen";
    }
  }

  static Program Run(std::vector<std::string> more) {
    return RunPen(Words("--speed 1 --ros --ros-interface lo --ros-domain %", {Domain()}) + more);
  }
  // The processes of ros-participant on Fast DDS.
  static std::vector<pid_t> SidesOf(const Program& run) {
    std::vector<pid_t> sides;
    for (const pid_t child : ChildrenOf(run.pid())) {
      for (const pid_t side : ChildrenOf(child)) {
        if (CommandLineOf(side).find("--fast-dds-side") != std::string::npos) sides.push_back(side);
      }
    }
    return sides;
  }
  static void End(Program& run) {
    const std::vector<pid_t> sides = SidesOf(run);
    run.Interrupt();
    for (const pid_t side : sides) EXPECT_TRUE(IsGoneSoon(side));
  }
};

TEST_F(RosFastDds, ClientsOfBothImplementationsAreAnsweredOnceEach) {
  constexpr int kCalls = 1000;
  Program run = Run({"--paused"});
  run.WaitForLine(", ready");
  Program caller = Caller({"states", std::to_string(kCalls)});
  const ros::RosParticipant participant(TestRosNetwork());
  StateClient client(participant, "/world/get_simulation_state");
  int answered = 0;
  caller.WaitForLine("calling");
  for (int i = 0; i < kCalls; ++i) {
    client.Call({}, [&](const auto& response) { answered += response.result.result == 1; });
    ASSERT_FALSE(HasFatalFailure()) << i;
  }
  EXPECT_EQ(answered, kCalls);
  EXPECT_EQ(caller.Wait(), 0) << caller.output();
  EXPECT_THAT(caller.output(), HasSubstr(R"({"answered":1000,"calls":1000,"repeated":0,"topic":"called"})"));
  EXPECT_THAT(caller.output(), HasSubstr(R"("matched":[1,1])")) << "the service itself is no match";
  End(run);
}

TEST_F(RosFastDds, PassesOnActionsAndLargeResponses) {
  Program run = Run({"--paused"});
  run.WaitForLine(", ready");
  Program steps = Caller({"simulate", "20"});
  EXPECT_EQ(steps.Wait(), 0) << steps.output();
  EXPECT_THAT(steps.output(),
              HasSubstr(R"({"accepted":true,"feedback":20,"result":1,"status":4,"topic":"simulated"})"));
  Program describer = Caller({"describe", "20"});
  EXPECT_EQ(describer.Wait(), 0) << describer.output();
  EXPECT_THAT(describer.output(), HasSubstr(R"({"found":20,"parts":)"));
  End(run);
}

// A call during the loss of the side has no answer; all others have one, and those of clients on Cyclone DDS too.
TEST_F(RosFastDds, ASideThatIsKilledIsStartedAgain) {
  constexpr int kCalls = 1000;
  constexpr int kKills = 3;
  Program run = Run({"--paused"});
  run.WaitForLine(", ready");
  Program caller = Caller({"states", std::to_string(kCalls), "1"});
  caller.WaitForLine("calling");
  const ros::RosParticipant participant(TestRosNetwork());
  StateClient client(participant, "/world/get_simulation_state");
  int cyclone_answered = 0;
  std::thread cyclone([&] {
    for (int i = 0; i < kCalls && !HasFatalFailure(); ++i) {
      client.Call({}, [&](const auto& response) { cyclone_answered += response.result.result == 1; });
    }
  });
  for (int quarter = 1; quarter <= kKills; ++quarter) {
    caller.WaitForLine(R"("number":)" + std::to_string(quarter));
    std::vector<pid_t> sides;
    EXPECT_TRUE(Eventually([&] { return (sides = SidesOf(run)).size() == 1; }));
    if (!sides.empty()) kill(sides.front(), SIGKILL);
  }
  run.WaitForLine("the Fast DDS side (process ");
  EXPECT_EQ(caller.Wait(), 0) << caller.output();
  cyclone.join();
  EXPECT_EQ(cyclone_answered, kCalls);
  const std::vector<json> called = LinesOn(caller, "called");
  ASSERT_EQ(called.size(), 1u) << caller.output();
  const int answered = called.front()["answered"];
  EXPECT_GE(answered, kCalls - 10 * kKills);
  EXPECT_EQ(answered + static_cast<int>(LinesOn(caller, "timeout").size()), kCalls);
  EXPECT_EQ(called.front()["repeated"], 0);
  End(run);
}

TEST_F(RosFastDds, AGoalGoesOnWhileTheSideIsKilledAndIsAnsweredToANewCall) {
  Program run = Run({"--paused"});
  run.WaitForLine(", ready");
  Program caller = Caller({"simulate", "30"});
  caller.WaitForLine("asked");
  std::vector<pid_t> sides;
  EXPECT_TRUE(Eventually([&] { return (sides = SidesOf(run)).size() == 1; }));
  for (const pid_t side : sides) kill(side, SIGKILL);
  EXPECT_EQ(caller.Wait(), 0) << caller.output();
  EXPECT_THAT(caller.output(),
              HasSubstr(R"({"accepted":true,"feedback":30,"result":1,"status":4,"topic":"simulated"})"));
  run.WaitForLine("the Fast DDS side (process ");
  End(run);
}

TEST_F(RosFastDds, ACallWithoutAnAnswerIsLostWithTheSideAndItsStepsGoOn) {
  constexpr Tick kSteps = 30;
  const std::string session = TestSession("fast-dds");
  const auto tick = [&] { return CallRun(session, control::GetStatus()).tick; };
  Program run = Run({"--paused", "--session", session});
  run.WaitForLine(", ready");
  Program lost = Caller({"step", std::to_string(kSteps)});
  lost.WaitForLine("asked");
  EXPECT_TRUE(Eventually([&] { return tick() > 0; }));
  for (const pid_t side : SidesOf(run)) kill(side, SIGKILL);
  run.WaitForLine("it is started again");
  EXPECT_TRUE(Eventually([&] { return tick() == kSteps; }));
  // The answer to the first call is on its way before the second one, which must not get it.
  Program next = Caller({"step", "1"});
  EXPECT_EQ(next.Wait(), 0) << next.output();
  EXPECT_THAT(next.output(), HasSubstr(R"({"repeated":0,"result":1,"topic":"stepped"})"));
  EXPECT_EQ(tick(), kSteps + 1);
  lost.Signal(SIGTERM);
  lost.Wait();
  EXPECT_THAT(lost.output(), Not(HasSubstr("stepped")));
  End(run);
}

// The reads of Fast DDS 2.9 that end the process: statistics with bytes behind them (84 bytes in all), a heartbeat from
// 0 on, and numbers so large that their successor overflows. Then each kind of submessage with any flags and lengths.
TEST_F(RosFastDds, DatagramsOfAStrangerDoNotEndTheSide) {
  constexpr std::size_t kStatistics = 56;
  Program run = Run({"--paused"});
  run.WaitForLine(", ready");
  Program before = Caller({"parameters", "/r0/robot"});
  EXPECT_EQ(before.Wait(), 0) << before.output();
  const std::vector<pid_t> sides = SidesOf(run);
  ASSERT_EQ(sides.size(), 1u);
  const Stranger stranger;
  const Datagram statistics = WithSubmessage(0x80, 1, Datagram(kStatistics + 4, 0), kStatistics);
  ASSERT_EQ(statistics.size(), 84u);
  stranger.Send(statistics);
  Datagram heartbeat(28, 0);
  heartbeat[2] = 1, heartbeat[3] = 0xc7, heartbeat[6] = 1, heartbeat[7] = 0xc2;  // from a participant's announcer
  heartbeat[16] = heartbeat[17] = heartbeat[18] = heartbeat[19] = 0xff;          // up to -1
  stranger.Send(WithSubmessage(0x07, 1, heartbeat, heartbeat.size()));
  std::fill(heartbeat.begin() + 8, heartbeat.begin() + 24, std::uint8_t{0x7f});
  stranger.Send(WithSubmessage(0x07, 1, heartbeat, heartbeat.size()));
  stranger.Send(WithSubmessage(0x08, 1, heartbeat, heartbeat.size()));
  for (std::uint64_t kind = 0; kind < 256; ++kind) {
    for (std::uint64_t i = 0; i < 16; ++i) {
      Datagram body(4 * (RandomBits({kind, i, 0}) % 25));
      for (std::size_t k = 0; k < body.size(); ++k) {
        const std::uint64_t bits = RandomBits({kind, i, 1 + k});
        body[k] = static_cast<std::uint8_t>(bits % 3 == 0 ? bits >> 8U : bits % 3 == 1 ? 0 : 0xff);
      }
      const std::size_t lengths[] = {body.size(), 0, kStatistics, body.size() + 4};
      stranger.Send(
          WithSubmessage(static_cast<std::uint8_t>(kind), static_cast<std::uint8_t>(i), body, lengths[i % 4]));
    }
  }
  Program after = Caller({"parameters", "/r0/robot"});
  EXPECT_EQ(after.Wait(), 0) << after.output();
  EXPECT_EQ(SidesOf(run), sides) << run.output();
  End(run);
}

TEST_F(RosFastDds, FollowsRobotsThatAreSpawnedAndDeleted) {
  const std::string session = TestSession("fast-dds");
  Program run = Run({"--paused", "--session", session});
  run.WaitForLine(", ready");
  const auto edit = [&](std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "ctl");
    arguments.insert(arguments.end(), {"--session", session, "--domain", std::to_string(TestDomain())});
    OutputOf(Troupe(std::move(arguments)));
  };
  edit({"spawn", "rover", "--name", "late", "--pose", "0.5,-2,0,0"});
  Program caller = Caller({"leaves", "/late/robot"});
  EXPECT_THAT(caller.WaitForLine("parameters"), HasSubstr("use_sim_time"));
  edit({"delete", "late"});
  EXPECT_EQ(caller.Wait(), 0) << caller.output();
  EXPECT_THAT(caller.output(), HasSubstr("gone"));
  Program other = Caller({"parameters", "/r0/robot"});
  EXPECT_EQ(other.Wait(), 0) << other.output();
  EXPECT_THAT(other.output(), HasSubstr("use_sim_time"));
  End(run);
}

// As `ros2 service list` of rmw_fastrtps_cpp reads it from discovery. Endpoints on Cyclone DDS, which match clients of
// later versions of Fast DDS, too, come with the first program on Cyclone.
TEST_F(RosFastDds, AClientOnFastDdsDiscoversOneServerOfEachService) {
  Program run = Run({"--paused", "--ros-distro", "jazzy"});
  run.WaitForLine(", ready");
  Program caller = Caller({"endpoints"});
  for (const char* service : {"reset", "world/simulate_steps/_action/get_result", "world/get_type_description",
                              "r0/robot/list_parameters", "r3/robot/get_parameters"}) {
    caller.WaitForLine("rq/" + std::string(service) + "Request");
    caller.WaitForLine("rr/" + std::string(service) + "Reply");
  }
  std::map<std::string, int> found;
  for (const json& line : LinesOn(caller, "found")) {
    EXPECT_EQ(++found[line["on"]], 1) << line;
    EXPECT_EQ(line["partitions"], "") << line;
    EXPECT_THAT(line["user_data"].get<std::string>(), HasSubstr("typehash=RIHS01_")) << line;
  }
  EXPECT_GT(found.size(), 60u);
  EXPECT_THAT(
      caller.output(),
      HasSubstr(
          R"("on":"rq/resetRequest","partitions":"","topic":"found","type":"std_srvs::srv::dds_::Empty_Request_")"));
  const ros::RosParticipant on_cyclone(TestRosNetwork());
  caller.WaitForLine(R"("on":"rq/resetRequest","partitions":"*")");
  caller.Signal(SIGTERM);
  caller.Wait();
  End(run);
}

// Else ROS from Iron on prints warnings in each of its commands.
TEST_F(RosFastDds, AllEndpointsOnCycloneHaveTypeHashes) {
  Program run = Run({"--paused", "--ros-distro", "jazzy"});
  run.WaitForLine(", ready");
  RosGraph graph;
  std::multimap<std::string, std::string> user_data;
  EXPECT_TRUE(Eventually([&] {
    user_data = graph.UserData();
    return user_data.count("rq/world/step_simulationRequest") == 1 &&
           user_data.count("rr/world/step_simulationReply") == 1 && user_data.count("rt/r3/odom") == 1;
  }));
  for (const auto& [topic, data] : user_data) {
    if (topic.starts_with("DCPS")) continue;
    EXPECT_THAT(data, HasSubstr("typehash=RIHS01_")) << topic;
  }
  End(run);
}

TEST_F(RosFastDds, ServesARunInOneProcess) {
  Program run = Run({"--paused", "--in-process"});
  run.WaitForLine(", ready");
  Program steps = Caller({"simulate", "20"});
  EXPECT_EQ(steps.Wait(), 0) << steps.output();
  ASSERT_EQ(SidesOf(run).size(), 1u);
  kill(SidesOf(run).front(), SIGKILL);
  run.WaitForLine("it is started again");
  Program parameters = Caller({"parameters", "/r0/robot"});
  EXPECT_EQ(parameters.Wait(), 0) << parameters.output();
  End(run);
}

TEST_F(RosFastDds, RunsWithoutFastDdsOnRequest) {
  Program run = Run({"--paused", "--ros-services", "cyclone"});
  run.WaitForLine(", ready");
  EXPECT_TRUE(SidesOf(run).empty());
  End(run);
}

}  // namespace
}  // namespace troupe::test
