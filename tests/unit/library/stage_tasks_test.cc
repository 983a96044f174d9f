// The controllers that Stage's worlds name do their tasks: whole simulations of worlds/foraging.world,
// worlds/foraging_energy.world and worlds/stage_controllers.world.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <map>
#include <string>
#include <vector>

#include "troupe/simulation.h"

namespace troupe {
namespace {

std::string WorldPath(const std::string& name) {
  return std::string(std::getenv("TROUPE_SOURCE_DIR")) + "/worlds/" + name;
}

Simulation LoadFile(const std::string& path) {
  Result<Simulation> loaded = Simulation::Load(path);
  if (!loaded.ok()) throw std::runtime_error(loaded.error().ToString());
  return std::move(loaded).value();
}

Simulation LoadText(const std::string& text) {
  const std::string path = testing::TempDir() + "stage_tasks_test.world";
  std::ofstream(path) << text;
  return LoadFile(path);
}

// The last number that each robot reported: "robot c1: 3 units delivered".
std::map<std::string, int> CountsOf(const std::vector<std::string>& reports) {
  std::map<std::string, int> counts;
  for (const std::string& report : reports) {
    const std::size_t colon = report.find(": ");
    counts[report.substr(6, colon - 6)] = std::atoi(report.c_str() + colon + 2);
  }
  return counts;
}

TEST(StageTasks, CarriersBringUnitsFromTheSourceToTheSink) {
  Simulation simulation = LoadFile(WorldPath("foraging.world"));
  EXPECT_THAT(simulation.warnings(), testing::IsEmpty());
  simulation.Step(6000);
  EXPECT_THAT(simulation.failures(), testing::IsEmpty());
  std::map<std::string, int> counts = CountsOf(simulation.reports());
  int delivered = 0;
  for (const char* carrier : {"c1", "c2", "c3", "c4"}) {
    EXPECT_GE(counts[carrier], 4) << carrier;
    delivered += counts[carrier];
  }
  // The stations see the same units with sensors of their own. A unit may be on its way.
  EXPECT_NEAR(counts["depot"], delivered, 3);
  EXPECT_GE(counts["mine"], counts["depot"] - 1);
}

// The least energy that each robot has had, in J, and the units that all have delivered.
struct EnergyRun {
  double least = 1e9;
  std::size_t charges = 0;  // how often a robot has begun to be charged
  int delivered = 0;
  std::size_t out_of_energy = 0;  // events
};

EnergyRun RunForagers(const std::string& scenario, Tick ticks) {
  Simulation simulation = LoadFile(scenario);
  EXPECT_THAT(simulation.warnings(), testing::IsEmpty());
  EnergyRun run;
  std::map<std::string, int> counts;
  const std::vector<ModelId> stores = FindStores(simulation.world());
  std::vector<bool> was_charged(stores.size(), false);
  while (simulation.tick() < ticks) {
    simulation.Step();
    for (const auto& [robot, count] : CountsOf(simulation.reports())) counts[robot] = count;
    for (const Event& event : simulation.events()) run.out_of_energy += event.type == EventType::kOutOfEnergy ? 1 : 0;
    for (std::size_t i = 0; i < was_charged.size(); ++i) {
      const StoreState& store = simulation.state().stores[i];
      if (simulation.world().model(stores[i]).power.endless) continue;
      run.least = std::min(run.least, store.joules);
      run.charges += store.charge_watts > 0.0 && !was_charged[i] ? 1 : 0;
      was_charged[i] = store.charge_watts > 0.0;
    }
  }
  EXPECT_THAT(simulation.failures(), testing::IsEmpty());
  for (const char* carrier : {"c1", "c2", "c3", "c4"}) run.delivered += counts[carrier];
  return run;
}

TEST(StageTasks, ForagersThatChargeNeverRunDry) {
  const EnergyRun run = RunForagers(WorldPath("scenarios/foraging_energy.json"), 12000);
  EXPECT_GT(run.least, 800.0) << "of 8 kJ";
  EXPECT_EQ(run.out_of_energy, 0u);
  EXPECT_GE(run.charges, 12u);
  EXPECT_GE(run.delivered, 40);
}

TEST(StageTasks, ForagersWithoutAChargerRunDry) {
  const std::string scenario = testing::TempDir() + "without_charger.json";
  std::ofstream(scenario) << R"({"world": ")" << WorldPath("foraging_energy.world") << R"(", "seed": 4, "override": [
    {"match": {"name": "c?"}, "properties": {"ctrl": "fasr"}}]})";
  const EnergyRun run = RunForagers(scenario, 6000);
  EXPECT_EQ(run.out_of_energy, 4u);
  EXPECT_EQ(run.least, 0.0);
}

