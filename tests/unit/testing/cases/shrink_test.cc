// Smaller cases of a planted fault, and the search for a rare one.
#include "testing/cases/shrink.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "testing/cases/case_search.h"
#include "tests/support/files.h"

namespace troupe {
namespace {

std::string Robot(const std::string& name, const std::string& pose, const std::string& speed) {
  return R"({"name": ")" + name + R"(", "model": "position", "pose": )" + pose +
         R"(, "controller": {"name": "script", "parameters": {"commands": [{"at": 0, "vx": )" + speed + "}]}}}";
}

// 50 robots, each in a lane of its own, but r31: it stands in the lane of r17.
TEST(ShrinkCase, OfFiftyRobotsLeavesTheTwoOfThePlantedFaultAndNoTickBehindIt) {
  std::string robots;
  for (int i = 0; i < 50; ++i) {
    const bool waits = i == 31;
    const std::string place = waits ? "[3, 34, 0]" : "[0, " + std::to_string(2 * i) + ", 0]";
    robots += (i > 0 ? ", " : "") + Robot("r" + std::to_string(i), place, waits ? "0" : "0.5");
  }
  const test::TemporaryFolder folder;
  const TestFile test = TestFile::Read(folder.Write("t.test.json", R"({"ticks": 300, "robots": [)" + robots + R"JSON(],
      "vary": {"seed": {"range": [1, 20]}}, "expect": ["tick < 999", "no_contact(5 cm)"]})JSON"))
                            .value();
  const CaseWorlds worlds(test);
  const TestCase draws = {{"seed", "14"}};
  const CaseOutcome whole = RunCase(worlds, draws);
  ASSERT_EQ(whole.verdict, CaseVerdict::kFailed);
  const ShrunkCase shrunk = ShrinkCase(worlds, draws, 1);
  EXPECT_EQ(shrunk.outcome.verdict, CaseVerdict::kFailed);
  EXPECT_EQ(shrunk.robots, 2U);
  EXPECT_EQ(shrunk.outcome.ticks, whole.expectations[1].decided_at);
  EXPECT_LT(shrunk.outcome.ticks, 60U);
  EXPECT_EQ(shrunk.draws.front().value, "1");  // the simplest seed
  EXPECT_LE(shrunk.runs, 30U);
}

TEST(ShrinkCase, PrefersASmallNumberOfRobotsToALargeOneWithoutSome) {
  const test::TemporaryFolder folder;
  const TestFile test = TestFile::Read(folder.Write("t.test.json", R"JSON({"ticks": 20, "spawn": [
      {"model": "position", "count": 5, "region": [-20, -20, 20, 20], "name_prefix": "n", "controller": "idle"}],
      "vary": {"spawn[0].count": {"range": [1, 40]}, "seed": {"range": [1, 100]}}, "design": {"random": 12},
      "expect": ["always (count r: speed(r) < 1 m/s) <= 6"]})JSON"))
                            .value();
  const CaseWorlds worlds(test);
  for (const char* const count : {"8", "16", "31", "40"}) {
    const ShrunkCase shrunk = ShrinkCase(worlds, {{"spawn[0].count", count}, {"seed", "77"}}, 0);
    EXPECT_EQ(CaseText(shrunk.draws), "spawn[0].count=7,seed=1,ticks=1");
    EXPECT_EQ(shrunk.robots, 7U);
    EXPECT_LE(shrunk.runs, 40U);
  }
}

TEST(ShrinkCase, TriesNoPartOfABuilding) {
  const test::TemporaryFolder folder;
  const std::string house = std::string(std::getenv("TROUPE_SOURCE_DIR")) + "/worlds/sites/guesthouse.building.yaml";
  std::string robots = R"({"name": "runner", "model": "TinyRobot", "pose": [4, -4, 0],
      "controller": {"name": "script", "parameters": {"commands": [{"at": 0, "vx": 0.5}]}}})";
  const TestFile test = TestFile::Read(
                            folder.Write("t.test.json", R"JSON({"world": ")JSON" + house + R"JSON(", "ticks": 100,
      "controller": "idle", "robots": [)JSON" + robots + R"JSON(], "spawn": [{"model": "TinyRobot", "count": 6,
      "region": [0.5, -7.5, 5, -1], "name_prefix": "s", "controller": "idle"}],
      "expect": ["forall r: always speed(r) < 0.3 m/s"]})JSON"))
                            .value();
  const CaseWorlds worlds(test);
  const ShrunkCase shrunk = ShrinkCase(worlds, {}, 0);
  EXPECT_EQ(shrunk.robots, 1U);
  EXPECT_LE(shrunk.runs, 4U);
}

