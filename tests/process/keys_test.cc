// `troupe keys`.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "common/base/enclave.h"
#include "tests/process/output_folder.h"
#include "tests/process/programs.h"
#include "tests/support/dds_domain.h"
#include "transport/protocol/agent_name.h"

namespace troupe::test {
namespace {

using testing::HasSubstr;

TEST(Keys, MakesAnIdentityForEachRole) {
  const OutputFolder folder;
  const std::string keys = folder.Path("keys");
  const Finished made = Finish(Troupe({"keys", "make", "--robots", "r0,r1", "--agent", "r2,r3", keys}));
  EXPECT_EQ(made.exit_status, 0) << made.output;
  const std::vector<std::string> agents = {AgentName({"r0"}), AgentName({"r1"}), AgentName({"r2", "r3"})};
  EXPECT_EQ(made.output, "authority: " + keys + "/authority\n" + "service: " + keys + "/service\n" +
                             "operator: " + keys + "/operator\n" + "observer: " + keys + "/observer\n" +
                             "agent of r2, r3: " + keys + "/agents/" + agents[2] + "\nagent of r0: " + keys +
                             "/agents/" + agents[0] + "\nagent of r1: " + keys + "/agents/" + agents[1] + "\n");
  for (const char* role : {"service", "operator", "observer"}) EXPECT_TRUE(CheckEnclave(keys + "/" + role).ok());
  for (const std::string& agent : agents) EXPECT_TRUE(CheckEnclave(keys + "/agents/" + agent).ok());
}

TEST(Keys, AddsTheMissingOnes) {
  const OutputFolder folder;
  const std::string keys = folder.Path("keys");
  EXPECT_EQ(Finish(Troupe({"keys", "make", keys, "--robots", "r0"})).exit_status, 0);
  const std::string service = folder.Read("keys/service/key.pem");
  const Finished again = Finish(Troupe({"keys", "make", keys, "--robots", "r0,r1"}));
  EXPECT_EQ(again.exit_status, 0) << again.output;
  EXPECT_THAT(again.output, HasSubstr("agent of r0: " + keys + "/agents/" + AgentName({"r0"}) + " (kept)\n"));
  EXPECT_THAT(again.output, HasSubstr("agent of r1: " + keys + "/agents/" + AgentName({"r1"}) + "\n"));
  EXPECT_EQ(folder.Read("keys/service/key.pem"), service);
  EXPECT_EQ(folder.Read("keys/service/identity_ca.cert.pem"),
            folder.Read("keys/agents/" + AgentName({"r1"}) + "/identity_ca.cert.pem"));
}

TEST(Keys, BadUsageEndsWithOneErrorLineAndStatus2) {
  const OutputFolder folder;
  std::ofstream(folder.Path("file")) << "text";
  const struct {
    std::vector<std::string> arguments;
    std::string message;
  } cases[] = {
      {{"keys"}, "error: A subcommand is required"},
      {{"keys", "make"}, "error: DIR is required"},
      {{"keys", "make", folder.Path("")}, "error: found no authority in it, expected a new folder"},
      {{"keys", "make", folder.Path("file")}, "file: error: found no authority in it"},
      {{"keys", "make", folder.Path("file/keys")}, "error: cannot make the folder"},
      {{"keys", "make", "/proc/none/keys"}, "error: cannot make the folder"},
      {{"keys", "make", folder.Path("keys"), "--robots", ""}, "error: --robots: "},
  };
  for (const auto& usage : cases) {
    const Finished made = Finish(Troupe(usage.arguments));
    EXPECT_EQ(made.exit_status, 2) << made.output;
    EXPECT_THAT(made.output, HasSubstr(usage.message));
    EXPECT_EQ(std::count(made.output.begin(), made.output.end(), '\n'), 1) << made.output;
  }
  EXPECT_EQ(folder.size(), 1u) << "nothing was made";
}

TEST(Keys, AServiceThatIsStartedByHandMakesNone) {
  const Finished service = Finish(
      Program({ProgramPath("world-service"), WorldPath("pen.world"), "--session", "by-hand", "--security", "on"}));
  EXPECT_EQ(service.exit_status, 2) << service.output;
  EXPECT_THAT(service.output, HasSubstr("--security: found 'on', expected a folder of keys, auto or off"));
}

TEST(Keys, AToolThatNeedsThemFailsWithoutThem) {
  const std::string domain = std::to_string(TestDomain());
  const Finished tool = Finish(Troupe(
      {"ctl", "status", "--session", "no-such-run", "--domain", domain, "--security", "on", "--timeout", "0.3"}));
  EXPECT_EQ(tool.exit_status, 3);
  EXPECT_THAT(tool.output, HasSubstr("no run of session 'no-such-run' has published keys"));
  const Finished agent = Finish(Program({ProgramPath("robot-agent"), "--robot", "r0", "--session", "no-such-run",
                                         "--domain", domain, "--security", "on"}));
  EXPECT_EQ(agent.exit_status, 3);
  EXPECT_THAT(agent.output, HasSubstr("no run of session 'no-such-run' has published keys"));
}

}  // namespace
}  // namespace troupe::test
