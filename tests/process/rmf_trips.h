// Trips of robots by Open-RMF's messages alone: robots cross levels through doors and lifts, in ticks that wait for the
// node that sends them. It decides once in each tick, when it has all states of that, so run after run is the same.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <map>
#include <mutex>
#include <optional>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "common/base/print.h"
#include "tests/process/rmf_run.h"
#include "tests/support/words.h"

namespace troupe::test {

inline constexpr Tick kBegin = 30;   // until then the endpoints discover each other
inline constexpr Tick kRepeat = 10;  // ticks after which a request without effect is sent again

struct Leg {
  enum class Kind : std::uint8_t { kOpen, kClose, kCall, kLeave, kDrive };
  Kind kind = Kind::kDrive;
  std::string name;   // of a door or a lift
  std::string floor;  // to which the lift is called
  std::vector<std::pair<double, double>> points = {};
};
inline Leg Open(const char* door) {
  return {Leg::Kind::kOpen, door, ""};
}
inline Leg Close(const char* door) {
  return {Leg::Kind::kClose, door, ""};
}
inline Leg Call(const char* lift, const char* floor) {
  return {Leg::Kind::kCall, lift, floor};
}
inline Leg Leave(const char* lift) {
  return {Leg::Kind::kLeave, lift, ""};
}
inline Leg Drive(std::vector<std::pair<double, double>> points) {
  return {Leg::Kind::kDrive, "", "", std::move(points)};
}

struct Trip {
  std::string robot;
  std::vector<Leg> legs;
  std::size_t leg = 0;
  Tick begun_at = 0;                     // the leg; 0: not yet
  std::optional<Tick> ended_at = {};     // the trip
  std::vector<std::string> levels = {};  // in the order in which the robot was there
};

// The node of a run.
class TripNode {
 public:
  TripNode(const ros::RosNode& node, std::vector<Trip>& trips)
      : ticks_(node, "/world/tick", ros::Latched(), ros::Part::kOnlyReader, [this] { Notify(); }),
        answers_(node, "/world/tick_done", ros::Stream(10)),
        doors_(node, "/door_states", ros::Stream(1000), ros::Part::kOnlyReader, [this] { Notify(); }),
        lifts_(node, "/lift_states", ros::Stream(1000), ros::Part::kOnlyReader, [this] { Notify(); }),
        robots_(node, "/robot_state", ros::Stream(1000), ros::Part::kOnlyReader, [this] { Notify(); }),
        door_requests_(node, "/door_requests", ros::Stream(100)),
        lift_requests_(node, "/lift_requests", ros::Stream(100)),
        paths_(node, "/robot_path_requests", ros::Stream(100)),
        trips_(trips) {}

  // Answers ticks until the run ends.
  void Run(Program& run) {
    while (!run.HasEnded()) {
      {
        std::unique_lock lock(mutex_);
        wake_.wait_for(lock, std::chrono::milliseconds(200), [this] { return arrived_; });
        arrived_ = false;
      }
      Receive();
      // Readers that came in the wait of the first tick get its messages again for a second: those are not counted.
      if (!shown_ || std::chrono::steady_clock::now() < counts_from_ || !answers_.wanted() ||
          !door_requests_.wanted() || !lift_requests_.wanted() || !paths_.wanted()) {
        continue;
      }
      if (decided_ == 0 && !std::exchange(is_known_, true)) {
        counts_from_ = std::chrono::steady_clock::now() + std::chrono::milliseconds(1500);
        continue;
      }
      const Tick tick = TickOf(*shown_);
      if (tick > std::max(kBegin, decided_) && !HasAllOf(tick)) continue;
      if (tick > kBegin && tick > decided_) {
        if (decided_ == 0) {
          EXPECT_FALSE(robot_of_.empty() || door_of_.empty() || lift_of_.empty());
        }
        for (Trip& trip : trips_) Decide(trip, tick);
        decided_ = tick;
      }
      dds::WireArena arena;
      answers_.Write({*shown_, arena.Copy("rmf")});
      shown_.reset();
    }
  }

 private:
  struct Lift {
    std::string floor;
    std::string session;
    std::uint8_t doors = 0;
  };

