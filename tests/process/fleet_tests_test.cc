// `troupe test` and `troupe sweep` as a user runs them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <filesystem>
#include <map>
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
  "metrics": {"farthest": "max of x(r)"},
  "heat": ["robots", "waits"]
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

  static std::string Between(const std::string& text, const std::string& before, const std::string& after) {
    const std::size_t begin = text.find(before);
    if (begin == std::string::npos) return "none";
    return text.substr(begin + before.size(), text.find(after, begin + before.size()) - begin - before.size());
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
  const Tested smaller = Run(smallest);
  EXPECT_EQ(smaller.exit_status, 1);

  // The recording replays and has the violation; the page and the tables are there.
  const std::string recording = report_ + "/row-1/run.mcap";
  EXPECT_EQ(Run({"replay", recording, "--verify"}).exit_status, 0);
  const Tested on = Run({"test", test_, "--on", recording});
  EXPECT_EQ(on.exit_status, 1) << on.output;
  // The verdict of the live run, to the last digit that is printed.
  const std::string tick = Between(smaller.output, "fails at tick ", " of r2");
  const std::string robustness = Between(smaller.output, "of r2, robustness ", "\n");
  EXPECT_THAT(on.output, HasSubstr("FAILS slow: robustness " + robustness + ", decided by tick " + tick + " and r2"));
  const Tested reported =
      Run({"test", test_, "--on", recording, "--junit", folder_ / "on.xml", "--report", folder_ / "on"});
  EXPECT_EQ(reported.exit_status, 1) << reported.output;
  EXPECT_THAT(folder_.Read("on.xml"), AllOf(HasSubstr("<failure message=\"slow: fails at tick "), HasSubstr(" --on ")));
  EXPECT_THAT(folder_.Read("on/index.html"), HasSubstr("1 of 1 cases of its design"));
  EXPECT_TRUE(std::filesystem::exists(report_ + "/row-1/violation.png"));
  // The scenario of the case stands alone, with the expectations: the page shows a row for each.
  EXPECT_THAT(Run({"check", report_ + "/row-1/scenario.json"}).output, HasSubstr("  expect slow: "));
  EXPECT_THAT(TextOf(report_ + "/index.html"),
              AllOf(HasSubstr("3 failed"), HasSubstr("<svg"), Not(HasSubstr("http://localhost"))));
  EXPECT_EQ(LinesOf(TextOf(report_ + "/cases.csv")).size(), 10U);
  EXPECT_THAT(folder_.Read("junit.xml"),
              AllOf(HasSubstr("tests=\"9\" failures=\"3\" errors=\"0\""), HasSubstr("\nsmallest: troupe test "),
                    HasSubstr("\nrecording: " + recording + "\n")));
}

// Whatever becomes of the scenario: its expectations and regions are in the recording.
TEST(RecordedExpectations, AreThoseOfTheRun) {
  TemporaryFolder folder;
  folder.Write("w.world", "position ( name \"r\" pose [1 0 0 0] )\n");
  const auto write = [&](const char* region, const char* speed) {
    return folder.Write(
        "s.json", R"({"world": "w.world", "ticks": 5, "regions": [{"name": "zone", "region": )" + std::string(region) +
                      R"(}], "expect": [{"name": "slow", "that": "always speed(r) < )" + speed + R"( m/s"}]})");
  };
  const std::string scenario = write("[0, -1, 2, 1]", "2");
  const std::string test =
      folder.Write("zone.test.json",
                   R"~({"scenario": "s.json", "expect": [{"name": "inside", "that": "always in(r, \"zone\")"}]})~");
  const std::string recording = folder.Path("run.mcap");
  OutputOf(Troupe({"run", scenario, "--in-process", "--headless", "--no-ros", "--record", recording}));
  write("[5, 5, 6, 6]", "7");
  EXPECT_THAT(OutputOf(Troupe({"test", test, "--no-shrink", "--report", folder.Path("report")}), 1),
              HasSubstr("1 failed"));
  EXPECT_THAT(OutputOf(Troupe({"test", test, "--on", recording})), HasSubstr("holds inside"));
  EXPECT_THAT(OutputOf(Troupe({"check", recording})), HasSubstr("  expect slow: always speed(r) < 2 m/s\n"));
  std::filesystem::remove(folder.Path("w.world"));
  EXPECT_THAT(OutputOf(Troupe({"test", test, "--on", recording})), HasSubstr("holds inside"));
}

