// Cases whose controllers or sessions do not end as they should, and tests in several folders, as a user runs them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <cstdlib>
#include <filesystem>

#include "tests/process/programs.h"
#include "tests/support/files.h"

namespace troupe::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;

// One robot of the library; `mode`: of the case.
std::string TestOfLibrary(const std::string& vary, const std::string& mode) {
  const std::string begin = R"JSON({"ticks": 20, "robots": [{"name": "a", "model": "position", "controller": {
      "name": ")JSON" COUNTING_LIBRARY R"JSON(", "parameters": {"mode": ")JSON";
  const std::string end = R"JSON(, "expect": [{"name": "stays", "that": "always x(a) < 0.001 m"}],
      "metrics": {"x": "final of x(a)"}})JSON";
  return begin + mode + "\"}}}], \"vary\": " + vary + end;
}

class CaseProcesses : public testing::Test {
 protected:
  Finished Run(std::vector<std::string> arguments) {
    if (arguments.front() == "test") arguments.insert(arguments.end(), {"--report", report_});
    return Finish(Troupe(std::move(arguments)));
  }

  TemporaryFolder folder_;
  const std::string report_ = folder_ / "report";
};

TEST_F(CaseProcesses, GlobalVariablesOfALibraryDoNotReachTheNextCase) {
  const std::string path = folder_.Write("global.test.json", TestOfLibrary(R"({"seed": {"range": [1, 5]}})", "count"));
  for (const char* const jobs : {"1", "3"}) {
    const Finished tested = Run({"test", path, "--jobs", jobs});
    EXPECT_EQ(tested.exit_status, 0) << tested.output;
  }
}

TEST_F(CaseProcesses, AControllerThatDoesNotReturnIsAnErrorOfItsCase) {
  const std::string path = folder_.Write(
      "hang.test.json",
      TestOfLibrary(R"({"robots[a].controller.parameters.mode": ["count", "stuck"], "seed": [1, 2]})", "count"));
  const Finished tested = Run({"test", path, "--case-timeout", "4", "--jobs", "2"});
  EXPECT_EQ(tested.exit_status, 3) << tested.output;
  EXPECT_THAT(tested.output,
              AllOf(HasSubstr("ERROR hang: robots[a].controller.parameters.mode=\"stuck\",seed=2\n  the case has not "
                              "ended within 4 s\n  repeat: troupe test "),
                    HasSubstr("2 passed, 0 failed, 2 errors, 0 not run")));
}

// `timeout` of coreutils sends two signals, one right behind the other.
TEST_F(CaseProcesses, TwoSignalsCostNoReportAndNameTheRunningCase) {
  const std::string path = folder_.Write(
      "hang.test.json", TestOfLibrary(R"({"robots[a].controller.parameters.mode": ["count", "stuck", "fine"]})", ""));
  Program program = Troupe({"test", path, "--report", report_, "--junit", folder_ / "junit.xml", "--jobs", "1"});
  // The second case never ends.
  while (program.output().empty() && ChildrenOf(program.pid()).empty()) ASSERT_FALSE(program.HasEnded());
  program.Signal(SIGTERM);
  program.Signal(SIGINT);
  program.Signal(SIGTERM);
  EXPECT_EQ(program.Wait(), 130) << program.output();
  EXPECT_THAT(program.output(), AllOf(HasSubstr("NOT RUN hang: "), HasSubstr("\n  stopped after "), HasSubstr("s\n")));
  EXPECT_THAT(folder_.Read("junit.xml"), HasSubstr("</testsuites>"));
  EXPECT_THAT(TextOf(report_ + "/index.html"), HasSubstr("</html>"));
}

TEST_F(CaseProcesses, TestsOfOneNameHaveFilesOfTheirOwn) {
  const auto text = [](const std::string& speed) {
    const std::string begin = R"JSON({"ticks": 5, "robots": [{"name": "a", "model": "position", "controller": {
        "name": "script", "parameters": {"commands": [{"at": 0, "vx": )JSON";
    const std::string end = R"JSON(}]}}}], "vary": {"seed": [1], "ticks": [5]},
        "expect": ["always x(a) < 0.01 m"], "metrics": {"x": "final of x(a)"}})JSON";
    return begin + speed + end;
  };
  folder_.Write("tests/hall/drive.test.json", text("0.1"));
  folder_.Write("tests/yard/drive.test.json", text("0.3"));
  const Finished tested = Run({"test", folder_ / "tests", "--no-shrink"});
  EXPECT_EQ(tested.exit_status, 1) << tested.output;
  for (const char* const name : {"hall-drive", "yard-drive"}) {
    for (const char* const file : {".csv", "-metric1-2.svg", "-0/run.mcap", "-0/violation.png", "-0/scenario.json"}) {
      EXPECT_TRUE(std::filesystem::exists(report_ + "/" + name + file)) << name << file;
    }
  }
  EXPECT_NE(TextOf(report_ + "/hall-drive.csv"), TextOf(report_ + "/yard-drive.csv"));
}

TEST_F(CaseProcesses, RecordingsAndProcessesFindTheFilesThatATestFinds) {
  folder_.Write("models/cart.inc", "define cart position ( size [0.4 0.4 0.4] )");
  const std::string path = folder_.Write("tests/cart.test.json", R"({"include": ["cart.inc"], "ticks": 5,
      "robots": [{"name": "a", "model": "cart", "controller": {
          "name": "script", "parameters": {"commands": [{"at": 0, "vx": 0.5}]}}}],
      "vary": {"seed": [1, 2]}, "expect": ["always x(a) < 0.1 m"]})");
  setenv("STAGEPATH", (folder_ / "models").c_str(), 1);
  const Finished tested = Run({"test", path, "--processes", "--no-shrink"});
  unsetenv("STAGEPATH");
  EXPECT_EQ(tested.exit_status, 1) << tested.output;
  EXPECT_THAT(tested.output, HasSubstr("0 passed, 2 failed, 0 errors"));
  EXPECT_TRUE(std::filesystem::exists(report_ + "/cart-0/run.mcap")) << tested.output;
}

TEST_F(CaseProcesses, APlaceOfABuildingIsOnItsLevel) {
  const std::string begin = R"JSON({"people": [], "ticks": 5, "world": ")JSON";
  const std::string end = R"JSON(/worlds/sites/guesthouse.building.yaml",
      "robots": [{"name": "tiny_1", "pose": [10, -3.75, 0, 0], "controller": "idle"},
                 {"name": "delivery_1", "pose": [10, -3.75, 4, 0], "controller": "idle"}],
      "regions": [{"name": "hall", "region": [8, -6, 11.5, -3], "z": 4}],
      "expect": ["always at(delivery_1, landing, 0.5 m)", "always not at(tiny_1, landing, 0.5 m)",
                 "always in(delivery_1, hall)", "always not in(tiny_1, hall)"]})JSON";
  const std::string path =
      folder_.Write("landing.test.json", begin + std::string(std::getenv("TROUPE_SOURCE_DIR")) + end);
  const Finished tested = Run({"test", path});
  EXPECT_EQ(tested.exit_status, 0) << tested.output;
}

}  // namespace
}  // namespace troupe::test