  void Notify() {
    const std::lock_guard lock(mutex_);
    arrived_ = true;
    wake_.notify_one();
  }
  void Count(const char* topic, const ros::Time& stamp) { ++received_[TickOf(stamp)][topic]; }
  // A tick that is announced again, as after an edit of it, needs no messages again.
  bool HasAllOf(Tick tick) {
    received_.erase(received_.begin(), received_.lower_bound(tick));
    return std::all_of(expected_.begin(), expected_.end(),
                       [&](const auto& of_topic) { return received_[tick][of_topic.first] >= of_topic.second; });
  }
  void Receive() {
    doors_.Drain([&](const ros::DoorStateMessage& state) {
      Count("/door_states", state.door_time);
      door_of_[state.door_name] = state.current_mode.value;
    });
    lifts_.Drain([&](const ros::LiftStateMessage& state) {
      Count("/lift_states", state.lift_time);
      lift_of_[state.lift_name] = {state.current_floor, state.session_id, state.door_state};
    });
    robots_.Drain([&](const ros::RobotStateMessage& message) {
      ros::RmfRobot robot = ros::FromRobotState(message);
      Count("/robot_state", robot.location.time);
      robot_of_[robot.name] = std::move(robot);
    });
    ticks_.Drain([&](const ros::Header& tick) {
      shown_ = tick.stamp;
      expected_.clear();
      std::istringstream topics(dds::Text(tick.frame_id));
      for (std::string topic; topics >> topic;) {
        const std::size_t colon = topic.rfind(':');
        const std::string name = topic.substr(0, colon);
        if (name != "/door_states" && name != "/lift_states" && name != "/robot_state") continue;
        expected_[name] = std::stoull(topic.substr(colon + 1));
      }
    });
  }

  void Decide(Trip& trip, Tick tick) {
    if (trip.ended_at || !robot_of_.contains(trip.robot)) return;
    const std::string& level = robot_of_[trip.robot].location.level;
    if (trip.levels.empty() || trip.levels.back() != level) trip.levels.push_back(level);
    if (trip.leg == trip.legs.size()) {
      trip.ended_at = tick;
      return;
    }
    const Leg& leg = trip.legs[trip.leg];
    const bool is_new = std::exchange(trip.begun_at, trip.begun_at == 0 ? tick : trip.begun_at) == 0;
    const bool sends = is_new || (tick - trip.begun_at) % kRepeat == 0;
    if (!Performs(trip, leg, is_new, sends)) return;
    ++trip.leg;
    trip.begun_at = 0;
  }
  // Whether the leg has ended.
  bool Performs(const Trip& trip, const Leg& leg, bool is_new, bool sends) {
    switch (leg.kind) {
      case Leg::Kind::kOpen:
        if (door_of_[leg.name] == static_cast<std::uint32_t>(ros::DoorMode::kOpen)) return true;
        if (sends) RequestDoor(leg.name, trip.robot, ros::DoorMode::kOpen);
        return false;
      case Leg::Kind::kClose:
        RequestDoor(leg.name, trip.robot, ros::DoorMode::kClosed);
        return true;
      case Leg::Kind::kCall:
        return Calls(trip, leg, sends);
      case Leg::Kind::kLeave:
        RequestLift(leg.name, lift_of_[leg.name].floor, trip.robot, ros::LiftRequestType::kEndSession);
        return true;
      case Leg::Kind::kDrive:
        break;
    }
    const std::string task = trip.robot + std::to_string(trip.leg);
    if (is_new) RequestPath(trip.robot, task, leg.points);
    const ros::RmfRobot& robot = robot_of_[trip.robot];
    return robot.task == task && robot.mode == ros::RobotMode::kIdle && robot.path.empty();
  }
  bool Calls(const Trip& trip, const Leg& leg, bool sends) {
    const Lift& lift = lift_of_[leg.name];
    if (!lift.session.empty() && lift.session != trip.robot) return false;  // as the supervisor of lifts
    if (lift.session == trip.robot && lift.floor == leg.floor && lift.doors == 2) return true;
    if (sends) RequestLift(leg.name, leg.floor, trip.robot, ros::LiftRequestType::kAgv);
    return false;
  }

  void RequestDoor(const std::string& door, const std::string& robot, ros::DoorMode mode) {
    dds::WireArena arena;
    ros::DoorRequest request{};
    request.requester_id = arena.Copy(robot);
    request.door_name = arena.Copy(door);
    request.requested_mode.value = static_cast<std::uint32_t>(mode);
    door_requests_.Write(request);
  }
  void RequestLift(const std::string& lift, const std::string& floor, const std::string& session,
                   ros::LiftRequestType type) {
    dds::WireArena arena;
    ros::LiftRequest request{};
    request.lift_name = arena.Copy(lift);
    request.session_id = arena.Copy(session);
    request.request_type = static_cast<std::uint8_t>(type);
    request.destination_floor = arena.Copy(floor);
    request.door_state = 2;
    lift_requests_.Write(request);
  }
  void RequestPath(const std::string& robot, const std::string& task,
                   const std::vector<std::pair<double, double>>& points) {
    dds::WireArena arena;
    ros::PathRequest request{};
    request.fleet_name = arena.Copy("trial");
    request.robot_name = arena.Copy(robot);
    request.task_id = arena.Copy(task);
    ros::LocationMessage* location = arena.Fill(request.path, points.size() + 1);
    const ros::RmfLocation& at = robot_of_[robot].location;
    *location = ros::ToMessage(at, arena);
    location->t = {};
    for (const auto& [x, y] : points) {
      ++location;
      *location = ros::ToMessage(
          {.x = static_cast<float>(x), .y = static_cast<float>(y), .yaw = at.yaw, .level = at.level}, arena);
    }
    paths_.Write(request);
  }