TEST_F(FleetTests, RunCasesThatHaveFailedFirst) {
  Run({"test", test_, "--report", report_});
  // Whole cases of the design, each of which fails.
  const std::string kept = folder_.Read("row.test.failing");
  for (const char* const seed : {"1", "2", "3"}) {
    EXPECT_THAT(kept,
                HasSubstr(std::string("\nseed=") + seed + ",robots[r2].controller.parameters.commands[0].vx=0.9\n"));
  }
  EXPECT_EQ(LinesOf(kept).size(), 4U);
  const Tested again = Run({"test", test_, "--report", report_, "--no-shrink"});
  EXPECT_EQ(again.output.find("FAILED row: seed=1,robots[r2].controller.parameters.commands[0].vx=0.9\n"), 0U)
      << again.output;
  EXPECT_THAT(again.output, HasSubstr("6 passed, 3 failed, 0 errors, 0 not run in"));
  EXPECT_EQ(LinesOf(TextOf(report_ + "/cases.csv")).size(), 10U);
  EXPECT_EQ(folder_.Read("row.test.failing"), kept);
}

// Its smallest case is too short for another expectation, which would fail for ever.
TEST_F(FleetTests, AKeptCasePassesOnceTheFaultIsMended) {
  Run({"test", test_, "--report", report_});
  std::string text = kRow;
  text.replace(text.find("x(r) < 2 m"), 10, "x(r) < 9 m");
  folder_.Write("row.test.json", text);
  const Tested mended = Run({"test", test_, "--report", report_});
  EXPECT_EQ(mended.exit_status, 0) << mended.output;
  EXPECT_THAT(mended.output, HasSubstr("9 passed, 0 failed, 0 errors, 0 not run"));
  EXPECT_EQ(LinesOf(folder_.Read("row.test.failing")).size(), 4U) << "a mended fault stays mended";
}

TEST_F(FleetTests, LeaveTheLinesOfTheFileOfKeptCasesToTheUser) {
  const std::string lines =
      "# found in the field, see #17\r\n"
      "seed=7,robots[r2].controller.parameters.commands[0].vx=0.9\n"
      "  robots[r2].controller.parameters.commands[0].vx=0.1,seed=2,ticks=3\n"
      "\n# no line end follows\nseed=1";
  folder_.Write("row.test.failing", lines);
  const Tested tested = Run({"test", test_, "--report", report_});
  EXPECT_EQ(tested.exit_status, 1) << tested.output;
  EXPECT_THAT(tested.output,
              AllOf(HasSubstr("row.test.failing:2:1: warning: found seed=7,"),
                    HasSubstr("row.test.failing:3:1: warning: found 'ticks', which 'vary' does not have; the whole"),
                    HasSubstr("row.test.failing:6:1: warning: found seed=1, no case of the test; it is not run"),
                    HasSubstr("6 passed, 3 failed, 0 errors, 0 not run")));
  EXPECT_THAT(tested.output, Not(HasSubstr("kept cases:")));
  const std::string after = folder_.Read("row.test.failing");
  EXPECT_EQ(after.find(lines + "\nseed=1,robots[r2]"), 0U) << after;
  EXPECT_EQ(LinesOf(after).size(), LinesOf(lines).size() + 3U);
}

TEST_F(FleetTests, ShardsAddTheirFailingCasesToOneFile) {
  Program first = Troupe({"test", test_, "--shard", "1/2", "--report", folder_ / "a"});
  EXPECT_EQ(Run({"test", test_, "--shard", "2/2", "--report", folder_ / "b"}).exit_status, 1);
  EXPECT_EQ(first.Wait(), 1);
  const std::string kept = folder_.Read("row.test.failing");
  EXPECT_EQ(LinesOf(kept).size(), 4U) << kept;
}

