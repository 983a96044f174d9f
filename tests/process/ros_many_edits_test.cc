// A hundred edits in a row of a world with twenty robots and --ros: after each one the graph of ROS is right and the
// run steps on, and no process grows.
#include <gtest/gtest.h>

#include <fstream>

#include "tests/process/ros_edit_run.h"
#include "tests/support/files.h"

namespace troupe::test {
namespace {

constexpr int kSpawned = 20;
constexpr int kDeleted = 10;           // robots that are deleted and spawned again, in turn
constexpr int kRounds = 20;            // of five edits
constexpr int kSettled = kRounds / 2;  // rounds after which allocators have what they need
constexpr double kMaxGrowthMib = 1.0;  // of a process in the other rounds

const char* const kField = R"(name "field"
define cube model ( block ( points 4 point[0] [0 0] point[1] [0 1] point[2] [1 1] point[3] [1 0] z [0 1] ) )
define scanner ranger ( sensor ( range [0 8] fov 180 samples 19 ) )
define rover position ( size [0.4 0.4 0.3] drive "diff" scanner () )
)";

Pose PlaceOf(int robot) {
  return {2.0 * (robot % 5), 2.0 * (robot / 5), 0.0, 0.0};
}

// Writes a world with twenty robots, r0 and so on, and `more`.
std::string WriteWorld(const TemporaryFolder& folder, const std::string& name, const std::string& more) {
  std::ofstream file(folder.Path(name));
  file << kField << more;
  for (int i = 0; i < kSpawned; ++i) {
    file << "rover ( name \"r" << i << "\" pose [" << PlaceOf(i).x << " " << PlaceOf(i).y
         << " 0 0] ctrl \"wander\" )\n";
  }
  return folder.Path(name);
}

// The resident memory of a process, MiB.
double MemoryOf(pid_t process) {
  std::ifstream status("/proc/" + std::to_string(process) + "/status");
  for (std::string line; std::getline(status, line);) {
    if (line.starts_with("VmRSS:")) return std::stod(line.substr(6)) / 1024.0;
  }
  ADD_FAILURE() << "process " << process << " is gone";
  return 0.0;
}

// The mean of several processes: the allocator of a single one may need another arena.
double MeanMemoryOf(const std::vector<pid_t>& processes) {
  double sum = 0.0;
  for (const pid_t process : processes) sum += MemoryOf(process);
  return sum / static_cast<double>(processes.size());
}

TEST(RosManyEdits, TheGraphIsRightAfterEachAndMemoryIsFlat) {
  const TemporaryFolder folder;
  const std::string field = WriteWorld(folder, "field.world", "");
  const std::string other =
      WriteWorld(folder, "other.world", "cube ( name \"more\" pose [-3 0 0 0] size [0.2 0.2 0.2] )\n");
  std::vector<std::string> robots;
  for (int i = 0; i < kSpawned; ++i) robots.push_back("r" + std::to_string(i));
  RosEditRun run(field, {"--paused", "--robots-per-process", "1"});
  const auto expect = [&](const std::vector<std::string>& names) {
    run.Step(2);
    run.ExpectRobots(names);
    return !testing::Test::HasFailure();
  };
  ASSERT_TRUE(expect(robots));

  std::vector<pid_t> agents;  // of the robots that are never deleted
  for (int i = kDeleted; i < kSpawned; ++i) agents.push_back(run.AgentsOf(robots[i]).at(0));
  const pid_t service = run.Service();
  const pid_t participant = run.Participant();  // which the robots share, being more than ten
  double agents_settled = 0.0;
  double service_settled = 0.0;
  double participant_settled = 0.0;
  for (int round = 0; round < kRounds; ++round) {
    const int i = round % kDeleted;
    std::vector<std::string> others = robots;
    std::erase(others, robots[i]);
    run.Delete(robots[i]);
    ASSERT_TRUE(expect(others)) << round;
    run.Spawn(robots[i], PlaceOf(i));
    ASSERT_TRUE(expect(robots)) << round;
    run.Load(other);
    ASSERT_TRUE(expect(robots)) << round;
    run.Reset();
    ASSERT_TRUE(expect(robots)) << round;
    run.Load(field);
    ASSERT_TRUE(expect(robots)) << round;
    if (round + 1 != kSettled) continue;
    agents_settled = MeanMemoryOf(agents);
    service_settled = MemoryOf(service);
    participant_settled = MemoryOf(participant);
  }
  EXPECT_LT(MeanMemoryOf(agents), agents_settled + kMaxGrowthMib);
  EXPECT_LT(MemoryOf(service), service_settled + kMaxGrowthMib);
  EXPECT_LT(MemoryOf(participant), participant_settled + kMaxGrowthMib);
  run.End();
}

}  // namespace
}  // namespace troupe::test
