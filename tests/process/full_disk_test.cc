// A disk that fills up during a run: one line with the file's name, status 3 at once, and the written data are kept.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <nlohmann/json.hpp>
#include <sstream>

#include "launcher/hosts/host.h"
#include "tests/process/programs.h"
#include "tests/support/dds_domain.h"
#include "tests/support/files.h"

namespace troupe::test {
namespace {

using testing::HasSubstr;
using testing::Not;

struct Case {
  std::string option;
  bool in_process;
};

class FullDisk : public testing::TestWithParam<Case> {
 protected:
  // A run without end, with its output at this path.
  static std::string RunCommand(const std::string& output) {
    std::vector<std::string> command = {
        ProgramPath("troupe"), "run",    WorldPath("pen.world"), "--domain",        std::to_string(TestDomain()),
        "--controller",        "wander", "--headless",           GetParam().option, output};
    if (GetParam().in_process) command.emplace_back("--in-process");
    return ShellQuoted(command);
  }
  static Finished RunInShell(const std::string& script) { return Finish(Program({"/bin/sh", "-c", script})); }

  static void ExpectOneErrorAbout(const std::string& file, const std::string& reason, const Finished& run) {
    EXPECT_EQ(run.exit_status, 3) << run.output;
    EXPECT_THAT(run.output, HasSubstr("\n" + file + ": error: cannot write")) << run.output;
    EXPECT_THAT(run.output, HasSubstr(reason));
    EXPECT_THAT(run.output, Not(HasSubstr("/proc/")));
    EXPECT_THAT(run.output, Not(HasSubstr("restart"))) << "another attempt would fail as well";
    int errors = 0;
    for (const std::string& line : LinesOf(run.output)) errors += line.find("error: ") != std::string::npos ? 1 : 0;
    EXPECT_EQ(errors, 1) << run.output;
  }

  // Whole lines of JSON from the first on, but for the last one; of a trace without its brackets.
  static void ExpectLines(const std::string& text, std::size_t least_bytes) {
    EXPECT_GE(text.size(), least_bytes);
    std::istringstream lines(text);
    int last_tick = 0;
    for (std::string line; std::getline(lines, line) && !lines.eof();) {
      if (line == "[" || line == "]") continue;
      if (line.ends_with(',')) line.pop_back();
      const nlohmann::json object = nlohmann::json::parse(line, nullptr, false);
      ASSERT_TRUE(object.is_object()) << line;
      if (GetParam().option != "--scans") continue;
      EXPECT_GE(object["tick"], last_tick);
      last_tick = object["tick"];
    }
  }

  TemporaryFolder folder_;
};

TEST_P(FullDisk, ALimitOfTheFileSizeEndsTheRun) {
  const std::string file = folder_.Path("output");
  ExpectOneErrorAbout(file, "File too large", RunInShell("ulimit -f 200; exec " + RunCommand(file)));
  ExpectLines(folder_.Read("output"), 50'000);
}

TEST_P(FullDisk, ASmallFileSystemEndsTheRun) {
  // A file system of the test's own needs the rights of root, at least in a namespace of users, which a process in a
  // chroot cannot make.
  const std::string mount = "mount -t tmpfs -o size=2m none " + folder_.Path("disk");
  std::filesystem::create_directory(folder_.Path("disk"));
  const std::string in_namespace =
      std::string("unshare --mount ") + (geteuid() == 0 ? "" : "--map-root-user ") + "/bin/sh -c ";
  if (RunInShell(in_namespace + ShellQuoted(mount)).exit_status != 0) GTEST_SKIP() << "cannot mount a file system";
  const std::string file = folder_.Path("disk/output");
  const std::string script = mount + " || exit 99; " + RunCommand(file) + "; status=$?; cp " + file + " " +
                             folder_.Path("kept") + "; exit $status";
  ExpectOneErrorAbout(file, "No space left on device", RunInShell(in_namespace + ShellQuoted(script)));
  ExpectLines(folder_.Read("kept"), 1'000'000);
}

INSTANTIATE_TEST_SUITE_P(Outputs, FullDisk,
                         testing::Values(Case{"--scans", false}, Case{"--scans", true}, Case{"--trace", false},
                                         Case{"--trace", true}, Case{"--record", false}, Case{"--record", true}),
                         [](const testing::TestParamInfo<Case>& test_case) {
                           return test_case.param.option.substr(2) + (test_case.param.in_process ? "InProcess" : "");
                         });

}  // namespace
}  // namespace troupe::test
