// `troupe test` and `troupe sweep` as a user runs them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "tests/process/programs.h"
#include "tests/support/files.h"

namespace troupe::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

// Six robots in a row; the third is so fast that it comes near the line x = 4 m within 3 s.
constexpr const char* kRow = R"JSON({
  "ticks": 60,
  "robots": [
    {"name": "r0", "model": "position", "pose": [0, 0, 0], "controller": {"name": "script", "parameters": {"commands": [{"at": 0, "vx": 0.1}]}}},
    {"name": "r1", "model": "position", "pose": [0, 2, 0], "controller": {"name": "script", "parameters": {"commands": [{"at": 0, "vx": 0.1}]}}},
    {"name": "r2", "model": "position", "pose": [0, 4, 0], "controller": {"name": "script", "parameters": {"commands": [{"at": 0, "vx": 0.9}]}}},
    {"name": "r3", "model": "position", "pose": [0, 6, 0], "controller": {"name": "script", "parameters": {"commands": [{"at": 0, "vx": 0.1}]}}},
    {"name": "r4", "model": "position", "pose": [0, 8, 0], "controller": {"name": "script", "parameters": {"commands": [{"at": 0, "vx": 0.1}]}}},
    {"name": "r5", "model": "position", "pose": [0, 10, 0], "controller": {"name": "script", "parameters": {"commands": [{"at": 0, "vx": 0.1}]}}}
  ],
  "vary": {"seed": {"range": [1, 3]}, "robots[r2].controller.parameters.commands[0].vx": [0.2, 0.9, 0.1]},
  "expect": [
    {"name": "slow", "that": "forall r: always x(r) < 2 m"},
    {"name": "moves", "that": "forall r: eventually x(r) > 0.1 m"}
  ],
  "cover": [{"name": "far", "that": "exists r: eventually x(r) > 4 m"}],
  "metrics": {"farthest": "max of x(r)"
}
})JSON";

struct Tested {
  int exit_status = 0;
  std::string output;
};

class FleetTests : public testing::Test {
 protected:
  Tested Run(std::vector<std::string> arguments) {
    Finished finished = Finish(Troupe(std::move(arguments)));
    return {finished.exit_status, finished.output};
  }
  // The command behind "  WORD: troupe ", with its quotes removed.
  static std::vector<std::string> CommandBehind(const std::string& word, const std::string& output) {
    for (const std::string& line : LinesOf(output)) {
      const std::string begin = "  " + word + ": troupe ";
      if (!line.starts_with(begin)) continue;
      std::vector<std::string> arguments(1);
      bool quoted = false;
      for (const char c : line.substr(begin.size())) {
        if (c == '\'') {
          quoted = !quoted;
        } else if (c == ' ' && !quoted) {
          arguments.emplace_back();
        } else {
          arguments.back() += c;
        }
      }
      // Behind the command of a smallest case is its size.
      if (arguments.size() > 4) arguments.resize(4);
      return arguments;
    }
    return {};
  }

  TemporaryFolder folder_;
  const std::string test_ = folder_.Write("row.test.json", kRow);
  const std::string report_ = folder_ / "report";
};

TEST_F(FleetTests, PrintWhatFailsWithItsSmallestCaseAndWhatShowsIt) {
  const Tested tested = Run({"test", test_, "--report", report_, "--junit", folder_ / "junit.xml", "--jobs", "2"});
  EXPECT_EQ(tested.exit_status, 1) << tested.output;
  EXPECT_THAT(tested.output, HasSubstr("6 passed, 3 failed, 0 errors, 0 not run"));
  EXPECT_THAT(tested.output, HasSubstr("FAILED row: seed=1,robots[r2].controller.parameters.commands[0].vx=0.9"));
  EXPECT_THAT(tested.output, HasSubstr("  slow: fails at tick "));
  EXPECT_THAT(tested.output, HasSubstr(" of r2, robustness -"));
  EXPECT_THAT(tested.output, HasSubstr("(1 robot, "));

  // The commands that it prints repeat the case and the smallest one.
  const std::vector<std::string> repeat = CommandBehind("repeat", tested.output);
  ASSERT_EQ(repeat.size(), 4U) << tested.output;
  const Tested again = Run(repeat);
  EXPECT_EQ(again.exit_status, 1) << again.output;
  EXPECT_THAT(again.output, HasSubstr("0 passed, 1 failed"));
  const std::vector<std::string> smallest = CommandBehind("smallest", tested.output);
  ASSERT_EQ(smallest.size(), 4U) << tested.output;
  EXPECT_THAT(smallest[3], AllOf(HasSubstr("without=[\"r0\",\"r1\",\"r3\",\"r4\",\"r5\"]"), HasSubstr("ticks="),
                                 HasSubstr("seed=1,")));
  EXPECT_EQ(Run(smallest).exit_status, 1);

  // The recording replays and has the violation; the page and the tables are there.
  const std::string recording = report_ + "/row-1/run.mcap";
  EXPECT_EQ(Run({"replay", recording, "--verify"}).exit_status, 0);
  const Tested on = Run({"test", test_, "--on", recording});
  EXPECT_EQ(on.exit_status, 1) << on.output;
  EXPECT_THAT(on.output, HasSubstr("FAILS slow: robustness -"));
  EXPECT_TRUE(std::filesystem::exists(report_ + "/row-1/violation.png"));
  EXPECT_THAT(TextOf(report_ + "/index.html"),
              AllOf(HasSubstr("3 failed"), HasSubstr("<svg"), Not(HasSubstr("http://localhost"))));
  EXPECT_EQ(LinesOf(TextOf(report_ + "/cases.csv")).size(), 10U);
  EXPECT_THAT(folder_.Read("junit.xml"), HasSubstr("tests=\"9\" failures=\"3\" errors=\"0\""));
}