// Four robots in lanes of their own; the fault: all are near the line x = 3 m at one time. About one random case in
// 6,000 has it.
class RareFault : public testing::Test {
 protected:
  TestFile Test(std::uint64_t seed) {
    std::string robots;
    std::string vary;
    for (int i = 0; i < 4; ++i) {
      const std::string name = "r" + std::to_string(i);
      robots +=
          (i > 0 ? ", " : "") + Robot(name, "[" + std::to_string(-4 - i) + ", " + std::to_string(2 * i) + ", 0]", "1");
      vary += (i > 0 ? ", " : "") + ("\"robots[" + name + R"(].controller.parameters.commands[0].vx")") +
              R"(: {"uniform": [0.2, 1]})";
    }
    return TestFile::Read(
               folder_.Write("t.test.json", R"({"ticks": 100, "robots": [)" + robots + R"(], "vary": {)" + vary +
                                                R"(}, "design": {"random": 100000, "seed": )" + std::to_string(seed) +
                                                R"(}, "expect": ["always (max r: abs(x(r) - 3 m)) > 0.66 m"]})"))
        .value();
  }
  static constexpr std::uint64_t kMax = 100'000;  // runs

  // The runs that a search needs, and those of random cases.
  static std::uint64_t RunsOfSearch(const TestFile& test) {
    const CaseWorlds worlds(test);
    CaseSearch search(test.design());
    for (std::uint64_t runs = 1; runs < kMax; ++runs) {
      const CaseSearch::Proposal proposal = search.Next().value();
      const CaseOutcome outcome = RunCase(worlds, proposal.draws);
      if (outcome.verdict == CaseVerdict::kFailed) return runs;
      search.Add(proposal.number, outcome);
    }
    return kMax;
  }
  static std::uint64_t RunsOfRandomCases(const TestFile& test) {
    const CaseWorlds worlds(test);
    for (std::uint64_t runs = 1; runs < kMax; ++runs) {
      if (RunCase(worlds, test.design().At(runs - 1)).verdict == CaseVerdict::kFailed) return runs;
    }
    return kMax;
  }
  template <typename Runs>
  std::uint64_t MedianOfTen(const Runs& runs) {
    std::vector<std::uint64_t> all;
    for (std::uint64_t seed = 1; seed <= 10; ++seed) all.push_back(runs(Test(seed)));
    std::sort(all.begin(), all.end());
    return (all[4] + all[5]) / 2;
  }

  test::TemporaryFolder folder_;
};

// The next test measures 4073 random cases as their median.
TEST_F(RareFault, IsFoundBySearchInATenthOfTheRunsOfRandomCases) {
  EXPECT_LE(MedianOfTen(RunsOfSearch), 407U);
}

// The same with measured random cases: 20 s and more.
TEST_F(RareFault, DISABLED_IsFoundBySearchInATenthOfMeasuredRandomCases) {
  const std::uint64_t search = MedianOfTen(RunsOfSearch);
  const std::uint64_t random = MedianOfTen(RunsOfRandomCases);
  RecordProperty("search", std::to_string(search));
  RecordProperty("random", std::to_string(random));
  std::printf("median of ten: %llu runs of the search, %llu random cases\n", static_cast<unsigned long long>(search),
              static_cast<unsigned long long>(random));
  EXPECT_GE(random, 3000U);
  EXPECT_LE(10 * search, random);
}

}  // namespace
}  // namespace troupe
