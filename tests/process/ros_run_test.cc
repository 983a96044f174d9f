// Whole runs, seen from a ROS domain: the messages agree with the files that the run writes, and observation does not
// change the run.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>
#include <set>
#include <sstream>

#include "ros/connection/ros_endpoints.h"
#include "ros/connection/ros_network.h"
#include "ros/connection/topic_types.h"
#include "ros/messages/convert.h"
#include "tests/process/programs.h"
#include "tests/process/run_files.h"
#include "tests/support/files.h"
#include "tests/support/ros_client.h"
#include "tests/support/ros_domain.h"
#include "tests/support/ros_graph.h"
#include "transport/dds/binding/wire.h"

namespace troupe::test {
namespace {

// Reads the topics of r0 and r1 while a program runs, and stores the messages by tick.
class Reader {
 public:
  void Drain() {
    for (Robot& robot : robots_) {
      robot.truth.Drain([&](const ros::OdometryMessage& message) {
        const auto& position = message.pose.pose.position;
        const auto& turn = message.pose.pose.orientation;
        robot.poses[TickOf(message.header.stamp)] = {position.x, position.y, position.z,
                                                     2.0 * std::atan2(turn.z, turn.w)};
      });
      robot.scan.Drain([&](const ros::LaserScan& scan) {
        const auto ranges = dds::Elements(scan.ranges);
        robot.scans[TickOf(scan.header.stamp)] = {ranges.begin(), ranges.end()};
      });
    }
    clock_.Drain([&](const ros::Clock& clock) { clocks_.push_back(TickOf(clock.clock)); });
  }

  struct Robot {
    Robot(const ros::RosNode& node, const std::string& robot_name)
        : name(robot_name),
          truth(node, "/" + name + "/ground_truth", ros::Stream(1000)),
          scan(node, "/" + name + "/scan", ros::Stream(1000)) {}
    std::string name;
    ros::RosReader<ros::OdometryMessage> truth;
    ros::RosReader<ros::LaserScan> scan;
    std::map<Tick, Pose> poses;
    std::map<Tick, std::vector<float>> scans;
  };
  const std::vector<Robot>& robots() const { return robots_; }
  const std::vector<Tick>& clocks() const { return clocks_; }

 private:
  std::vector<Robot> MakeRobots() {
    std::vector<Robot> robots;
    for (const char* name : {"r0", "r1"}) robots.emplace_back(node_, name);
    return robots;
  }