// A robot that recognizes its charger by a mark finds it by itself.
TEST(StageTasks, AForagerFindsItsChargerByAMark) {
  Simulation simulation = LoadText(R"(
model( name "charger" size [1 1 0.02] pose [-3 0 0 0] obstacle_return 0 joules -1 give_watts 300
  model( size [0.05 0.05 0.2] pose [0 0 0.38 0] obstacle_return 0 fiducial_return 3 ) )
position( name "r" size [0.4 0.4 0.25] pose [0 2 0 0] joules 700 joules_capacity 2000 watts 10 mass 4 take_watts 150
  ctrl "fasr [4,0] [0,0] charger=3 charge_below=0.4"
  ranger( pose [0 0 -0.1 0] sensor( range [0 8] fov 180 samples 91 ) )
  fiducial( pose [0 0 0.25 0] range_max 8 range_max_id 8 fov 360 ) )
)");
  EXPECT_THAT(simulation.warnings(), testing::IsEmpty());
  int delivered = 0;
  double most = 0.0;
  double charged_at = 0.0;  // J, when it left the charger
  while (simulation.tick() < 4000) {
    simulation.Step();
    const StoreState& store = simulation.state().stores[1];
    ASSERT_GT(store.joules, 100.0) << "tick " << simulation.tick();
    most = std::max(most, store.joules);
    if (store.charge_watts > 0.0) charged_at = store.joules;
    for (const auto& [robot, count] : CountsOf(simulation.reports())) delivered = count;
  }
  EXPECT_THAT(simulation.failures(), testing::IsEmpty());
  EXPECT_GE(most, 0.95 * 2000.0);
  EXPECT_GT(charged_at, 0.9 * 2000.0);
  EXPECT_GE(delivered, 4);
}

TEST(StageTasks, AForagerWithoutAFinderNeedsThePointOfItsCharger) {
  const std::string path = testing::TempDir() + "no_finder.world";
  std::ofstream(path) << R"(position( name "r" ctrl "fasr [4,0] [0,0] charger=3" ))";
  const Result<Simulation> loaded = Simulation::Load(path);
  ASSERT_FALSE(loaded.ok());
  EXPECT_THAT(loaded.error().ToString(),
              testing::HasSubstr("fasr: the robot has no fiducial finder to look for its charger, expected one, or a "
                                 "point [x, y]"));
}

TEST(StageTasks, AStationLowersItsMarkWhileItHasNoUnit) {
  Simulation simulation = LoadText(R"(
define station position
( size [0.5 0.5 0.3]
  ranger( pose [0 0 -0.2 0] sensor( range [0 4] fov 350 samples 71 ) )
  actuator( name "mark" type "linear" axis [0 0 1] max_speed 1 max_position 0.4 size [0.2 0.2 0.3] ) )
station( name "source" pose [0 0 0 0] ctrl "source 10 1" )
position( name "visitor" size [0.3 0.3 0.3] pose [-1 0 0 0] ctrl "idle" )
)");
  ASSERT_EQ(simulation.world().joints.size(), 1u);
  const auto mark = [&] { return simulation.state().joints[0].position; };
  simulation.Step(20);
  EXPECT_NEAR(mark(), 0.4, 1e-9);
  simulation.Step(20);
  EXPECT_NEAR(mark(), 0.0, 1e-9);  // the visitor has received the unit
  simulation.Step(80);
  EXPECT_NEAR(mark(), 0.4, 1e-9);  // another unit is there, but it is for another visit
  simulation.Step(100);
  EXPECT_NEAR(mark(), 0.4, 1e-9);
}

