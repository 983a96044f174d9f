// The trace of a run: the phases of all processes in all ticks, in one file.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "tests/process/programs.h"
#include "tests/support/files.h"

namespace troupe::test {
namespace {

using testing::IsSupersetOf;
using testing::UnorderedElementsAre;

// Phases by process.
std::map<std::string, std::set<std::string>> TraceOf(std::vector<std::string> arguments) {
  TemporaryFolder folder;
  for (const char* word : {"--ticks", "30", "--speed", "max", "--trace"}) arguments.push_back(word);
  arguments.push_back(folder.Path("trace.json"));
  OutputOf(RunPen(arguments));
  EXPECT_EQ(folder.size(), 1u);
  std::map<int, std::string> names;
  std::map<std::string, std::set<std::string>> phases;
  for (const nlohmann::json& event : nlohmann::json::parse(folder.Read("trace.json"))) {
    if (event["ph"] == "M") {
      const std::string name = event["args"]["name"];
      names[event["pid"]] = name.substr(0, name.find(" ("));
    } else {
      EXPECT_GE(event["ts"], 0.0);
      EXPECT_GE(event["dur"], 0.0);
      EXPECT_LE(event["args"]["tick"], 31);
      phases[names[event["pid"]]].insert(event["name"]);
    }
  }
  return phases;
}

const std::vector<std::string> kServicePhases = {"wait", "step", "publish", "record"};
const std::vector<std::string> kAgentPhases = {"wait", "apply", "sense", "decide", "send"};

TEST(TraceOfARun, HasAllPhasesOfAllProcesses) {
  const auto phases = TraceOf({});
  EXPECT_EQ(phases.size(), 5u);
  for (const auto& [process, found] : phases) {
    EXPECT_THAT(found, IsSupersetOf(process == "world-service" ? kServicePhases : kAgentPhases)) << process;
  }
}

TEST(TraceOfARun, ExistsForARunInOneProcess) {
  const auto phases = TraceOf({"--in-process"});
  ASSERT_THAT(phases, UnorderedElementsAre(testing::Key("world-service"), testing::Key("robot-agent")));
  EXPECT_THAT(phases.at("world-service"), IsSupersetOf(kServicePhases));
  EXPECT_THAT(phases.at("robot-agent"), IsSupersetOf(kAgentPhases));
}

TEST(TraceOfARun, CoversTheRequestedTicks) {
  TemporaryFolder folder;
  OutputOf(RunPen({"--ticks", "30", "--trace", folder.Path("trace.json"), "--trace-ticks", "10:12"}));
  std::set<int> ticks;
  for (const nlohmann::json& event : nlohmann::json::parse(folder.Read("trace.json"))) {
    if (event["ph"] == "X") ticks.insert(event["args"]["tick"].get<int>());
  }
  EXPECT_THAT(ticks, UnorderedElementsAre(10, 11, 12));
}

TEST(TraceOfARun, NeedsAValidWindowOfTicks) {
  EXPECT_THAT(OutputOf(RunPen({"--trace", "/dev/null", "--trace-ticks", "12:10"}), 2),
              testing::HasSubstr("expected the first and the last tick"));
}

}  // namespace
}  // namespace troupe::test