  ros::RosParticipant participant_{TestRosNetwork()};
  ros::RosNode node_ = ros::MakeNode(participant_, "/", "reader");
  std::vector<Robot> robots_ = MakeRobots();
  ros::RosReader<ros::Clock> clock_{node_, "/clock", ros::Stream(1000)};
  std::vector<Tick> clocks_;
};

TEST(RosRun, PublishesTheValuesInTheRunsFilesWithoutChangingTheRun) {
  TemporaryFolder folder;
  Reader reader;
  Program run = RunPen(RosArguments({"--ticks", "300", "--speed", "10", "--poses", folder.Path("poses"), "--scans",
                                     folder.Path("scans"), "--hash-log", folder.Path("hashes")}));
  ASSERT_EQ(run.Wait(), 0) << run.output();
  reader.Drain();
  const auto poses = ReadPoses(folder.Read("poses"));
  const auto scans = ReadScans(folder.Read("scans"));
  for (const Reader::Robot& robot : reader.robots()) {
    EXPECT_GT(robot.poses.size(), 100u);
    EXPECT_GT(robot.scans.size(), 100u);
    for (const auto& [tick, pose] : robot.poses) {
      const auto& logged = poses.at({tick, robot.name});
      ASSERT_EQ(pose.x, logged.X_WR.x);
      ASSERT_EQ(pose.y, logged.X_WR.y);
      ASSERT_EQ(pose.z, logged.X_WR.z);
      ASSERT_NEAR(pose.heading, logged.X_WR.heading, 1e-12);
    }
    for (const auto& [tick, ranges] : robot.scans) {
      const std::vector<double>& logged = scans.at({tick, robot.name, "ranger:1.0"});
      std::vector<float> expected(logged.begin(), logged.end());
      for (float& range : expected) range = range < 8.0F ? range : std::numeric_limits<float>::infinity();  // no hit
      ASSERT_EQ(ranges, expected);
    }
  }
  EXPECT_GT(reader.clocks().size(), 100u);
  EXPECT_TRUE(std::is_sorted(reader.clocks().begin(), reader.clocks().end()));
  EXPECT_EQ(reader.clocks().back(), 300u);

  TemporaryFolder without;
  OutputOf(RunPen({"--no-ros", "--ticks", "300", "--hash-log", without.Path("hashes")}));
  EXPECT_EQ(folder.Read("hashes"), without.Read("hashes"));
}

// Drives r0 by hand, stepping from a pause, and returns the hash after each step.
std::vector<std::string> StepByService(int steps) {
  TemporaryFolder folder;
  ros::RosParticipant participant(TestRosNetwork());
  const ros::RosNode node = ros::MakeNode(participant, "/", "tester");
  ros::RosReader<ros::LaserScan> scans(node, "/r0/scan", ros::Stream(1000));
  TROUPE_SIMULATION_CLIENT(StepSimulation)
  step(participant, "/world/step_simulation");
  Program run = RunPen(RosArguments({"--paused", "--speed", "1", "--hash-log", folder.Path("hashes")}));
  std::set<Tick> seen;
  for (int i = 1; i <= steps; ++i) {
    StepBy(step, 2);
    if (!seen.empty()) {
      // Written before the step returned, but perhaps still on the network.
      EXPECT_TRUE(Eventually([&] {
        scans.Drain([&](const ros::LaserScan& scan) { seen.insert(TickOf(scan.header.stamp)); });
        return seen.contains(static_cast<Tick>(2 * i));
      }));
    }
    scans.Drain([&](const ros::LaserScan& scan) { seen.insert(TickOf(scan.header.stamp)); });
  }
  EXPECT_FALSE(seen.empty());
  TROUPE_SIMULATION_CLIENT(GetSimulationState)
  state(participant, "/world/get_simulation_state");
  state.Call({}, [](const auto& response) { EXPECT_EQ(response.state.state, 2) << "paused"; });
  TROUPE_SIMULATION_CLIENT(GetEntities)
  entities(participant, "/world/get_entities");
  entities.Call({}, [](const auto& response) {
    EXPECT_THAT(dds::Strings(response.entities), testing::ElementsAre("r0", "r1", "r2", "r3"));
  });
  run.Interrupt();
  std::istringstream lines(folder.Read("hashes"));
  std::vector<std::string> hashes;
  for (std::string line; std::getline(lines, line);) hashes.push_back(line);
  return hashes;
}

TEST(RosRun, StepsByServiceWithTheSameHashesTwiceAndTheSensorDataOfEachStep) {
  const std::vector<std::string> first = StepByService(50);
  EXPECT_EQ(first.size(), 101u);
  EXPECT_EQ(StepByService(50), first);
}

// The services that edit a world, called as by a tool.
class WorldServices {
 public:
  std::uint8_t Spawn(const char* name, const char* uri, double x, double y, std::string* called = nullptr) {
    simulation_interfaces_srv_dds__SpawnEntity_Request_ request{};
    request.name = const_cast<char*>(name);
    request.uri = const_cast<char*>(uri);
    request.initial_pose.pose = ros::ToMessage(Pose{x, y, 0.0, 0.0});
    std::uint8_t result = 0;
    spawn_.Call(request, [&](const auto& response) {
      result = response.result.result;
      if (called != nullptr) *called = dds::Text(response.entity_name);
    });
    return result;
  }
  std::uint8_t Delete(const char* name) {
    simulation_interfaces_srv_dds__DeleteEntity_Request_ request{};
    request.entity = const_cast<char*>(name);
    return delete_.ResultOf(request);
  }
  std::uint8_t SetPose(const char* name, const ros::PoseMessage& pose) {
    simulation_interfaces_srv_dds__SetEntityState_Request_ request{};
    request.entity = const_cast<char*>(name);
    request.state.pose = pose;
    return set_state_.ResultOf(request);
  }
  // Names and x of the entities that pass the filter.
  std::map<std::string, double> States(const char* filter, std::vector<std::uint8_t> categories = {}) {
    simulation_interfaces_srv_dds__GetEntitiesStates_Request_ request{};
    request.filters.filter = const_cast<char*>(filter);
    dds::WireArena arena;
    auto* category = arena.Fill(request.filters.categories, categories.size());
    for (const std::uint8_t number : categories) (category++)->category = number;
    std::map<std::string, double> states;
    states_.Call(request, [&](const auto& response) {
      const std::vector<std::string> names = dds::Strings(response.entities);
      ASSERT_EQ(names.size(), response.states._length);
      for (std::size_t i = 0; i < names.size(); ++i) {
        states[names[i]] = response.states._buffer[i].pose.position.x;
      }
    });
    return states;
  }
  std::uint8_t Reset(std::uint8_t scope) {
    simulation_interfaces_srv_dds__ResetSimulation_Request_ request{};
    request.scope = scope;
    return reset_.ResultOf(request);
  }
  std::uint8_t Load(const std::string& uri) {
    simulation_interfaces_srv_dds__LoadWorld_Request_ request{};
    request.uri = const_cast<char*>(uri.c_str());
    return load_.ResultOf(request);
  }
  std::vector<std::string> Spawnables() {
    std::vector<std::string> uris;
    spawnables_.Call({}, [&](const auto& response) {
      for (const auto& spawnable : dds::Elements(response.spawnables)) uris.push_back(dds::Text(spawnable.uri));
    });
    return uris;
  }
  std::uint8_t CategoryOf(const char* name) {
    simulation_interfaces_srv_dds__GetEntityInfo_Request_ request{};
    request.entity = const_cast<char*>(name);
    std::uint8_t category = 0;
    info_.Call(request, [&](const auto& response) { category = response.info.category.category; });
    return category;
  }
  void Step() { StepBy(step_, 1); }
  void PlainReset() {
    plain_reset_.Call({}, [](const auto&) {});
  }