  std::mutex mutex_;
  std::condition_variable wake_;
  bool arrived_ = true;
  ros::RosReader<ros::Header> ticks_;
  ros::RosWriter<ros::Header> answers_;
  ros::RosReader<ros::DoorStateMessage> doors_;
  ros::RosReader<ros::LiftStateMessage> lifts_;
  ros::RosReader<ros::RobotStateMessage> robots_;
  ros::RosWriter<ros::DoorRequest> door_requests_;
  ros::RosWriter<ros::LiftRequest> lift_requests_;
  ros::RosWriter<ros::PathRequest> paths_;
  std::vector<Trip>& trips_;
  std::optional<ros::Time> shown_;  // the tick that waits for the answer
  Tick decided_ = 0;
  bool is_known_ = false;  // to the run
  std::chrono::steady_clock::time_point counts_from_ = {};
  std::map<std::string, std::size_t> expected_;  // messages of the tick that waits, by topic
  std::map<Tick, std::map<std::string, std::size_t>> received_;
  std::map<std::string, std::uint32_t> door_of_;
  std::map<std::string, Lift> lift_of_;
  std::map<std::string, ros::RmfRobot> robot_of_;
};

class RmfTrials : public testing::Test {
 protected:
  struct Outcome {
    std::string hashes;
    std::vector<Trip> trips;
    double seconds = 0.0;
  };

  Outcome RunOnce(const std::string& scenario, std::vector<Trip> trips, int ticks,
                  const std::vector<std::string>& more = {}) {
    const std::string name = std::to_string(runs_++);
    ros::RosParticipant participant(TestRosNetwork());
    const ros::RosNode ros_node = ros::MakeNode(participant, "/", "rmf");
    TripNode node(ros_node, trips);
    participant.Announce();
    const auto begin = std::chrono::steady_clock::now();
    const std::vector<std::string> options =
        Words("--ticks % --ros-lockstep rmf --robots-per-process 100 --hash-log % --record %",
              {std::to_string(ticks), folder_.Path(name), folder_.Path(name + ".mcap")});
    Program run(Troupe(Words("run % --headless --speed max --domain %", {scenario, std::to_string(TestDomain())}) +
                       RosArguments(options + more)));
    node.Run(run);
    EXPECT_EQ(run.Wait(), 0) << run.output();
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - begin;
    Outcome outcome{folder_.Read(name), std::move(trips), seconds.count()};
    if (runs_ == 1) OutputOf(Troupe({"replay", folder_.Path(name + ".mcap"), "--verify"}));
    Report(outcome);
    return outcome;
  }
  static void Report(const Outcome& outcome) {
    std::istringstream lines(outcome.hashes);
    std::string last;
    for (std::string line; std::getline(lines, line);) last = line;
    std::string ends;
    for (const Trip& trip : outcome.trips) {
      ends += " " + trip.robot +
              (trip.ended_at ? " arrived at tick " + std::to_string(*trip.ended_at)
                             : " is at leg " + std::to_string(trip.leg));
    }
    PrintPlain(stdout, "{:.1f} s, last hash {},{}\n", outcome.seconds, last, ends);
  }
  // Each trip ends, and each run has the hashes of the first.
  Outcome ExpectSame(const std::string& scenario, const std::vector<Trip>& trips, int ticks, int runs) {
    const Outcome first = RunOnce(scenario, trips, ticks);
    EXPECT_FALSE(first.hashes.empty());
    for (const Trip& trip : first.trips) EXPECT_TRUE(trip.ended_at) << trip.robot << " is at leg " << trip.leg;
    for (int i = 1; i < runs; ++i) EXPECT_TRUE(RunOnce(scenario, trips, ticks).hashes == first.hashes) << "run " << i;
    return first;
  }

  TemporaryFolder folder_;
  int runs_ = 0;
};

}  // namespace troupe::test
