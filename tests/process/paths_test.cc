// Problems of multi-agent paths: robots that the planned traffic leads, and robots on the paths of another planner, in
// every kind of run.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/process/programs.h"
#include "tests/support/dds_domain.h"
#include "tests/support/files.h"

namespace troupe::test {
namespace {

using testing::HasSubstr;

// A ring around a wall, and two rooms.
constexpr const char* kMap =
    "type octile\nheight 6\nwidth 8\nmap\n"
    "........\n"
    ".@@..@@.\n"
    ".@....@.\n"
    "........\n"
    ".@@..@@.\n"
    "........\n";
constexpr const char* kRows =
    "version 1\n"
    "0\tm.map\t8\t6\t0\t0\t7\t5\t12\n"
    "0\tm.map\t8\t6\t7\t5\t0\t0\t12\n"
    "0\tm.map\t8\t6\t7\t0\t0\t5\t12\n"
    "0\tm.map\t8\t6\t0\t5\t7\t0\t12\n"
    "0\tm.map\t8\t6\t3\t2\t4\t3\t2\n"
    "0\tm.map\t8\t6\t4\t2\t3\t3\t2\n";

// Four robots go round in a circle, and a fifth one follows a sixth.
constexpr const char* kCircle =
    "version 1\n"
    "0 m.map 8 6 3 2 4 2 1\n"
    "0 m.map 8 6 4 2 4 3 1\n"
    "0 m.map 8 6 4 3 3 3 1\n"
    "0 m.map 8 6 3 3 3 2 1\n"
    "0 m.map 8 6 0 0 2 0 2\n"
    "0 m.map 8 6 1 0 3 0 2\n";
constexpr const char* kCirclePaths =
    "Agent 0:(3,2,0)->(4,2,1)->\n"
    "Agent 1:(4,2,0)->(4,3,1)->\n"
    "Agent 2:(4,3,0)->(3,3,1)->\n"
    "Agent 3:(3,3,0)->(3,2,1)->\n"
    "Agent 4:(0,0,0)->(1,0,1)->(2,0,2)->\n"
    "Agent 5:(1,0,0)->(2,0,1)->(3,0,2)->\n";

class PathsTest : public testing::Test {
 protected:
  PathsTest() {
    folder_.Write("m.map", kMap);
    folder_.Write("m.scen", kRows);
    folder_.Write("c.scen", kCircle);
    folder_.Write("c.paths", kCirclePaths);
  }
  std::string Path(const std::string& name) const { return folder_.Path(name); }

  Finished Run(const std::string& problem, const std::string& name, std::vector<std::string> more) const {
    std::vector<std::string> arguments = {"run",        Path(problem), "--headless", "--speed",           "max",
                                          "--hash-log", Path(name),    "--summary",  Path(name + ".json")};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return Finish(Troupe(arguments));
  }
  nlohmann::json TripsOf(const std::string& name) const {
    return nlohmann::json::parse(folder_.Read(name + ".json"), nullptr, false)["trips"];
  }
  // In one process with one thread and with several, with a process for all robots, and with one for each: the same
  // hashes. The outcome of the run.
  nlohmann::json ExpectSameInEveryRun(const std::string& problem, const std::vector<std::string>& options) const {
    const std::string domain = std::to_string(TestDomain());
    const std::vector<std::pair<std::string, std::vector<std::string>>> kinds = {
        {"one", {"--in-process", "--threads", "1"}},
        {"threads", {"--in-process", "--threads", "4"}},
        {"all", {"--domain", domain}},
        {"each", {"--domain", domain, "--robots-per-process", "1"}}};
    for (const auto& [name, kind] : kinds) {
      std::vector<std::string> arguments = options;
      arguments.insert(arguments.end(), kind.begin(), kind.end());
      OutputOf(Run(problem, name, arguments));
      EXPECT_FALSE(folder_.Read(name).empty());
      EXPECT_EQ(folder_.Read(name), folder_.Read("one")) << name;
      EXPECT_EQ(TripsOf(name), TripsOf("one")) << name;
    }
    return TripsOf("one");
  }