TEST_F(FleetTests, CountAKeptCaseOfTheDesignOnce) {
  for (int i = 0; i < 2; ++i) {
    const Tested tested = Run({"test", test_, "--no-shrink", "--report", report_, "--jobs", "1"});
    EXPECT_THAT(tested.output, HasSubstr("\n6 passed, 3 failed, 0 errors, 0 not run in")) << tested.output;
    EXPECT_THAT(tested.output, Not(HasSubstr("kept cases")));
  }
  // Each shard runs its own, and the merged report has each case once.
  EXPECT_THAT(Run({"test", test_, "--no-shrink", "--report", folder_ / "a", "--shard", "1/2"}).output,
              HasSubstr("4 passed, 1 failed, 0 errors, 0 not run in"));
  EXPECT_THAT(Run({"test", test_, "--no-shrink", "--report", folder_ / "b", "--shard", "2/2"}).output,
              HasSubstr("2 passed, 2 failed, 0 errors, 0 not run in"));
  EXPECT_EQ(Run({"sweep", "--merge", folder_ / "a", folder_ / "b", "-o", folder_ / "merged"}).exit_status, 0);
  EXPECT_EQ(folder_.Read("merged/cases.csv"), TextOf(report_ + "/cases.csv"));
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
  for (const char* const file : {"index.html", "cases.jsonl", "row-heat-robots.png", "row-heat-waits.png"}) {
    const std::string whole = folder_.Read(std::string("whole/") + file);
    EXPECT_NE(whole, "") << file;
    EXPECT_EQ(folder_.Read(std::string("merged/") + file), whole) << file;
    EXPECT_EQ(folder_.Read(std::string("two/") + file), whole) << file;
  }
  const Tested half = Run({"sweep", "--merge", folder_ / "b", "-o", folder_ / "half"});
  EXPECT_EQ(half.exit_status, 2);
  EXPECT_THAT(half.output, HasSubstr("error: found no shard 1/2 of '" + test_ + "', expected all"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "half/index.html"));
  EXPECT_EQ(
      Run({"sweep", "--merge", folder_ / "a", folder_ / "b", "-o", folder_ / "merged", "--junit", folder_ / "m.xml"})
          .exit_status,
      0);
  EXPECT_THAT(folder_.Read("m.xml"), HasSubstr("<testsuites tests=\"9\" failures=\"3\" errors=\"0\">"));
  const Tested processes = Run({"test", test_, "--processes", "--case", "seed=2", "--no-shrink", "--report", report_});
  EXPECT_THAT(processes.output, HasSubstr("2 passed, 1 failed, 0 errors")) << processes.output;
}

// The ticks in the cells of the first heat map of a report.
std::uint64_t TicksOfHeat(const std::string& jsonl) {
  std::uint64_t ticks = 0;
  for (const std::string& line : LinesOf(jsonl)) {
    const nlohmann::json row = nlohmann::json::parse(line);
    if (!row.contains("heat_maps")) continue;
    const nlohmann::json& cells = row.at("heat_maps").at(0).at("cells");
    for (std::size_t i = 2; i < cells.size(); i += 3) ticks += cells.at(i).get<std::uint64_t>();
  }
  return ticks;
}

TEST_F(FleetTests, DrawWhereRobotsWereInAllCases) {
  EXPECT_THAT(Run({"check", test_}).output, HasSubstr("\n  heat robots: cells of 0.5 m x 0.5 m\n"));
  Run({"sweep", test_, "-o", report_});
  EXPECT_EQ(TicksOfHeat(TextOf(report_ + "/cases.jsonl")), 9U * 60U * 6U) << "cases, ticks and robots";
  EXPECT_EQ(TextOf(report_ + "/row-heat-robots.png").substr(1, 3), "PNG");
  EXPECT_THAT(TextOf(report_ + "/index.html"),
              AllOf(HasSubstr("<img src=\"row-heat-robots.png\""), HasSubstr("Where robots waited in 9 runs")));
  // A recording is the only case.
  const std::string recording = folder_ / "run.mcap";
  Run({"run", test_, "--in-process", "--headless", "--no-ros", "--ticks", "20", "--record", recording});
  Run({"test", test_, "--on", recording, "--report", folder_ / "on"});
  EXPECT_EQ(TicksOfHeat(folder_.Read("on/cases.jsonl")), 20U * 6U);
  EXPECT_THAT(folder_.Read("on/index.html"), HasSubstr("Where robots were in 1 run,"));
  // Nothing is counted without the key.
  std::string text = kRow;
  text.replace(text.find(",\n  \"heat\""), std::string(",\n  \"heat\": [\"robots\", \"waits\"]").size(), "");
  folder_.Write("row.test.json", text);
  Run({"sweep", test_, "-o", folder_ / "without"});
  EXPECT_THAT(folder_.Read("without/cases.jsonl"), Not(HasSubstr("heat")));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "without/row-heat-robots.png"));
}

