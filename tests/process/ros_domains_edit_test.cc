// ROS domains of robots that come during a run, by a spawn or with another world, in a network of the test's own: the
// robots are there under plain names, and clients on both implementations of DDS call their services.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <vector>

#include "ros/connection/topic_types.h"
#include "tests/process/programs.h"
#include "tests/support/dds_domain.h"
#include "tests/support/files.h"
#include "tests/support/own_network.h"
#include "tests/support/ros_client.h"
#include "tests/support/ros_domain.h"
#include "tests/support/ros_graph.h"

namespace troupe::test {
namespace {

using testing::HasSubstr;

class RosDomainsEdit : public testing::Test {
 protected:
  void SetUp() override {
    if (!HasNetworkOfItsOwn()) GTEST_SKIP() << "needs root and network namespaces";
    Write("fleet.json",
          R"("spawn": [{"model": "rover", "count": 3, "region": [4, -9, 20, 9], "ros_domain": {"each": 1}}])");
    Write("other.json", R"("robots": [{"name": "r0", "ros_domain": 70}])");
  }
  void TearDown() override {
    if (!run_) return;
    run_->Interrupt();
  }

  void Start(std::vector<std::string> more = {}) {
    run_.emplace(Troupe(
        Words("run % --headless --paused --session % --domain % --ros-interface lo --ros-domain %",
              {folder_.Path("fleet.json"), session_, std::to_string(kSimulationDomain), std::to_string(kRunDomain)}) +
        more));
    run_->WaitForLine(", ready");
  }
  Finished Ctl(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), "ctl");
    arguments.insert(arguments.end(), {"--session", session_, "--domain", std::to_string(kSimulationDomain)});
    return Finish(Troupe(std::move(arguments)));
  }
  void Edit(std::vector<std::string> arguments) const { OutputOf(Ctl(std::move(arguments))); }
  static bool HasPlainRobot(std::uint32_t domain) {
    RosGraph graph(InDomain(domain));
    return Eventually([&] { return graph.Nodes() == std::vector<std::string>{"/robot"}; }) &&
           Eventually([&] { return graph.Topics("/").contains("/scan"); });
  }
  static bool HasFastDdsCaller() { return ros::HasFastDds() && std::filesystem::exists(ProgramPath("fastdds_caller")); }
  static Program Caller(std::uint32_t domain, const std::string& what) {
    return Program({ProgramPath("fastdds_caller"), std::to_string(domain), what, "/robot"});
  }
  static void ExpectAnswersFastDds(std::uint32_t domain) {
    if (!HasFastDdsCaller()) return;
    Program caller = Caller(domain, "parameters");
    EXPECT_EQ(caller.Wait(), 0) << caller.output();
    EXPECT_THAT(caller.output(), HasSubstr("use_sim_time")) << domain;
  }

  TemporaryFolder folder_;
  const std::string session_ = TestSession("domains-edit");
  std::optional<Program> run_;

 private:
  void Write(const std::string& name, const std::string& content) const {
    std::ofstream(folder_.Path(name)) << R"({"world": ")" << WorldPath("pen.world") << R"(", "ros": true, )" << content
                                      << "}";
  }
};

TEST_F(RosDomainsEdit, ASpawnedRobotHasTheNextDomainOfItsRule) {
  Start();
  Edit({"spawn", "rover", "--name", "late", "--pose", "-6,0,0"});
  EXPECT_TRUE(HasPlainRobot(kFirstDomain + 3));
  ExpectAnswersFastDds(kFirstDomain + 3);
  // A deleted robot's domain is free.
  Edit({"delete", "rover1"});
  Edit({"spawn", "rover", "--name", "later", "--pose", "-6,2,0"});
  EXPECT_TRUE(HasPlainRobot(kFirstDomain + 1));
  ExpectAnswersFastDds(kFirstDomain + 1);
}

TEST_F(RosDomainsEdit, ASpawnRequestNamesADomain) {
  Start();
  Edit({"spawn", "rover", "--name", "late", "--pose", "-6,0,0", "--ros-domain", "60"});
  EXPECT_TRUE(HasPlainRobot(60));
  ExpectAnswersFastDds(60);
  const auto refusal = [&](const std::string& domain, const std::string& model = "rover") {
    const Finished refused = Ctl({"spawn", model, "--pose", "-6,3,0", "--ros-domain", domain});
    EXPECT_NE(refused.exit_status, 0) << domain;
    return refused.output;
  };
  EXPECT_THAT(refusal("60"), HasSubstr("found the ROS domain 60 for robot 'rover', which robot 'late' has already"));
  EXPECT_THAT(refusal("95"),
              HasSubstr("found the ROS domain 95 for robot 'rover', which is the domain of the simulation"));
  EXPECT_THAT(refusal("231"), HasSubstr("found '231', expected"));
  EXPECT_THAT(refusal("61", "wall"), HasSubstr("found a ROS domain for a model that is no robot"));
}