  TemporaryFolder folder_;
};

TEST_F(PathsTest, ThePlannedTrafficBringsAllAgentsToTheirGoals) {
  const nlohmann::json trips = ExpectSameInEveryRun("m.scen", {"--delays", "0.2,0.5,2", "--seed", "3"});
  EXPECT_EQ(trips["robots"], 6);
  EXPECT_EQ(trips["arrived"], 6);
  EXPECT_EQ(trips["goals"], 6);
  EXPECT_GT(trips["makespan"], 12.0);
  EXPECT_GT(trips["flow_time"], trips["makespan"]);
  EXPECT_THAT(OutputOf(Run("m.scen", "first", {"--in-process", "--agents", "2"})),
              HasSubstr("2 robots arrived, 2 goals"));
}

TEST_F(PathsTest, RobotsFollowPathsWithDelaysInEveryRun) {
  const nlohmann::json trips =
      ExpectSameInEveryRun("c.scen", {"--paths", Path("c.paths"), "--delays", "0.5,0.5,3", "--seed", "5"});
  EXPECT_EQ(trips["robots"], 6);
  EXPECT_EQ(trips["arrived"], 6);
}

TEST_F(PathsTest, ARunWithoutAnArrivalEndsAtItsLimit) {
  OutputOf(Run("m.scen", "short", {"--in-process", "--ticks", "20"}));
  EXPECT_EQ(TripsOf("short")["arrived"], 0);
  EXPECT_EQ(TripsOf("short")["makespan"], 0.0);
}

// A planner that knows the answer, and proves that it has read the problem.
TEST_F(PathsTest, APlannerReadsTheProblemAndWritesPaths) {
  const std::string planner = "grep -q '\"start\":\\[3,2\\],\"goals\":\\[\\[4,2\\]\\]' && cat " + Path("c.paths");
  OutputOf(Run("c.scen", "planned", {"--in-process", "--planner", planner, "--paths", Path("kept.paths")}));
  EXPECT_EQ(TripsOf("planned")["arrived"], 6);
  EXPECT_EQ(folder_.Read("kept.paths"), kCirclePaths);
  OutputOf(Run("c.scen", "again", {"--in-process", "--planner", planner}));
  EXPECT_EQ(folder_.Read("again"), folder_.Read("planned"));
  EXPECT_THAT(OutputOf(Run("c.scen", "bad", {"--in-process", "--planner", "exit 3"}), 2),
              HasSubstr("the command 'exit 3' ended with exit status 3, expected exit status 0"));
  EXPECT_THAT(OutputOf(Run("c.scen", "bad", {"--in-process", "--planner", "echo no"}), 2),
              HasSubstr(":1:1: error: found 'no', expected 'Agent N:' and its path (in the output of --planner)"));
}

TEST_F(PathsTest, TheOutcomeIsThatOfTheLeagueAndCanBeFollowed) {
  OutputOf(Run("m.scen", "run", {"--in-process", "--record", Path("run.mcap")}));
  OutputOf(Troupe({"export", Path("run.mcap"), "--format", "league", "-o", Path("league.json")}));
  const nlohmann::json league = nlohmann::json::parse(folder_.Read("league.json"), nullptr, false);
  EXPECT_EQ(league["actionModel"], "MAPF_T");
  EXPECT_EQ(league["teamSize"], 6);
  EXPECT_EQ(league["numTaskFinished"], 6);
  EXPECT_EQ(league["start"][0], nlohmann::json::array({0, 0, "E"}));
  EXPECT_EQ(league["tasks"][0], nlohmann::json::parse("[0, 0, [5, 7]]"));
  EXPECT_EQ(league["events"].size(), 6u);
  EXPECT_THAT(league["actualPaths"][0].get<std::string>(), testing::StartsWith("[(0,0,0,0,0):("));
  OutputOf(Run("m.scen", "again", {"--in-process", "--paths", Path("league.json")}));
  EXPECT_EQ(TripsOf("again")["arrived"], 6);
}

TEST_F(PathsTest, CheckAndSnapshotKnowProblems) {
  const std::string checked = OutputOf(Troupe({"check", Path("c.scen"), "--paths", Path("c.paths")}));
  EXPECT_THAT(checked, HasSubstr("cells: 38 free"));
  EXPECT_THAT(checked, HasSubstr("agents: 6, 6 goals, paths of 8 moves in 2 steps"));
  EXPECT_THAT(checked, HasSubstr("warnings: 0"));
  OutputOf(Troupe({"check", Path("m.map")}));
  OutputOf(Troupe({"snapshot", Path("m.scen"), "-o", Path("m.png")}));
  EXPECT_GT(folder_.Read("m.png").size(), 1000u);
  folder_.Write("bad.paths", "Agent 0:(3,2)->(3,4)\n");
  EXPECT_THAT(OutputOf(Troupe({"check", Path("c.scen"), "--paths", Path("bad.paths")}), 2),
              HasSubstr("bad.paths:1:16: error: found a jump to (3, 4)"));
}

}  // namespace
}  // namespace troupe::test
