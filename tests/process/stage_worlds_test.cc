// The unmodified worlds of Stage: a process for each robot, and the same result in every other kind of run.
#include "tests/support/stage_worlds.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/process/programs.h"
#include "tests/support/files.h"

namespace troupe::test {
namespace {

class StageWorld : public testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(World())) GTEST_SKIP() << "no " << World() << "; set TROUPE_STAGE_WORLDS";
  }
  static std::string World() { return StageWorldsFolder() + "/" + GetParam(); }

  struct Files {
    std::string hashes;
    nlohmann::json summary;
  };
  Files RunWith(std::vector<std::string> arguments) const {
    TemporaryFolder folder;
    OutputOf(Troupe(Words("run % --ticks 600 --speed max --headless --hash-log % --summary %",
                          {World(), folder.Path("hashes"), folder.Path("summary")}) +
                    arguments));
    return {folder.Read("hashes"), nlohmann::json::parse(folder.Read("summary"), nullptr, false)};
  }
};

TEST_P(StageWorld, GivesTheSameHashesInEveryKindOfRun) {
  Files reference = RunWith({});
  EXPECT_EQ(reference.summary["ticks"], 600);
  EXPECT_EQ(reference.summary["processes"], reference.summary["robots"].get<int>() + 1);
  EXPECT_EQ(reference.summary["lost"], nlohmann::json::array());
  const std::vector<std::vector<std::string>> ways = {
      {},
      {"--in-process"},
      {"--robots-per-process", "2"},
      {"--shuffle-start", "11"},
      {"--faults", "loss=0.01,duplicate=0.02,reorder=0.02,delay=0.02:0.002,seed=5"}};
  for (const std::vector<std::string>& way : ways) {
    EXPECT_TRUE(RunWith(way).hashes == reference.hashes) << testing::PrintToString(way);
  }
}

INSTANTIATE_TEST_SUITE_P(Worlds, StageWorld,
                         testing::Values("simple.world", "benchmark/cave.world", "uoa_robotics_lab.world"));

}  // namespace
}  // namespace troupe::test