TEST_F(FleetTests, CountNothingOfCasesThatCouldNotBeRun) {
  const std::string path = folder_.Write("bad.test.json", R"({"ticks": 7,
    "robots": [{"name": "a", "model": "position"}], "vary": {"robots[a].model": ["position", "none"]},
    "expect": ["tick < 9"], "heat": {"of": ["robots"], "cell": 2}})");
  EXPECT_EQ(Run({"sweep", path, "-o", report_}).exit_status, 3);
  EXPECT_EQ(TicksOfHeat(TextOf(report_ + "/cases.jsonl")), 7U);
  EXPECT_THAT(TextOf(report_ + "/cases.jsonl"), HasSubstr("\"cell\":2.0"));
  EXPECT_THAT(TextOf(report_ + "/index.html"), HasSubstr("Where robots were in 1 run,"));
}

class SearchTests : public FleetTests {
 protected:
  // Cases fail above 0.33 m/s.
  std::string Test() {
    std::string text = kRow;
    const std::string values = "[0.2, 0.9, 0.1]";
    text.replace(text.find(values), values.size(), "{\"uniform\": [0.05, 0.4]}");
    return folder_.Write("search.test.json", text);
  }
  static std::string CasesIn(const std::string& jsonl) {
    std::string cases;
    for (const std::string& line : LinesOf(jsonl)) {
      const nlohmann::json row = nlohmann::json::parse(line);
      if (row.contains("number")) cases += row.at("number").dump() + row.at("case").dump() + "\n";
    }
    return cases;
  }
};

TEST_F(SearchTests, EndWithTheFirstCaseThatFailsForAnyNumberOfJobs) {
  const std::string path = Test();
  std::string output;
  std::string cases;
  for (const char* const jobs : {"1", "3", "7"}) {
    const Tested tested = Run({"test", path, "--search", "60", "--report", report_, "--jobs", jobs, "--no-shrink"});
    EXPECT_EQ(tested.exit_status, 1) << tested.output;
    EXPECT_THAT(tested.output, HasSubstr(" 1 failed, 0 errors, 0 not run"));
    const std::string run = CasesIn(TextOf(report_ + "/cases.jsonl"));
    if (cases.empty()) cases = run;
    EXPECT_EQ(run, cases) << jobs << " jobs";
    EXPECT_THAT(TextOf(report_ + "/index.html"), HasSubstr(" of a search</p>"));
    std::filesystem::remove(folder_ / "search.test.failing");
  }
}

TEST_F(SearchTests, RunWholeCasesOnly) {
  const std::string path = Test();
  const std::string speed = "robots[r2].controller.parameters.commands[0].vx";
  folder_.Write("search.test.failing", "seed=1," + speed + "=0.31,ticks=2,without=[\"r0\"]\n");
  const Tested tested = Run(
      {"test", path, "--search", "20", "--report", report_, "--jobs", "2", "--no-shrink", "--junit", folder_ / "j"});
  EXPECT_THAT(tested.output, HasSubstr("kept cases: 1 passed, 0 failed")) << tested.output;
  const std::string jsonl = TextOf(report_ + "/cases.jsonl");
  EXPECT_EQ(TicksOfHeat(jsonl), (LinesOf(CasesIn(jsonl)).size() - 1) * 60 * 6) << "of the search alone";
  EXPECT_THAT(TextOf(report_ + "/cases.jsonl"), AllOf(Not(HasSubstr("without")), Not(HasSubstr("\"ticks\":2,"))));
  EXPECT_THAT(folder_.Read("j"), AllOf(HasSubstr("kept: seed=1"), Not(HasSubstr("ticks="))));
}

TEST_F(SearchTests, DoNotBeginWhileAKeptCaseFails) {
  const std::string path = Test();
  folder_.Write("search.test.failing", "seed=1,robots[r2].controller.parameters.commands[0].vx=0.4\n");
  const Tested tested = Run({"test", path, "--search", "20", "--report", report_, "--jobs", "3", "--no-shrink"});
  EXPECT_EQ(tested.exit_status, 1) << tested.output;
  EXPECT_THAT(tested.output,
              HasSubstr("kept cases: 0 passed, 1 failed, 0 errors\n0 passed, 0 failed, 0 errors, 0 not run"));
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

TEST_F(FleetTests, ACaseWhoseProcessDiesIsAnErrorOfThatCase) {
  const std::string path = folder_.Write("abort.test.json", R"({
      "robots": [{"name": "a", "model": "position", "controller": ")" ABORTING_LIBRARY R"("}],
      "vary": {"seed": [1, 2], "ticks": [10, 30]}, "expect": ["tick < 99"]})");
  for (const char* const jobs : {"1", "2"}) {
    const Tested tested = Run({"test", path, "--report", report_, "--junit", folder_ / "junit.xml", "--jobs", jobs});
    EXPECT_EQ(tested.exit_status, 3) << tested.output;
    EXPECT_THAT(tested.output,
                HasSubstr("ERROR abort: seed=1,ticks=30\n  the process of the case was killed by signal 6"));
    EXPECT_THAT(tested.output, HasSubstr("2 passed, 0 failed, 2 errors, 0 not run"));
    EXPECT_THAT(folder_.Read("junit.xml"), HasSubstr("tests=\"4\" failures=\"0\" errors=\"2\""));
  }
}

