// `troupe keys`.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "common/base/paths.h"
#include "tests/process/programs.h"
#include "tests/support/dds_domain.h"
#include "tests/support/files.h"
#include "transport/protocol/message_texts.h"

namespace troupe::test {
namespace {

using testing::HasSubstr;

TEST(Keys, MakesAnIdentityForEachRole) {
  const TemporaryFolder folder;
  const std::string keys = folder.Path("keys");
  const std::string made = OutputOf(Troupe({"keys", "make", "--robots", "r0,r1", "--agent", "r2,r3", keys}));
  const std::vector<std::string> agents = {AgentName({"r0"}), AgentName({"r1"}), AgentName({"r2", "r3"})};
  EXPECT_EQ(made, "authority: " + keys + "/authority\n" + "service: " + keys + "/service\n" + "operator: " + keys +
                      "/operator\n" + "observer: " + keys + "/observer\n" + "agent of r2, r3: " + keys + "/agents/" +
                      agents[2] + "\nagent of r0: " + keys + "/agents/" + agents[0] + "\nagent of r1: " + keys +
                      "/agents/" + agents[1] + "\n");
  for (const char* role : {"service", "operator", "observer"}) EXPECT_TRUE(CheckEnclave(keys + "/" + role).ok());
  for (const std::string& agent : agents) EXPECT_TRUE(CheckEnclave(keys + "/agents/" + agent).ok());
}

TEST(Keys, AddsTheMissingOnes) {
  const TemporaryFolder folder;
  const std::string keys = folder.Path("keys");
  EXPECT_EQ(Finish(Troupe({"keys", "make", keys, "--robots", "r0"})).exit_status, 0);
  const std::string service = folder.Read("keys/service/key.pem");
  const std::string again = OutputOf(Troupe({"keys", "make", keys, "--robots", "r0,r1"}));
  EXPECT_THAT(again, HasSubstr("agent of r0: " + keys + "/agents/" + AgentName({"r0"}) + " (kept)\n"));
  EXPECT_THAT(again, HasSubstr("agent of r1: " + keys + "/agents/" + AgentName({"r1"}) + "\n"));
  EXPECT_EQ(folder.Read("keys/service/key.pem"), service);
  EXPECT_EQ(folder.Read("keys/service/identity_ca.cert.pem"),
            folder.Read("keys/agents/" + AgentName({"r1"}) + "/identity_ca.cert.pem"));
}

TEST(Keys, BadUsageEndsWithOneErrorLineAndStatus2) {
  const TemporaryFolder folder;
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
    const std::string made = OutputOf(Troupe(usage.arguments), 2);
    EXPECT_THAT(made, HasSubstr(usage.message));
    EXPECT_EQ(std::count(made.begin(), made.end(), '\n'), 1);
  }
  EXPECT_EQ(folder.size(), 1u) << "nothing was made";
}

TEST(Keys, AServiceThatIsStartedByHandMakesNone) {
  EXPECT_THAT(OutputOf(Program({ProgramPath("world-service"), WorldPath("pen.world"), "--session", "by-hand",
                                "--security", "on"}),
                       2),
              HasSubstr("--security: found 'on', expected a folder of keys, auto or off"));
}

TEST(Keys, AToolThatNeedsThemFailsWithoutThem) {
  const std::string domain = std::to_string(TestDomain());
  EXPECT_THAT(
      OutputOf(Troupe(Words("ctl status --session no-such-run --domain % --security on --timeout 0.3", {domain})), 3),
      HasSubstr("no run of session 'no-such-run' has published keys"));
  EXPECT_THAT(OutputOf(Program({ProgramPath("robot-agent"), "--robot", "r0", "--session", "no-such-run", "--domain",
                                domain, "--security", "on"}),
                       3),
              HasSubstr("no run of session 'no-such-run' has published keys"));
}

}  // namespace
}  // namespace troupe::test
