// As many robots as a run has, in one agent process: its description, its first frame and its proposals have the sizes
// of all.
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <utility>

#include "tests/process/programs.h"
#include "tests/support/dds_domain.h"
#include "tests/support/files.h"

namespace troupe::test {
namespace {

constexpr int kRobots = 100'000;
constexpr int kColumns = 320;

TEST(LargeProcessTest, AHundredThousandRobotsHaveOneAgent) {
  const TemporaryFolder folder;
  {
    std::ofstream world(folder.Path("field.world"));
    for (int i = 0; i < kRobots; ++i) {
      world << "position ( name \"r" << i << "\" pose [ " << 3 * (i % kColumns) << " " << 3 * (i / kColumns)
            << " 0 0 ] ctrl \"wander\" )\n";
    }
  }
  const auto hashes = [&folder](const std::string& name, const std::vector<std::string>& more) {
    Program run = Troupe(Words("run % --ticks 3 --headless --start-timeout 250 --hash-log % --summary %",
                               {folder.Path("field.world"), folder.Path(name), folder.Path(name + ".json")}) +
                         more);
    // Beside other tests, the first tick of so many takes longer than any other run.
    EXPECT_TRUE(Eventually([&run] { return run.HasEnded(); }, 300.0));
    const std::string text = OutputOf(std::move(run));
    const auto summary = nlohmann::json::parse(folder.Read(name + ".json"), nullptr, false);
    EXPECT_EQ(summary["robots"], kRobots) << text;
    EXPECT_EQ(summary["lost"], nlohmann::json::array()) << text;
    return folder.Read(name);
  };
  const std::string whole = hashes("whole", {"--in-process"});
  EXPECT_FALSE(whole.empty());
  EXPECT_EQ(
      hashes("packed", {"--robots-per-process", std::to_string(kRobots), "--domain", std::to_string(TestDomain())}),
      whole);
}

}  // namespace
}  // namespace troupe::test