TEST(StageTasks, RobotsOfAStageWorldKnowTheModelsSourceAndSink) {
  Simulation simulation = LoadText(R"(
define zone model ( size [2 2 0.01] obstacle_return 0 ranger_return -1 )
zone( name "source" pose [-4 0 0 0] ctrl "source" )
zone( name "sink" pose [4 1 0 0] ctrl "sink" )
model( name "wall" size [0.2 3 1] pose [0 0.5 0 0] )
define bot position ( size [0.4 0.4 0.25] ranger( pose [0 0 -0.1 0] sensor( range [0 8] fov 180 samples 91 ) ) )
bot( name "a" pose [-2 0 0 0] ctrl "fasr reach=1" )
bot( name "b" pose [2 -2 0 0] localization "odom" odom_error [0 0 0 0] ctrl "fasr_plan" )
bot( name "c" pose [3 2 0 90] ctrl "fasr2" )
)");
  EXPECT_THAT(simulation.warnings(), testing::IsEmpty());
  simulation.Step(3000);
  EXPECT_THAT(simulation.failures(), testing::IsEmpty());
  std::map<std::string, int> counts = CountsOf(simulation.reports());
  for (const char* robot : {"a", "b", "c"}) EXPECT_GE(counts[robot], 3) << robot;
}

// An obstacle that opens to the robot catches one that knows only what it sees; a plan leads around it.
TEST(StageTasks, APlanLeadsOutOfADeadEnd) {
  Simulation simulation = LoadText(R"(
define wall model ( )
wall( size [0.2 6 1] pose [3 0 0 0] )
wall( size [5 0.2 1] pose [0.6 3 0 0] )
wall( size [5 0.2 1] pose [0.6 -3 0 0] )
position( name "r" size [0.4 0.4 0.25] pose [0 0 0 0] ctrl "fasr_plan [6,0] [0,0]"
  ranger( pose [0 0 -0.1 0] sensor( range [0 8] fov 240 samples 121 ) ) )
)");
  simulation.Step(1500);
  EXPECT_THAT(simulation.failures(), testing::IsEmpty());
  EXPECT_GE(CountsOf(simulation.reports())["r"], 1);
}

class StageControllersWorld : public testing::Test {
 protected:
  Simulation simulation_ = LoadFile(WorldPath("stage_controllers.world"));

  const Pose& PoseOf(const std::string& robot) const { return simulation_.pose(*simulation_.FindRobot(robot)); }
};

TEST_F(StageControllersWorld, RobotsFlock) {
  // The mean of the cosines and sines of the headings: 1 if all are equal.
  const auto order = [&] {
    Vec2 sum = Vec2::Zero();
    for (const char* robot : {"f1", "f2", "f3", "f4"}) {
      sum += Vec2(std::cos(PoseOf(robot).heading), std::sin(PoseOf(robot).heading));
    }
    return sum.norm() / 4.0;
  };
  EXPECT_LT(order(), 0.5);
  double together = 0.0;
  double aligned = 0.0;
  for (int i = 0; i < 100; ++i) {
    simulation_.Step(20);
    double farthest = 0.0;
    for (const char* a : {"f1", "f2", "f3", "f4"}) {
      for (const char* b : {"f1", "f2", "f3", "f4"}) {
        farthest = std::max(farthest, (PoseOf(a).translation() - PoseOf(b).translation()).norm());
      }
    }
    together += farthest < 5.0 ? 0.01 : 0.0;
    aligned += 0.01 * order();
  }
  EXPECT_GT(together, 0.7);
  EXPECT_GT(aligned, 0.7);
}

