// Open-RMF's fleets, workcells and map, and the people of a run, as a program in ROS sees them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "idl/ros/building_map.h"
#include "tests/process/rmf_run.h"

namespace troupe::test {
namespace {

using testing::ElementsAre;
using testing::IsSupersetOf;

constexpr const char* kDelivery = "../../../worlds/sites/guesthouse_delivery.json";

using BuildingMap = rmf_building_map_msgs_msg_dds__BuildingMap_;
using MapRequest = rmf_building_map_msgs_srv_dds__GetBuildingMap_Request_;
using MapResponse = rmf_building_map_msgs_srv_dds__GetBuildingMap_Response_;

class RmfFleet : public Rmf {
 protected:
  // The robots of each fleet, of the newest messages.
  std::map<std::string, std::vector<std::string>>& Fleets() {
    fleet_states_.Drain([&](const ros::FleetStateMessage& fleet) {
      std::vector<std::string>& members = fleets_[fleet.name];
      members.clear();
      for (const auto& state : dds::Elements(fleet.robots)) {
        members.emplace_back(state.name);
        const ros::RmfRobot robot = ros::FromRobotState(state);
        if (!robot.path.empty()) tasks_[state.name].insert(robot.task);
        members_[state.name] = robot;
      }
    });
    return fleets_;
  }

  ros::RosReader<ros::FleetStateMessage> fleet_states_{node_, "/fleet_states", ros::Stream(1000)};
  std::map<std::string, std::vector<std::string>> fleets_;
  std::map<std::string, ros::RmfRobot> members_;
  std::map<std::string, std::set<std::string>> tasks_;  // by robot: those on whose path it has been
};

TEST_F(RmfFleet, AFleetHasItsNameFromItsSlotcarsOrTheBuilding) {
  folder_.Write("fleets.json", R"({"world": ")" + WorldPath(kHouse) + R"(", "people": [],
    "robots": [{"name": "tiny_1", "controller": {"name": "slotcar", "parameters": {"fleet": "small ones"}}}]})");
  Start({"--speed", "20"}, folder_.Path("fleets.json"));
  ASSERT_TRUE(Eventually([&] { return Fleets().size() == 2; }));
  EXPECT_THAT(Fleets()["small ones"], ElementsAre("tiny_1"));
  EXPECT_THAT(Fleets()["DeliveryRobot"], ElementsAre("delivery_1"));
  ASSERT_TRUE(AwaitRobot());
  const ros::RmfRobot begin = Robot("tiny_1");
  RequestPath("first", {{begin.location.x, begin.location.y, 0, 0}, {3, -3.75, 0, 0}});
  EXPECT_TRUE(Eventually([&] {
    Fleets();
    return tasks_["tiny_1"].contains("first");
  }));
  EXPECT_TRUE(Eventually([&] {
    Fleets();
    return members_["tiny_1"].path.empty() && std::abs(members_["tiny_1"].location.x - 3.0) < 0.05;
  }));
}

// A place of the scenario replaces that of the building, with its fleet.
TEST_F(RmfFleet, AFleetHasItsNameFromThePlaceWhereItsRobotStarts) {
  folder_.Write("fleets.json", R"({"world": ")" + WorldPath(kHouse) + R"(", "people": [],
    "places": [{"name": "charger_1", "pose": [1.5, -2, 0], "tags": ["L1", "robot:tiny_1", "fleet:small ones"]}]})");
  Start({"--speed", "20"}, folder_.Path("fleets.json"));
  ASSERT_TRUE(Eventually([&] { return Fleets().size() == 2; }));
  EXPECT_THAT(Fleets()["small ones"], ElementsAre("tiny_1"));
  EXPECT_THAT(Fleets()["DeliveryRobot"], ElementsAre("delivery_1"));
}

