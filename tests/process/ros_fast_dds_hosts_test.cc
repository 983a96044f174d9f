// The services of a run on an Ethernet interface, called from its own host and from another one by clients on Fast DDS.
// The hosts are network namespaces.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "ros/messages/ros_options.h"
#include "tests/process/programs.h"
#include "tests/support/dds_domain.h"
#include "tests/support/own_network.h"

namespace troupe::test {
namespace {

using testing::HasSubstr;

constexpr const char* kRosDomain = "5";
constexpr const char* kTroupeDomain = "6";

class RosFastDdsHosts : public testing::Test {
 protected:
  void SetUp() override {
    if (!ros::HasFastDds() || !std::filesystem::exists(ProgramPath("fastdds_caller"))) {
      GTEST_SKIP() << "needs libfastrtps-dev and fastddsgen";
    }
    hosts_ = BridgedHosts::Make();
    if (hosts_ == nullptr) GTEST_SKIP() << "needs root, network namespaces and the program ip";
  }

  // On host 1.
  Program Run(const std::vector<std::string>& more) const {
    const BridgedHosts::Visit visit(*hosts_, 1);
    return Troupe(Words("run % --headless --paused --session % --domain % --ros --ros-domain % --ros-services both",
                        {WorldPath("pen.world"), session_, kTroupeDomain, kRosDomain}) +
                  more);
  }
  Program Caller(int host, const std::string& where, std::vector<std::string> arguments) const {
    const BridgedHosts::Visit visit(*hosts_, host);
    arguments.insert(arguments.begin(), {ProgramPath("fastdds_caller"), kRosDomain + ("@" + where)});
    return Program(std::move(arguments));
  }
  void ExpectAnswers(int host) const { ExpectAnswers(host, BridgedHosts::AddressOf(host)); }
  void ExpectAnswers(int host, const std::string& where) const {
    SCOPED_TRACE(host);
    Program states = Caller(host, where, {"states", "100"});
    EXPECT_EQ(states.Wait(), 0) << states.output();
    EXPECT_THAT(states.output(), HasSubstr(R"({"answered":100,"calls":100,"repeated":0,"topic":"called"})"));
    EXPECT_THAT(states.output(), HasSubstr(R"("matched":[1,1])"));
    Program parameters = Caller(host, where, {"parameters", "/r2/robot"});
    EXPECT_EQ(parameters.Wait(), 0) << parameters.output();
    EXPECT_THAT(parameters.output(), HasSubstr("use_sim_time"));
  }
  static void End(Program& run) { run.Interrupt(); }

  const std::string session_ = TestSession("fast-dds-hosts");
  std::unique_ptr<BridgedHosts> hosts_;
};

TEST_F(RosFastDdsHosts, AnswersClientsOnBothHosts) {
  Program run = Run({"--ros-interface", BridgedHosts::kInterface});
  run.WaitForLine(", ready");
  ExpectAnswers(1);
  ExpectAnswers(2);
  End(run);
}

TEST_F(RosFastDdsHosts, ChoosesTheInterfaceByItself) {
  Program run = Run({"--ros-discovery", "subnet"});
  run.WaitForLine(", ready");
  ExpectAnswers(2);
  End(run);
}

// Tools announce the address of the Ethernet interface, and name the loopback address as the one of the run.
TEST_F(RosFastDdsHosts, AnswersJazzyOnLocalhost) {
  Program run = Run({"--ros-discovery", "localhost", "--ros-distro", "jazzy"});
  run.WaitForLine(", ready");
  ExpectAnswers(1, "localhost");
  End(run);
}

}  // namespace
}  // namespace troupe::test