 private:
  ros::RosParticipant participant_{TestRosNetwork()};
  ros::RosNode node_ = ros::MakeNode(participant_, "/", "editor");
  TROUPE_SIMULATION_CLIENT(SpawnEntity)
  spawn_{participant_, "/world/spawn_entity"};
  TROUPE_SIMULATION_CLIENT(DeleteEntity)
  delete_{participant_, "/world/delete_entity"};
  TROUPE_SIMULATION_CLIENT(SetEntityState)
  set_state_{participant_, "/world/set_entity_state"};
  TROUPE_SIMULATION_CLIENT(GetEntitiesStates)
  states_{participant_, "/world/get_entities_states"};
  TROUPE_SIMULATION_CLIENT(ResetSimulation)
  reset_{participant_, "/world/reset_simulation"};
  TROUPE_SIMULATION_CLIENT(LoadWorld) load_{participant_, "/world/load_world"};
  TROUPE_SIMULATION_CLIENT(GetSpawnables)
  spawnables_{participant_, "/world/get_spawnables"};
  TROUPE_SIMULATION_CLIENT(GetEntityInfo)
  info_{participant_, "/world/get_entity_info"};
  TROUPE_SIMULATION_CLIENT(StepSimulation)
  step_{participant_, "/world/step_simulation"};
  Client<std_srvs_srv_dds__Empty_Request_, std_srvs_srv_dds__Empty_Response_> plain_reset_{participant_, "/reset"};
};

TEST(RosRun, EditsTheWorldByService) {
  WorldServices world;
  ros::RosParticipant participant(TestRosNetwork());
  const ros::RosNode node = ros::MakeNode(participant, "/", "reader");
  ros::RosReader<ros::OdometryMessage> truth(node, "/late/ground_truth", ros::Stream(1000));
  TemporaryFolder folder;
  const std::string broken = folder.Path("broken.world");
  std::ofstream(broken) << "position ( name \"x\"\n";
  Program run = RunPen(RosArguments({"--paused", "--allow-files", folder.Path("")}));
  run.WaitForLine("ready");

  EXPECT_THAT(world.Spawnables(), testing::IsSupersetOf({"rover", "wall", "model", "position"}));
  std::string called;
  EXPECT_EQ(world.Spawn("late", "rover", 0.0, -2.0, &called), kOk);
  EXPECT_EQ(called, "late");
  EXPECT_EQ(world.CategoryOf("late"), 1) << "a robot";
  EXPECT_EQ(world.Spawn("late", "rover", 0.0, 2.0), 101) << "the name is not unique";
  EXPECT_EQ(world.Spawn("other", "", 0.0, 2.0), 104) << "no resource";
  EXPECT_EQ(world.Spawn("other", "truck", 0.0, 2.0), kFailed);
  for (const std::string& name : {std::string("bad name!"), std::string("-x"), std::string("a/b"), std::string("\xff"),
                                  std::string(2'000'000, 'x')}) {
    EXPECT_EQ(world.Spawn(name.c_str(), "rover", 0.0, 2.0), 102) << "an invalid name";
  }
  EXPECT_EQ(world.Spawn("other", "/models/robot.urdf", 0.0, 2.0), 103) << "an unsupported format";
  EXPECT_EQ(world.Spawn("other", "package://models/robot.world", 0.0, 2.0), 103) << "an unsupported scheme";
  EXPECT_EQ(world.Spawn("other", broken.c_str(), 0.0, 2.0), 106) << "a file that cannot be parsed";
  EXPECT_EQ(world.Load(broken), 103) << "a file that cannot be parsed";
  EXPECT_EQ(world.Spawn("other", "rover", 0.0, -2.0), 109) << "the place is occupied";
  EXPECT_EQ(world.Spawn("other", "rover", 3.1, 0.0), 109) << "in a wall";
  EXPECT_EQ(world.Spawn("other", "rover", std::nan(""), 0.0), 109) << "a pose that is not finite";

  EXPECT_EQ(world.SetPose("late", ros::ToMessage(Pose{1.0, -2.0, 0.0, 1.0})), kOk);
  EXPECT_EQ(world.SetPose("nobody", ros::ToMessage(Pose{})), kNotFound);
  EXPECT_EQ(world.SetPose("late", {}), 101) << "no quaternion";
  ros::PoseMessage tilted = ros::ToMessage(Pose{});
  tilted.orientation = {0.7, 0.0, 0.0, 0.7};
  EXPECT_EQ(world.SetPose("late", tilted), 101);
  EXPECT_EQ(world.SetPose("late", ros::ToMessage(Pose{3.1, 0.0, 0.0, 0.0})), 101) << "in a wall";
  EXPECT_THAT(world.States("^late$"), testing::ElementsAre(testing::Pair("late", 1.0)));
  EXPECT_THAT(world.States("", {5}), testing::SizeIs(6)) << "static models";
  EXPECT_TRUE(Eventually([&] {
    double x = 0.0;
    world.Step();  // samples written before discovery was complete are lost
    truth.Drain([&](const ros::OdometryMessage& message) { x = message.pose.pose.position.x; });
    return x == 1.0;
  })) << "its agent publishes the new pose";

  EXPECT_EQ(world.Delete("r1"), kOk);
  EXPECT_EQ(world.Delete("r1"), kNotFound);
  EXPECT_EQ(world.States("").size(), 4u);
  EXPECT_EQ(world.Reset(8), kFailed) << "no such scope";
  EXPECT_EQ(world.Reset(4), kOk);
  EXPECT_EQ(world.States("").size(), 3u) << "spawned entities are gone";
  EXPECT_EQ(world.Reset(0), kOk);
  EXPECT_EQ(world.States("").size(), 4u) << "deleted entities are back";
  EXPECT_EQ(world.Load(WorldPath("pen.world")), kOk);
  EXPECT_EQ(world.Load("/nowhere.world"), kFailed);
  EXPECT_EQ(world.Load("/worlds/office.sdf"), 101) << "an unsupported format";
  world.PlainReset();
  run.Interrupt();
}

TEST(RosRun, OpensNothingInTheRosDomainUnlessAsked) {
  ros::RosParticipant participant(TestRosNetwork());
  const ros::RosNode node = ros::MakeNode(participant, "/", "reader");
  ros::RosReader<ros::Clock> clock(node, "/clock", ros::Stream(10));
  const std::string domain = std::to_string(TestRosNetwork().domain);
  EXPECT_THAT(OutputOf(RunPen({"--ros-domain", domain}), 2),
              testing::HasSubstr("found a run without ROS 2, expected --ros"));
  setenv("ROS_DOMAIN_ID", domain.c_str(), 1);
  OutputOf(RunPen({"--ticks", "20", "--speed", "10"}));
  unsetenv("ROS_DOMAIN_ID");
  clock.Drain([](const ros::Clock&) { FAIL() << "a clock without --ros"; });
}

// Names of people's worlds that ROS does not allow, from a folder that is not part of the project.
TEST(RosRun, ARobotWhoseNameIsValidKeepsItsTopicsAndOthersHaveANotice) {
  const char* const source = std::getenv("TROUPE_SOURCE_DIR");
  const std::string file = std::string(source != nullptr ? source : ".") + "/../shared/cases/ros_names.world";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "no file " << file;
  std::vector<std::string> arguments = {"run",        file,       "--domain",  std::to_string(TestDomain()),
                                        "--headless", "--paused", "--session", TestSession("names")};
  for (const std::string& argument : RosArguments({})) arguments.push_back(argument);
  Program run = Troupe(arguments);
  run.WaitForLine(", ready");
  RosGraph graph;
  const std::set<std::string> expected = {"/n0/odom", "/a_b/odom", "/a_b_1/odom"};
  EXPECT_TRUE(Eventually([&] {
    const std::set<std::string> topics = graph.Topics("/");
    return std::includes(topics.begin(), topics.end(), expected.begin(), expected.end());
  }));
  run.Interrupt();
  EXPECT_THAT(run.output(), testing::HasSubstr("the topics of robot '0' are below /n0:"));
  EXPECT_THAT(run.output(), testing::HasSubstr("the topics of robot 'a-b' are below /a_b_1:"));
  EXPECT_THAT(run.output(), testing::Not(testing::HasSubstr("robot 'a_b'")));
}

}  // namespace
}  // namespace troupe::test