TEST_F(RosDomainsEdit, RobotsOfALoadedWorldHaveItsDomains) {
  Start();
  ASSERT_TRUE(HasPlainRobot(kFirstDomain));
  Edit({"load", folder_.Path("other.json")});
  EXPECT_TRUE(HasPlainRobot(70));
  ExpectAnswersFastDds(70);
  RosGraph before(InDomain(kFirstDomain));
  EXPECT_TRUE(Eventually([&] { return before.Nodes().empty() && before.Topics("/").empty(); }));
  RosGraph of_run(InDomain(kRunDomain));
  std::vector<std::string> nodes;
  EXPECT_TRUE(Eventually([&] {
    return (nodes = of_run.Nodes()) == std::vector<std::string>{"/r1/robot", "/r2/robot", "/r3/robot", "/world"};
  })) << testing::PrintToString(nodes);
  // And back.
  Edit({"load", folder_.Path("fleet.json")});
  EXPECT_TRUE(HasPlainRobot(kFirstDomain + 2));
  ExpectAnswersFastDds(kFirstDomain + 2);
}

TEST_F(RosDomainsEdit, AServiceOfRosSpawnsRobotsWithDomains) {
  Start();
  const ros::RosParticipant participant(InDomain(kRunDomain));
  TROUPE_SIMULATION_CLIENT(SpawnEntity) client(participant, "/world/spawn_entity");
  const auto spawn = [&](const char* uri, const char* text, double x) {
    simulation_interfaces_srv_dds__SpawnEntity_Request_ request{};
    request.name = const_cast<char*>(uri[0] == '\0' ? "written" : "late");
    request.uri = const_cast<char*>(uri);
    request.resource_string = const_cast<char*>(text);
    request.entity_namespace = const_cast<char*>("");
    request.initial_pose.header.frame_id = const_cast<char*>("map");
    request.initial_pose.pose.position.x = x;
    request.initial_pose.pose.orientation.w = 1.0;
    client.Call(request,
                [](const auto& response) { EXPECT_EQ(response.result.result, 1) << response.result.error_message; });
  };
  spawn("rover", "", -6.0);
  EXPECT_TRUE(HasPlainRobot(kFirstDomain + 3));
  spawn(
      "",
      R"({"robots": [{"model": "position", "name": "a", "ros_domain": 61, "properties": {"size": [0.4, 0.4, 0.3]}}]})",
      -8.0);
  RosGraph graph(InDomain(61));
  EXPECT_TRUE(Eventually([&] { return graph.Nodes() == std::vector<std::string>{"/robot"}; }));
}

// Fast DDS learns of the end by a notice, not by the lease of 10 s.
TEST_F(RosDomainsEdit, TheServicesOfADeletedRobotDisappearAtOnce) {
  if (!HasFastDdsCaller()) GTEST_SKIP() << "needs libfastrtps-dev and fastddsgen";
  for (const bool of_its_own : {false, true}) {
    SCOPED_TRACE(of_its_own ? "in a domain of its own" : "in the domain of the run");
    Start(of_its_own ? std::vector<std::string>() : std::vector<std::string>{"--robots-per-process", "2"});
    const std::string robot = of_its_own ? "rover0" : "r1";
    Program caller = of_its_own
                         ? Caller(kFirstDomain, "leaves")
                         : Program({ProgramPath("fastdds_caller"), std::to_string(kRunDomain), "leaves", "/r1/robot"});
    caller.WaitForLine("parameters");
    Edit({"delete", robot});
    const auto deleted = std::chrono::steady_clock::now();
    EXPECT_EQ(caller.Wait(), 0) << caller.output();
    EXPECT_THAT(caller.output(), HasSubstr("gone"));
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - deleted).count();
    EXPECT_LT(seconds, 5.0);
    RecordProperty(of_its_own ? "own" : "shared", std::to_string(seconds));
    TearDown();
    run_.reset();
  }
}

}  // namespace
}  // namespace troupe::test
