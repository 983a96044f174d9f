// An Open-RMF beside a run, for tests: it sends requests and reads states.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "ros/connection/ros_endpoints.h"
#include "ros/connection/ros_network.h"
#include "ros/connection/ros_participant.h"
#include "ros/messages/rmf.h"
#include "tests/process/programs.h"
#include "tests/support/dds_domain.h"
#include "tests/support/files.h"
#include "tests/support/ros_client.h"
#include "tests/support/ros_domain.h"

namespace troupe::test {

inline constexpr const char* kHouse = "../../../worlds/sites/guesthouse.building.yaml";

struct LiftSeen {
  std::string floor;
  std::string session;
  std::uint8_t doors = 0;
  std::uint8_t motion = 0;
};

// An Open-RMF beside a run of the guesthouse.
class Rmf : public testing::Test {
 protected:
  Rmf() : participant_(TestRosNetwork()), node_(ros::MakeNode(participant_, "/", "rmf")) { participant_.Announce(); }

  void Start(const std::vector<std::string>& more, const std::string& world = WorldPath(kHouse)) {
    run_.emplace(
        Troupe(Words("run % --headless --session % --domain %", {world, session_, std::to_string(TestDomain())}) +
               RosArguments(more)));
    run_->WaitForLine(", ready");
  }

  void SetSpeed(const std::string& speed) {
    OutputOf(Troupe(Words("ctl speed % --session % --domain %", {speed, session_, std::to_string(TestDomain())})));
  }

  void RequestDoor(const char* door, ros::DoorMode mode, const char* requester = "test") {
    ros::DoorRequest request{};
    request.requester_id = Text(requester);
    request.door_name = Text(door);
    request.requested_mode.value = static_cast<std::uint32_t>(mode);
    door_requests_.Write(request);
  }
  void RequestLift(const char* floor, const char* session, ros::LiftRequestType type = ros::LiftRequestType::kAgv) {
    ros::LiftRequest request{};
    request.lift_name = Text("guest_lift");
    request.session_id = Text(session);
    request.request_type = static_cast<std::uint8_t>(type);
    request.destination_floor = Text(floor);
    request.door_state = 2;
    lift_requests_.Write(request);
  }
  bool AwaitReaders() {
    return Eventually([&] { return door_requests_.wanted() && lift_requests_.wanted(); });
  }

  std::map<std::string, std::uint32_t>& Doors() {
    door_states_.Drain([&](const ros::DoorStateMessage& state) { doors_[state.door_name] = state.current_mode.value; });
    return doors_;
  }
  bool DoorBecomes(const std::string& door, ros::DoorMode mode) {
    return Eventually([&] {
      const auto found = Doors().find(door);
      return found != doors_.end() && found->second == static_cast<std::uint32_t>(mode);
    });
  }
  const LiftSeen& Lift() {
    lift_states_.Drain([&](const ros::LiftStateMessage& state) {
      lift_ = {state.current_floor, state.session_id, state.door_state, state.motion_state};
      motions_.insert(state.motion_state);
      floors_ = dds::Strings(state.available_floors);
    });
    return lift_;
  }

  // The guesthouse without people, where tiny_1 follows paths.
  std::string WriteSlotcar() {
    folder_.Write("slotcar.json", R"({"world": ")" + WorldPath(kHouse) + R"(", "people": [],
      "robots": [{"name": "tiny_1", "controller": {"name": "slotcar"}}]})");
    return folder_.Path("slotcar.json");
  }
  // x, y, speed limit (0: none) and time of each point.
  void RequestPath(const std::string& task, const std::vector<std::array<double, 4>>& points,
                   const char* robot = "tiny_1") {
    dds::WireArena arena;
    ros::PathRequest request{};
    request.fleet_name = arena.Copy("any");
    request.robot_name = arena.Copy(robot);
    request.task_id = arena.Copy(task);
    ros::LocationMessage* location = arena.Fill(request.path, points.size());
    for (const auto& [x, y, limit, time] : points) {
      location->t = {static_cast<std::int32_t>(time), 0};
      location->x = static_cast<float>(x);
      location->y = static_cast<float>(y);
      location->yaw = 1.0F;
      location->obey_approach_speed_limit = limit > 0.0;
      location->approach_speed_limit = static_cast<float>(limit);
      location->level_name = arena.Copy("L1");
      location->index = static_cast<std::uint64_t>(location - request.path._buffer);
      ++location;
    }
    path_requests_.Write(request);
  }
  void RequestPause(std::uint32_t type, std::uint64_t number) {
    ros::PauseRequest request{};
    request.fleet_name = Text("any");
    request.robot_name = Text("tiny_1");
    request.mode_request_id = number;
    request.type = type;
    pause_requests_.Write(request);
  }
  bool AwaitRobot() {
    return Eventually(
        [&] { return path_requests_.wanted() && pause_requests_.wanted() && !Robot("tiny_1").name.empty(); });
  }
  const ros::RmfRobot& Robot(const std::string& name) {
    robot_states_.Drain([&](const ros::RobotStateMessage& state) {
      const ros::RmfRobot robot = ros::FromRobotState(state);
      robots_[robot.name] = robot;
      const double dx = robot.location.x - last_.x;
      const double seconds = robot.location.time.sec - last_.time.sec +
                             1e-9 * (static_cast<double>(robot.location.time.nanosec) - last_.time.nanosec);
      if (robot.name != "tiny_1") return;
      if (seconds > 0.0) fastest_ = std::max(fastest_, std::abs(dx) / seconds);
      last_ = robot.location;
    });
    return robots_[name];
  }
  bool RobotIsAt(double x, double y) {
    return Eventually(
        [&] {
          const ros::RmfLocation& at = Robot("tiny_1").location;
          return std::hypot(at.x - x, at.y - y) < 0.03 && Robot("tiny_1").mode == ros::RobotMode::kIdle;
        },
        60.0);
  }

  TemporaryFolder folder_;
  const std::string session_ = TestSession("rmf");
  ros::RosParticipant participant_;
  ros::RosNode node_;
  ros::RosWriter<ros::DoorRequest> door_requests_{node_, "/door_requests", ros::Stream(10)};
  ros::RosWriter<ros::LiftRequest> lift_requests_{node_, "/lift_requests", ros::Stream(100)};
  ros::RosReader<ros::DoorStateMessage> door_states_{node_, "/door_states", ros::Stream(100)};
  ros::RosReader<ros::LiftStateMessage> lift_states_{node_, "/lift_states", ros::Stream(100)};
  ros::RosWriter<ros::PathRequest> path_requests_{node_, "/robot_path_requests", ros::Stream(10)};
  ros::RosWriter<ros::PauseRequest> pause_requests_{node_, "/robot_pause_requests", ros::Stream(10)};
  ros::RosReader<ros::RobotStateMessage> robot_states_{node_, "/robot_state", ros::Stream(100)};
  std::map<std::string, ros::RmfRobot> robots_;
  ros::RmfLocation last_;
  double fastest_ = 0.0;  // m/s along x between two states of tiny_1
  std::map<std::string, std::uint32_t> doors_;
  LiftSeen lift_;
  std::set<std::uint8_t> motions_;
  std::vector<std::string> floors_;
  std::optional<Program> run_;
};

}  // namespace troupe::test