TEST_F(FleetTests, RunCasesThatHaveFailedFirst) {
  Run({"test", test_, "--report", report_});
  const std::string kept = folder_.Read("row.test.failing");
  EXPECT_THAT(kept, HasSubstr("seed=1,"));
  const Tested again = Run({"test", test_, "--report", report_, "--no-shrink"});
  EXPECT_THAT(again.output, HasSubstr("not run in"));
  EXPECT_EQ(again.output.find("FAILED row: seed=1,robots[r2].controller.parameters.commands[0].vx=0.9,ticks="), 0U)
      << again.output;
}

TEST_F(FleetTests, SameVerdictsAndHashesWithAnyJobsShardsAndProcesses) {
  Run({"sweep", test_, "-o", folder_ / "whole", "--jobs", "1"});
  EXPECT_EQ(Run({"sweep", test_, "-o", folder_ / "two", "--jobs", "2"}).exit_status, 0);
  EXPECT_EQ(Run({"sweep", test_, "-o", folder_ / "a", "--shard", "1/2"}).exit_status, 0);
  EXPECT_EQ(Run({"sweep", test_, "-o", folder_ / "b", "--shard", "2/2"}).exit_status, 0);
  EXPECT_EQ(Run({"sweep", "--merge", folder_ / "a", folder_ / "b", "-o", folder_ / "merged"}).exit_status, 0);
  const std::string csv = folder_.Read("whole/cases.csv");
  EXPECT_EQ(LinesOf(csv).size(), 10U);
  for (const char* const name : {"two", "merged"})
    EXPECT_EQ(folder_.Read(std::string(name) + "/cases.csv"), csv) << name;
  EXPECT_EQ(folder_.Read("merged/index.html"), folder_.Read("whole/index.html"));
  const Tested processes = Run({"test", test_, "--processes", "--case", "seed=2", "--no-shrink", "--report", report_});
  EXPECT_THAT(processes.output, HasSubstr("2 passed, 1 failed, 0 errors")) << processes.output;
}

TEST_F(FleetTests, SearchEndsWithTheFirstCaseThatFails) {
  std::string text = kRow;
  const std::string values = "[0.2, 0.9, 0.1]";
  text.replace(text.find(values), values.size(), "{\"uniform\": [0.05, 0.4]}");
  const std::string path = folder_.Write("search.test.json", text);
  const Tested tested = Run({"test", path, "--search", "60", "--report", report_, "--jobs", "1"});
  EXPECT_EQ(tested.exit_status, 1) << tested.output;
  EXPECT_THAT(tested.output, HasSubstr(" 1 failed"));
}

TEST_F(FleetTests, EndWithTheStatusOfTheManual) {
  const std::string missing = folder_.Write("missing.test.json", R"({"ticks": 3, "expect": ["always spedd > 1"]})");
  EXPECT_EQ(Run({"test", missing}).exit_status, 2);
  EXPECT_EQ(Run({"test", folder_ / "none.test.json"}).exit_status, 2);
  EXPECT_EQ(Run({"test", test_, "--case", "seed=9"}).exit_status, 2);
  EXPECT_EQ(Run({"test", test_, "--shard", "3/2"}).exit_status, 2);
  std::filesystem::create_directory(folder_ / "empty");
  EXPECT_EQ(Run({"test", folder_ / "empty"}).exit_status, 2);
  EXPECT_EQ(Run({"sweep", "-o", folder_ / "sweep"}).exit_status, 2);
  EXPECT_EQ(Run({"test", test_, "--case", "robots[r2].controller.parameters.commands[0].vx=0.2", "--report", report_})
                .exit_status,
            0);
  // A case whose scenario does not load is an error of that case.
  const std::string bad = folder_.Write(
      "bad.test.json",
      R"({"ticks": 3, "robots": [{"name": "a", "model": "position"}], "vary": {"robots[a].model": ["position", "none"]},
                           "expect": ["tick < 9"]})");
  const Tested tested = Run({"test", bad, "--report", report_});
  EXPECT_EQ(tested.exit_status, 3) << tested.output;
  EXPECT_THAT(tested.output, HasSubstr("1 passed, 0 failed, 1 errors"));
}

TEST_F(FleetTests, CtrlCKeepsTheCasesThatHaveFinished) {
  std::string text = kRow;
  text.replace(text.find("[1, 3]"), 6, "[1, 9000]");
  const std::string path = folder_.Write("long.test.json", text);
  Program program = Troupe({"sweep", path, "-o", folder_ / "sweep", "--jobs", "1"});
  // Once a worker runs.
  while (ChildrenOf(program.pid()).empty()) ASSERT_FALSE(program.HasEnded()) << program.output();
  program.Signal(SIGINT);
  EXPECT_EQ(program.Wait(), 130);
  EXPECT_THAT(program.output(), HasSubstr(" not run in"));
  EXPECT_NE(TextOf(folder_ / "sweep/cases.jsonl"), "");
}

}  // namespace
}  // namespace troupe::test