class RmfDelivery : public RmfFleet {
 protected:
  void Request(bool dispenses, const char* workcell, const char* number, const char* fleet = "deliveries") {
    dds::WireArena arena;
    const auto fill = [&](auto& request) {
      request.request_guid = arena.Copy(number);
      request.target_guid = arena.Copy(workcell);
      request.transporter_type = arena.Copy(fleet);
      auto* item = arena.Fill(request.items, 1);
      item->type_guid = arena.Copy("coke");
      item->quantity = 1;
      item->compartment_name = arena.Copy("");
    };
    ros::DispenserRequest dispense{};
    ros::IngestorRequest ingest{};
    if (dispenses) {
      fill(dispense);
      dispenser_requests_.Write(dispense);
    } else {
      fill(ingest);
      ingestor_requests_.Write(ingest);
    }
  }
  // The statuses that came for a request, in order.
  const std::vector<int>& Results(const std::string& number) {
    const auto add = [&](const auto& result) { results_[result.request_guid].push_back(result.status); };
    dispenser_results_.Drain(add);
    ingestor_results_.Drain(add);
    return results_[number];
  }
  bool Ends(const std::string& number, std::size_t count = 2) {
    return Eventually([&] { return Results(number).size() >= count; });
  }
  Pose PoseOf(const std::string& name) {
    control::Entities request{.name = name};
    const ControlReply reply = CallRun(session_, request);
    return reply.entities.empty() ? Pose{} : reply.entities.front().X_WE;
  }
  void DriveDelivery(const std::string& task, const std::vector<std::array<double, 4>>& points) {
    RequestPath(task, points, "delivery_1");
    const auto& end = points.back();
    ASSERT_TRUE(Eventually(
        [&] {
          const ros::RmfLocation& at = Robot("delivery_1").location;
          return std::hypot(at.x - end[0], at.y - end[1]) < 0.05 && Robot("delivery_1").mode == ros::RobotMode::kIdle &&
                 Robot("delivery_1").path.empty();
        },
        60.0));
  }

  ros::RosWriter<ros::DispenserRequest> dispenser_requests_{node_, "/dispenser_requests", ros::Stream(10)};
  ros::RosWriter<ros::IngestorRequest> ingestor_requests_{node_, "/ingestor_requests", ros::Stream(10)};
  ros::RosReader<ros::DispenserResult> dispenser_results_{node_, "/dispenser_results", ros::Stream(10)};
  ros::RosReader<ros::IngestorResult> ingestor_results_{node_, "/ingestor_results", ros::Stream(10)};
  ros::RosReader<ros::DispenserStateMessage> dispenser_states_{node_, "/dispenser_states", ros::Stream(10)};
  ros::RosReader<ros::IngestorStateMessage> ingestor_states_{node_, "/ingestor_states", ros::Stream(10)};
  std::map<std::string, std::vector<int>> results_;
};

constexpr int kAcknowledged = 0;
constexpr int kSucceeded = 1;
constexpr int kRefused = 2;