TEST_F(StageControllersWorld, TheMapIsMadeAndTheNoiseMeasured) {
  simulation_.Step(4000);
  EXPECT_THAT(simulation_.failures(), testing::IsEmpty());
  EXPECT_THAT(simulation_.reports(), testing::Contains(testing::StartsWith("robot mapper: the map is complete: ")));
  // sqrt(0.0004 m^2) is 0.02 m.
  EXPECT_THAT(simulation_.reports(),
              testing::Contains(testing::AllOf(testing::StartsWith("robot meter: 50 readings, 31 of 31 rays"),
                                               testing::HasSubstr("standard deviation 0.0"))));
  // Each is an event of its tick, too.
  std::size_t events = 0;
  for (int i = 0; i < 200 && events == 0; ++i) {
    simulation_.Step();
    for (const Event& event : simulation_.events()) {
      if (event.type != EventType::kReported || event.robot != simulation_.FindRobot("meter")) continue;
      EXPECT_EQ("robot meter: " + event.detail, simulation_.reports().at(0));
      EXPECT_EQ(event.tick, simulation_.tick());
      ++events;
    }
  }
  EXPECT_EQ(events, 1u);
}

TEST_F(StageControllersWorld, TheObstacleMovesToAndFro) {
  double least = 1e9;
  double most = -1e9;
  for (int i = 0; i < 300; ++i) {
    simulation_.Step(1);
    least = std::min(least, PoseOf("shuttle").x);
    most = std::max(most, PoseOf("shuttle").x);
  }
  EXPECT_NEAR(least, -2.0, 0.2);  // and a way to brake
  EXPECT_NEAR(most, 1.0, 0.2);
}

// The share of the robots that are in the greatest group, in which each is within 4 m of another.
double GreatestGroup(const Simulation& simulation) {
  const std::size_t count = simulation.world().robots.size();
  std::vector<bool> seen(count, false);
  std::size_t greatest = 0;
  for (std::size_t first = 0; first < count; ++first) {
    if (seen[first]) continue;
    std::vector<std::size_t> group = {first};
    seen[first] = true;
    for (std::size_t i = 0; i < group.size(); ++i) {
      for (std::size_t other = 0; other < count; ++other) {
        const Vec2 apart =
            simulation.pose(RobotId(group[i])).translation() - simulation.pose(RobotId(other)).translation();
        if (seen[other] || apart.norm() > 4.0) continue;
        seen[other] = true;
        group.push_back(other);
      }
    }
    greatest = std::max(greatest, group.size());
  }
  return static_cast<double>(greatest) / static_cast<double>(count);
}

std::string Birds(double loss) {
  std::string text =
      "define bird position( size [0.3 0.3 0.25] velocity_bounds [-0.6 0.6 0 0 0 0 -120 120] "
      "radio( range 8 bandwidth 2400 loss " +
      std::to_string(loss) + " ) ctrl \"flock\" )\n";
  for (int i = 0; i < 50; ++i) {
    text += "bird( pose [" + std::to_string(-6.0 + 1.7 * (i % 8)) + " " + std::to_string(-6.0 + 1.7 * (i / 8)) + " 0 " +
            std::to_string(i * 137 % 360) + "] )\n";
  }
  return text;
}

TEST(StageTasks, AFlockKeepsTogetherByItsRadiosAlone) {
  Simulation talking = LoadText(Birds(0.33));
  Simulation deaf = LoadText(Birds(1.0));
  EXPECT_EQ(GreatestGroup(talking), 1.0);
  talking.Step(1200);
  deaf.Step(1200);
  EXPECT_THAT(talking.failures(), testing::IsEmpty());
  EXPECT_GE(GreatestGroup(talking), 0.9);
  EXPECT_LT(GreatestGroup(deaf), 0.5);
}

// A copy of each controller continues as the original.
TEST(StageTasks, SnapshotsContinueAlike) {
  for (const char* world : {"foraging.world", "scenarios/foraging_energy.json", "stage_controllers.world"}) {
    Simulation simulation = LoadFile(WorldPath(world));
    simulation.Step(300);
    const Result<Snapshot> saved = simulation.Save();
    ASSERT_TRUE(saved.ok()) << saved.error().message;
    simulation.Step(300);
    const std::uint64_t hash = simulation.state_hash();
    ASSERT_TRUE(simulation.Restore(saved.value()).ok());
    simulation.Step(300);
    EXPECT_EQ(simulation.state_hash(), hash) << world;
  }
}

}  // namespace
}  // namespace troupe