TEST_F(FleetTests, ProcessesFindAControllerThatIsNotRepeatable) {
  const std::string path = folder_.Write("drift.test.json", R"({
      "ticks": 40, "robots": [{"name": "a", "model": "position", "controller": {
          "name": ")" DRIFTING_LIBRARY R"(", "parameters": {"drifts": false}}}],
      "vary": {"robots[a].controller.parameters.drifts": [false, true]}, "expect": ["tick < 99"]})");
  EXPECT_EQ(Run({"test", path, "--report", report_}).exit_status, 0);
  const Tested tested = Run({"test", path, "--processes", "--report", report_, "--jobs", "2"});
  EXPECT_EQ(tested.exit_status, 3) << tested.output;
  EXPECT_THAT(tested.output, HasSubstr("the run in processes differs from the run in one at tick 31"));
  EXPECT_THAT(tested.output, HasSubstr("1 passed, 0 failed, 1 errors"));
}

TEST_F(FleetTests, CtrlCKeepsTheCasesThatHaveFinished) {
  // The library is opened by the second case, behind the first; the third has no end.
  const std::string mark = folder_ / "mark";
  setenv("TROUPE_TEST_MARK", mark.c_str(), 1);
  const std::string path = folder_.Write("long.test.json", R"({
      "robots": [{"name": "a", "model": "position"}],
      "vary": {"ticks": [5, 1000000000], "robots[a].controller": [
                   {"name": "script", "parameters": {"commands": [{"at": 0, "vx": 0.1}]}}, ")" MARKING_LIBRARY R"("]},
      "expect": ["always tick < 4"]})");
  Program program = Troupe({"test", path, "--report", report_, "--junit", folder_ / "junit.xml", "--jobs", "1"});
  while (!std::filesystem::exists(mark)) ASSERT_FALSE(program.HasEnded()) << program.output();
  unsetenv("TROUPE_TEST_MARK");
  const std::vector<pid_t> workers = ChildrenOf(program.pid());
  program.Signal(SIGINT);
  EXPECT_EQ(program.Wait(), 130);
  EXPECT_THAT(program.output(), HasSubstr("0 passed, 1 failed, "));
  EXPECT_THAT(TextOf(report_ + "/cases.jsonl"), HasSubstr("\"verdict\":\"failed\""));
  EXPECT_THAT(folder_.Read("junit.xml"), AllOf(HasSubstr("tests=\"4\""), HasSubstr("<skipped message=\"not run\"/>")));
  EXPECT_EQ(LinesOf(TextOf(report_ + "/cases.csv")).size(), 5U);
  EXPECT_THAT(folder_.Read("long.test.failing"), HasSubstr("\nticks=5,robots[a].controller={"));
  for (const pid_t worker : workers) EXPECT_TRUE(IsGoneSoon(worker));
}

TEST_F(FleetTests, CtrlCLeavesNoProcessAndNoFileOfProcesses) {
  const std::string temporary = folder_ / "temporary";
  std::filesystem::create_directory(temporary);
  setenv("TMPDIR", temporary.c_str(), 1);
  std::string text = kRow;
  text.replace(text.find("[1, 3]"), 6, "[1, 9000]");
  Program program = Troupe({"test", folder_.Write("long.test.json", text), "--processes", "--jobs", "1"});
  unsetenv("TMPDIR");
  std::vector<pid_t> runs;
  while (runs.empty()) {
    ASSERT_FALSE(program.HasEnded()) << program.output();
    for (const pid_t worker : ChildrenOf(program.pid())) runs = ChildrenOf(worker);
  }
  program.Signal(SIGINT);
  EXPECT_EQ(program.Wait(), 130);
  for (const pid_t run : runs) EXPECT_TRUE(IsGoneSoon(run));
  for (const auto& entry : std::filesystem::directory_iterator(temporary)) {
    EXPECT_FALSE(entry.path().filename().string().starts_with("troupe-case-")) << entry.path();
  }
}