TEST_F(RmfDelivery, AnItemGoesFromTheDispenserWithTheRobotIntoTheIngestor) {
  Start({"--speed", "20", "--record", folder_.Path("run.mcap")}, WorldPath(kDelivery));
  ASSERT_TRUE(Eventually([&] {
    return dispenser_requests_.wanted() && ingestor_requests_.wanted() && path_requests_.wanted() &&
           !Robot("delivery_1").name.empty();
  }));
  std::set<std::string> workcells;
  ASSERT_TRUE(Eventually([&] {
    dispenser_states_.Drain([&](const ros::DispenserStateMessage& state) { workcells.insert(state.guid); });
    ingestor_states_.Drain([&](const ros::IngestorStateMessage& state) { workcells.insert(state.guid); });
    return workcells.size() == 3;
  }));
  EXPECT_THAT(workcells, ElementsAre("lobby_ingestor", "pantry_dispenser", "room_1_ingestor"));

  Request(true, "pantry_dispenser", "early");
  ASSERT_TRUE(Ends("early"));
  EXPECT_THAT(Results("early"), ElementsAre(kAcknowledged, kRefused));
  run_->WaitForLine("request 'early': no robot of fleet 'deliveries' is within 3 m");

  const ros::RmfLocation begin = Robot("delivery_1").location;
  DriveDelivery("fetch", {{begin.x, begin.y, 0, 0}, {4, -3.75, 0, 0}, {7, -3.75, 0, 0}, {11, -6.9, 0, 0}});
  Request(false, "lobby_ingestor", "far");
  ASSERT_TRUE(Ends("far"));
  EXPECT_THAT(Results("far"), ElementsAre(kAcknowledged, kRefused)) << "the robot is elsewhere";
  Request(true, "pantry_dispenser", "fetch");
  ASSERT_TRUE(Ends("fetch"));
  EXPECT_THAT(Results("fetch"), ElementsAre(kAcknowledged, kSucceeded));
  Request(true, "pantry_dispenser", "fetch");
  ASSERT_TRUE(Ends("fetch", 3));
  EXPECT_THAT(Results("fetch"), ElementsAre(kAcknowledged, kSucceeded, kSucceeded)) << "repeated";
  EXPECT_NEAR(PoseOf("coke_2").z, 0.8, 1e-9) << "is still on the table";
  EXPECT_NEAR(PoseOf("coke_1").z, 1.0, 1e-6) << "on the robot";
  EXPECT_NEAR(PoseOf("coke_1").x, 11.0, 0.06);

  DriveDelivery("bring", {{11, -6.9, 0, 0}, {7, -3.75, 0, 0}, {4.5, -3.75, 0, 0}});
  EXPECT_NEAR(PoseOf("coke_1").x, 4.5, 0.06) << "it has moved with the robot";
  EXPECT_NEAR(PoseOf("coke_1").z, 1.0, 1e-6);
  Request(false, "lobby_ingestor", "bring");
  ASSERT_TRUE(Ends("bring"));
  EXPECT_THAT(Results("bring"), ElementsAre(kAcknowledged, kSucceeded));
  EXPECT_NEAR(PoseOf("coke_1").x, 4.2, 1e-6);
  EXPECT_NEAR(PoseOf("coke_1").y, -5.4, 1e-6);
  EXPECT_NEAR(PoseOf("coke_1").z, 0.8, 1e-6) << "on the table";
  Request(false, "lobby_ingestor", "again");
  ASSERT_TRUE(Ends("again"));
  EXPECT_THAT(Results("again"), ElementsAre(kAcknowledged, kRefused));
  run_->WaitForLine("request 'again': robot 'delivery_1' carries no item");
  run_->Interrupt();
  OutputOf(Troupe({"replay", folder_.Path("run.mcap"), "--verify"}));
}

// A node for which ticks wait asks for something impossible in each tick: the two results of each request are messages
// of the tick after, and the announcement of that tick counts them.
TEST_F(RmfDelivery, ResultsAreAmongTheMessagesThatTheirTickAnnounces) {
  ros::RosReader<ros::Header> ticks(node_, "/world/tick", ros::Latched());
  ros::RosWriter<ros::Header> answers(node_, "/world/tick_done", ros::Stream(10));
  participant_.Announce();
  constexpr Tick kFirst = 5;
  constexpr Tick kLast = 25;
  Start({"--speed", "max", "--ticks", std::to_string(kLast + 2), "--ros-lockstep", "rmf", "--ros-lockstep-limit", "0"},
        WorldPath(kDelivery));
  ASSERT_TRUE(Eventually([&] { return dispenser_requests_.wanted() && answers.wanted(); }));
  std::map<Tick, std::string> lists;
  while (!run_->HasEnded()) {
    ASSERT_TRUE(Eventually([&] {
      bool is_shown = false;
      ticks.Drain([&](const ros::Header& tick) {
        is_shown = true;
        const Tick shown = TickOf(tick.stamp);
        lists[shown] = dds::Text(tick.frame_id);
        if (shown >= kFirst && shown <= kLast) Request(true, "pantry_dispenser", std::to_string(shown).c_str());
        dds::WireArena arena;
        answers.Write({tick.stamp, arena.Copy("rmf")});
      });
      Results("");  // the reader keeps few of them
      return is_shown || run_->HasEnded();
    }));
  }
  for (Tick tick = kFirst; tick <= kLast; ++tick) {
    EXPECT_THAT(Results(std::to_string(tick)), ElementsAre(kAcknowledged, kRefused));
    EXPECT_THAT(lists[tick + 1], testing::HasSubstr("/dispenser_results:2")) << "tick " << tick + 1;
  }
  EXPECT_THAT(lists[kFirst], testing::Not(testing::HasSubstr("/dispenser_results")));
}