// Each pair of the table, and no pair is accepted and ignored.
TEST_F(FleetTests, RefuseOptionsOfWhichOneWouldBeWithoutEffect) {
  const auto expect_refused = [&](std::vector<std::string> arguments, const std::string& a, const std::string& b) {
    const Tested tested = Run(std::move(arguments));
    EXPECT_EQ(tested.exit_status, 2);
    EXPECT_THAT(tested.output, testing::AnyOf("error: found " + a + " beside " + b + ", expected one of the two\n",
                                              "error: found " + b + " beside " + a + ", expected one of the two\n"));
  };
  const std::map<std::string, std::vector<std::string>> values = {
      {"--case", {"seed=1"}}, {"--search", {"5"}}, {"--shard", {"1/2"}},      {"--jobs", {"1"}},
      {"--processes", {}},    {"--no-shrink", {}}, {"--case-timeout", {"9"}},
  };
  const auto with = [&](std::vector<std::string> arguments, const std::string& option) {
    arguments.push_back(option);
    const std::vector<std::string>& value = values.at(option);
    arguments.insert(arguments.end(), value.begin(), value.end());
    return arguments;
  };
  for (const auto& [option, value] : values)
    expect_refused(with({"test", test_, "--on", "run.mcap"}, option), "--on", option);
  for (const char* const option : {"--case", "--shard"}) {
    expect_refused(with({"test", test_, "--search", "5"}, option), "--search", option);
  }
  for (const char* const option : {"--jobs", "--shard", "--case-timeout"}) {
    expect_refused(with({"sweep", "-o", report_, "--merge", report_}, option), "--merge", option);
  }
  expect_refused({"sweep", test_, "-o", report_, "--merge", report_}, "--merge", "FILE");
}

// A smaller case without a robot that another expectation names would be none of the test.
TEST_F(FleetTests, SmallestCasesKeepTheRobotsThatAnyExpectationNames) {
  std::string text = kRow;
  const std::string clause = R"({"name": "moves", )";
  text.replace(text.find(clause), 0, R"({"name": "the other", "that": "always x(r4) < 3 m"},)");
  const Tested tested = Run({"test", folder_.Write("named.test.json", text), "--report", report_});
  EXPECT_THAT(tested.output, HasSubstr("without=[\"r0\",\"r1\",\"r3\",\"r5\"]")) << tested.output;
  EXPECT_THAT(tested.output, HasSubstr("(2 robots, "));
}

// Doors, a lift and people as users write them.
TEST_F(FleetTests, TheExampleOfAHouseWithGuestsPasses) {
  const std::string example =
      std::string(std::getenv("TROUPE_SOURCE_DIR")) + "/examples/fleet_tests/guesthouse.test.json";
  const Tested tested = Run({"test", example, "--report", report_, "--case", "seed=1"});
  EXPECT_EQ(tested.exit_status, 0) << tested.output;
  EXPECT_THAT(tested.output, HasSubstr("1 passed, 0 failed"));
  EXPECT_THAT(TextOf(report_ + "/cases.csv"), HasSubstr("openness of doors"));
}

TEST_F(FleetTests, CheckReadsTheKeysOfTests) {
  const Tested good = Run({"check", test_});
  EXPECT_EQ(good.exit_status, 0) << good.output;
  EXPECT_THAT(good.output, AllOf(HasSubstr("test: row (9 cases)\n  vary seed: 1 to 3\n"),
                                 HasSubstr("  expect slow: forall r: always x(r) < 2 m\n"),
                                 HasSubstr("  metric farthest (m): "), HasSubstr("robots: 6\n")));
  const auto expect_error = [&](const std::string& old, const std::string& by, const std::string& error) {
    std::string text = kRow;
    text.replace(text.find(old), old.size(), by);
    const Tested bad = Run({"check", folder_.Write("bad.test.json", text)});
    EXPECT_EQ(bad.exit_status, 2) << bad.output;
    EXPECT_THAT(bad.output, HasSubstr(error));
    EXPECT_EQ(LinesOf(bad.output).size(), 1U) << bad.output;
  };
  expect_error("always x(r) < 2 m", "always x(r) < 2 s", "bad.test.json:13:");
  expect_error("[1, 3]", "[3, 1]", "bad.test.json:11:");
  expect_error(R"("seed": {"range": [1, 3]})", R"("robots[r0].model": ["position", "none"])", "in the case robots[r0]");
}

}  // namespace
}  // namespace troupe::test