class RmfMap : public Rmf {
 protected:
  struct Seen {
    std::string name;
    std::vector<std::string> levels;
    std::vector<std::string> doors;
    std::vector<std::string> graphs;
    std::vector<std::string> places;
    std::vector<std::string> lifts;
    std::vector<std::string> params;  // of vertices
    std::size_t walls = 0;
    std::size_t one_way = 0;  // lanes
    float lift_x = 0.0F;
    float lift_door_y = 0.0F;
  };
  static Seen Read(const BuildingMap& map) {
    Seen seen;
    seen.name = map.name;
    for (const auto& level : dds::Elements(map.levels)) {
      seen.levels.emplace_back(level.name);
      for (const auto& door : dds::Elements(level.doors)) seen.doors.emplace_back(door.name);
      for (const auto& place : dds::Elements(level.places)) seen.places.emplace_back(place.name);
      for (const auto& graph : dds::Elements(level.nav_graphs)) {
        seen.graphs.push_back(std::string(level.name) + "/" + graph.name);
        for (const auto& edge : dds::Elements(graph.edges)) seen.one_way += edge.edge_type;
        for (const auto& vertex : dds::Elements(graph.vertices)) {
          for (const auto& param : dds::Elements(vertex.params)) seen.params.emplace_back(param.name);
        }
      }
      seen.walls += level.wall_graph.edges._length;
    }
    for (const auto& lift : dds::Elements(map.lifts)) {
      seen.lifts.emplace_back(lift.name);
      seen.lift_x = lift.ref_x;
      seen.lift_door_y = lift.doors._buffer->v1_y;
    }
    return seen;
  }
  static void ExpectGuesthouse(const Seen& seen) {
    EXPECT_EQ(seen.name, "guesthouse");
    EXPECT_THAT(seen.levels, ElementsAre("L1", "L2"));
    EXPECT_THAT(seen.doors, ElementsAre("front_door", "lobby_door", "back_door", "closet_door", "room_1_door"));
    EXPECT_THAT(seen.graphs, ElementsAre("L1/0", "L1/1", "L2/0"));
    EXPECT_THAT(seen.lifts, ElementsAre("guest_lift"));
    EXPECT_EQ(seen.walls, 25u);
    EXPECT_EQ(seen.one_way, 1u);
    EXPECT_THAT(seen.places, IsSupersetOf({"entrance", "lobby", "pantry", "landing", "room_1"}));
    EXPECT_THAT(seen.params, IsSupersetOf({"dock_name", "pickup_dispenser", "dropoff_ingestor", "is_charger"}));
    EXPECT_NEAR(seen.lift_x, 10.0F, 1e-5);
    EXPECT_NEAR(seen.lift_door_y, -2.32F, 1e-5);
  }
  // Whether the topic has a message of the type.
  template <typename Message>
  bool Has(const std::string& topic, Seen* seen = nullptr) {
    ros::RosReader<Message> reader(node_, topic, ros::Latched());
    participant_.Announce();
    return Eventually([&] {
      bool has = false;
      reader.Drain([&](const Message& message) {
        has = true;
        if constexpr (std::is_same_v<Message, BuildingMap>) *seen = Read(message);
      });
      return has;
    });
  }
};

TEST_F(RmfMap, TheMapOfTheBuildingIsBesideTheOccupancyGrid) {
  Start({"--speed", "20"});
  Seen seen;
  EXPECT_TRUE(Has<BuildingMap>("/building_map", &seen));
  ExpectGuesthouse(seen);
  EXPECT_TRUE(Has<ros::OccupancyGridMessage>("/map"));
  Client<MapRequest, MapResponse> client(participant_, "/get_building_map");
  Seen answered;
  client.Call({}, [&](const MapResponse& response) { answered = Read(response.building_map); });
  ExpectGuesthouse(answered);
}

TEST_F(RmfMap, TheMapOfTheBuildingHasTheNameMapByChoice) {
  Start({"--speed", "20", "--ros-map", "building"});
  Seen seen;
  EXPECT_TRUE(Has<BuildingMap>("/map", &seen));
  ExpectGuesthouse(seen);
  EXPECT_TRUE(Has<ros::OccupancyGridMessage>("/occupancy_grid"));
}

TEST_F(RmfMap, AnotherBuildingWithTheSameLevelsLeavesTheMapEmpty) {
  Start({"--speed", "20", "--lease", "5"});
  control::LoadWorld load;
  load.source = WorldPath("../../../worlds/sites/clinic.building.yaml");
  const ControlReply loaded = CallRun(session_, load);
  ASSERT_TRUE(loaded.done) << loaded.problem;
  const auto levels = [&] {
    Client<MapRequest, MapResponse> client(participant_, "/get_building_map");
    std::optional<std::size_t> count;
    client.Call({}, [&](const MapResponse& response) { count = Read(response.building_map).levels.size(); });
    return count.value_or(99);
  };
  EXPECT_EQ(levels(), 0u);
  for (const pid_t service : ChildrenWith(*run_, "world-service")) ASSERT_EQ(kill(service, SIGKILL), 0);
  run_->WaitForLine("the world service has been started again");
  EXPECT_EQ(levels(), 0u);
}

TEST_F(RmfMap, AWorldWithoutABuildingHasNoMapToChoose) {
  Program run(Troupe(
      Words("run % --headless --domain % --ros-map building", {WorldPath("pen.world"), std::to_string(TestDomain())}) +
      RosArguments({})));
  EXPECT_EQ(run.Wait(), 2);
  EXPECT_THAT(run.output(), testing::HasSubstr("--ros-map building: found a run without the map of a building"));
}

TEST_F(Rmf, PeopleHavePlacesAndVelocities) {
  ros::RosReader<ros::PeopleMessage> reader(node_, "/people", ros::Stream(100));
  participant_.Announce();
  Start({"--speed", "2"});  // slow enough for two messages in a row on a busy machine
  std::map<std::string, std::vector<ros::Time>> stamps;
  std::map<std::string, std::pair<double, double>> places;
  double fastest = 0.0;
  double largest_error = 0.0;  // m, of the way that the velocity says
  ASSERT_TRUE(Eventually([&] {
    reader.Drain([&](const ros::PeopleMessage& message) {
      EXPECT_STREQ(message.header.frame_id, "map");
      for (const auto& person : dds::Elements(message.people)) {
        auto& before = stamps[person.name];
        const auto tick = TickOf(message.header.stamp);
        if (!before.empty() && TickOf(before.back()) + 1 == tick) {
          const auto [x, y] = places[person.name];
          const double way = std::hypot(person.position.x - x, person.position.y - y);
          const double speed = std::hypot(person.velocity.x, person.velocity.y);
          fastest = std::max(fastest, speed);
          largest_error = std::max(largest_error, std::abs(way - 0.1 * speed));
        }
        before.push_back(message.header.stamp);
        places[person.name] = {person.position.x, person.position.y};
        EXPECT_EQ(person.reliability, 1.0);
      }
    });
    return fastest > 0.3;
  }));
  EXPECT_LT(largest_error, 0.02);
  EXPECT_LT(fastest, 3.0);
}

}  // namespace
}  // namespace troupe::test
