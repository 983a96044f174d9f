#include "robot-agent/ros/slotcar_port.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/base/text.h"
#include "robot-agent/drive/drive.h"
#include "ros/connection/ros_network.h"
#include "ros/connection/topic_types.h"
#include "ros/messages/convert.h"
#include "troupe/deterministic_math.h"

namespace troupe {
namespace {

constexpr std::int32_t kRmfDepth = 10;       // as of the plugin slotcar
constexpr std::int32_t kRequestDepth = 100;  // of all robots
constexpr std::size_t kMaxReports = 100;     // between two calls
constexpr std::size_t kMaxText = 1000;       // bytes, of a request, whose texts are in each state of its robot
constexpr std::size_t kMaxShown = 200;       // bytes, of a text in a report
constexpr double kStands = 0.01;             // m/s, rad/s: no motion for Open-RMF
constexpr std::uint32_t kPauseNow = 0;
constexpr std::uint32_t kPauseAtCheckpoint = 1;

bool IsValid(const ros::LocationMessage& location) {
  return std::isfinite(location.x) && std::isfinite(location.y) && std::isfinite(location.yaw) &&
         std::isfinite(location.approach_speed_limit) && std::max(std::fabs(location.x), std::fabs(location.y)) < 1e6F;
}

// Times of Open-RMF are s of simulated time, by /clock.
PathPoint PointOf(const ros::RmfLocation& location) {
  return {Vec2(location.x, location.y), WrapAngle(location.yaw),
          location.obeys_speed_limit ? std::max(static_cast<double>(location.speed_limit), 0.0) : 0.0,
          static_cast<double>(location.time.sec) + 1e-9 * location.time.nanosec, location.index};
}

}  // namespace

SlotcarPort::OfJazzy::OfJazzy(const ros::RosNode& node) : states(node, "/robot_state", ros::Stream(kRmfDepth)) {}
SlotcarPort::OfKilted::OfKilted(const ros::RosNode& node) : states(node, "/robot_state", ros::Stream(kRmfDepth)) {}

// Robots with another controller only report their states. Types of fleet messages differ from Kilted on.
SlotcarPort::SlotcarPort(const ros::RosNode& node, const Scene& scene, const std::vector<RobotId>& robots)
    : scene_(&scene) {
  for (const RobotId id : robots) members_.push_back(MakeMember(id));
  const bool is_later = node.connection->distribution() >= ros::Distribution::kKilted;
  if (is_later) {
    kilted_ = std::make_unique<OfKilted>(node);
  } else {
    jazzy_ = std::make_unique<OfJazzy>(node);
  }
  if (std::none_of(members_.begin(), members_.end(), [](const Member& member) { return member.follower.has_value(); }))
    return;
  const ros::TopicQos qos = ros::Stream(kRequestDepth);
  paths_ = std::make_unique<ros::RosReader<ros::PathRequest>>(node, "/robot_path_requests", qos);
  pauses_ = std::make_unique<ros::RosReader<ros::PauseRequest>>(node, "/robot_pause_requests", qos);
  if (is_later) {
    kilted_->modes.emplace(node, "/robot_mode_requests", qos);
  } else {
    jazzy_->modes.emplace(node, "/robot_mode_requests", qos);
  }
}

SlotcarPort::Member SlotcarPort::MakeMember(RobotId robot) const {
  const RobotDescription& description = scene_->world().robot(robot);
  Member member{.id = robot};
  member.robot.name = description.name;
  member.robot.model = scene_->world().model(description.root).type;
  if (description.controller.name != ros::kPathController) return member;
  const Result<SlotcarParameters> parameters = ReadSlotcarParameters(description.controller.parameters);
  if (!parameters.ok()) return member;
  member.parameters = parameters.value();
  member.follower.emplace(description.drive, parameters.value());
  return member;
}

// Requests for robots of other agents arrive on the same topics, and are ignored.
SlotcarPort::Member* SlotcarPort::Find(const char* name) {
  const auto found = std::find_if(members_.begin(), members_.end(), [name](const Member& member) {
    return member.follower && name != nullptr && member.robot.name == name;
  });
  return found != members_.end() ? &*found : nullptr;
}

void SlotcarPort::Receive(const WorldState& state) {
  if (!paths_) return;
  paths_->Drain([&](const ros::PathRequest& request) { ApplyPath(request, state); });
  pauses_->Drain([&](const ros::PauseRequest& request) { ApplyPause(request); });
  const auto apply_mode = [&](const auto& request) {
    ApplyMode(request.robot_name, request.mode.mode, request.mode.mode_request_id);
  };
  if (jazzy_) jazzy_->modes->Drain(apply_mode);
  if (kilted_) kilted_->modes->Drain(apply_mode);
}

// A path replaces the one before. Texts are bounded, since each state of the robot repeats them.
void SlotcarPort::ApplyPath(const ros::PathRequest& request, const WorldState& state) {
  Member* const member = Find(request.robot_name);
  if (member == nullptr) return;
  const std::string task = dds::Text(request.task_id);
  if (member->has_task && task == member->robot.task) return;  // repeated
  const auto locations = dds::Elements(request.path);
  const auto refuse = [&](const char* problem) {
    reports_.push_back(fmt::format("/robot_path_requests: ignored the path of task '{}' for robot '{}': {}",
                                   PlainLine(task, kMaxShown), member->robot.name, problem));
  };
  const bool has_long_text = task.size() > kMaxText ||
                             std::any_of(locations.begin(), locations.end(), [](const ros::LocationMessage& location) {
                               return dds::Text(location.level_name).size() > kMaxText;
                             });
  if (has_long_text) return refuse("it has a text of more than 1000 bytes");
  if (locations.empty()) return refuse("it has no points");
  if (!std::all_of(locations.begin(), locations.end(), IsValid)) return refuse("it has a number that is not finite");
  std::vector<ros::RmfLocation> path;
  std::vector<PathPoint> points;
  for (const ros::LocationMessage& location : locations) {
    path.push_back(ros::FromMessage(location));
    points.push_back(PointOf(path.back()));
  }
  member->has_task = true;
  member->robot.task = task;
  member->is_docking = false;
  const Vec2 at = state.robots[member->id.index()].X_WR.translation();
  member->has_failed = !member->follower->Follow(std::move(points), at);
  if (!member->has_failed) {
    member->path = std::move(path);
    return;
  }
  reports_.push_back(fmt::format(
      "/robot_path_requests: robot '{}' stops: the path of task '{}' begins at ({:.2f}, {:.2f}), farther than 1 m away",
      member->robot.name, PlainLine(task, kMaxShown), path.front().x, path.front().y));
}

// A pause at a checkpoint lets the robot drive to that point of its path.
void SlotcarPort::ApplyPause(const ros::PauseRequest& request) {
  Member* const member = Find(request.robot_name);
  if (member == nullptr) return;
  member->pause_request = request.mode_request_id;
  member->is_paused = request.type == kPauseNow;
  if (request.type == kPauseAtCheckpoint) {
    member->follower->SetPause(PathFollower::Pause::kAtCheckpoint, request.at_checkpoint);
  } else {
    member->follower->SetPause(member->is_paused ? PathFollower::Pause::kNow : PathFollower::Pause::kNone);
  }
}

void SlotcarPort::ApplyMode(const char* name, std::uint32_t mode, std::uint64_t request) {
  Member* const member = Find(name);
  if (member == nullptr) return;
  member->mode_request = request;
  member->is_docking = mode == static_cast<std::uint32_t>(ros::RobotMode::kDocking);
  if (mode == static_cast<std::uint32_t>(ros::RobotMode::kPaused)) {
    member->is_paused = true;
    member->follower->SetPause(PathFollower::Pause::kNow);
  } else if (mode == static_cast<std::uint32_t>(ros::RobotMode::kMoving)) {
    member->is_paused = false;
    member->follower->SetPause(PathFollower::Pause::kNone);
  }
}

// Nothing: the robot has no path from Open-RMF, and its controller decides.
std::optional<Command> SlotcarPort::CommandFor(RobotId robot, const WorldState& state) {
  Receive(state);
  const auto member =
      std::find_if(members_.begin(), members_.end(), [robot](const Member& each) { return each.id == robot; });
  if (member == members_.end() || !member->follower || !member->has_task) return std::nullopt;
  const WorldDescription& world = scene_->world();
  const double time = static_cast<double>(state.tick) * world.interval_seconds();
  const Twist twist = member->follower->Update(state.robots[robot.index()].X_WR, time, world.interval_seconds(),
                                               IsBlocked(*member, state));
  return CommandFromTwist(twist, world.robot(robot).drive);
}

bool SlotcarPort::IsBlocked(const Member& member, const WorldState& state) const {
  const SlotcarParameters& p = member.parameters;
  if (p.stop_radius <= 0.0) return false;
  const Pose& X_WR = state.robots[member.id.index()].X_WR;
  // A ball in front of the robot: what stands beside or behind does not stop it, nor does a robot on another floor.
  const Vec2 ahead = Transform2(X_WR) * Vec2(p.stop_distance, 0.0);
  const auto is_near = [&](const Pose& other) {
    const double dz = other.z - X_WR.z;
    return (other.translation() - ahead).squaredNorm() + dz * dz < p.stop_radius * p.stop_radius;
  };
  for (std::size_t i = 0; i < state.robots.size(); ++i) {
    if (i != member.id.index() && RobotExists(scene_->world(), RobotId(i)) && is_near(state.robots[i].X_WR)) {
      return true;
    }
  }
  return std::any_of(state.people.begin(), state.people.end(),
                     [&](const PersonState& person) { return is_near(person.X_WP); });
}

// The order is that of importance for the fleet adapter: a failure first, then why the robot stands.
ros::RobotMode SlotcarPort::ModeOf(const Member& member, const WorldState& state) const {
  if (member.has_failed) return ros::RobotMode::kAdapterError;
  const Twist& twist = state.robots[member.id.index()].twist;
  const bool moves = std::hypot(twist.vx, twist.vy) >= kStands || std::fabs(twist.wz) >= kStands;
  const std::optional<std::size_t> store = scene_->store_of(scene_->world().robot(member.id).root);
  if (!moves && store && state.stores[*store].charge_watts > 0.0) return ros::RobotMode::kCharging;
  if (member.is_paused) return ros::RobotMode::kPaused;
  if (member.follower && member.follower->state() == PathFollower::State::kHolds) return ros::RobotMode::kPaused;
  if (member.follower && member.follower->state() == PathFollower::State::kWaits) return ros::RobotMode::kWaiting;
  if (member.is_docking) return ros::RobotMode::kDocking;
  return moves ? ros::RobotMode::kMoving : ros::RobotMode::kIdle;
}

ros::RmfRobot SlotcarPort::StateOf(Member& member, const WorldState& state) const {
  const WorldDescription& world = scene_->world();
  ros::RmfRobot robot = member.robot;
  robot.seq = ++member.robot.seq;
  robot.mode = ModeOf(member, state);
  // Ids of requests grow: the greater one is the newest.
  robot.mode_request = std::max(member.pause_request, member.mode_request);
  if (const std::optional<std::size_t> store = scene_->store_of(world.robot(member.id).root)) {
    const PowerDescription& power = world.model(scene_->stores()[*store].model).power;
    if (power.capacity > 0.0) {
      robot.battery = static_cast<float>(std::ceil(100.0 * state.stores[*store].joules / power.capacity));
    }
  }
  const Pose& X_WR = state.robots[member.id.index()].X_WR;
  robot.location.time = ros::ToTime(state.tick, world.interval_ns);
  robot.location.x = static_cast<float>(X_WR.x);
  robot.location.y = static_cast<float>(X_WR.y);
  robot.location.yaw = static_cast<float>(X_WR.heading);
  robot.location.level = ros::LevelAt(world, X_WR.z);
  if (member.follower && member.follower->has_path()) {
    const auto next = static_cast<std::ptrdiff_t>(std::min(member.follower->next(), member.path.size()));
    robot.path.assign(member.path.begin() + next, member.path.end());
  }
  return robot;
}

// All robots of the agent at once, each kRobotStatePeriod. `all`: also between the periods.
void SlotcarPort::Publish(std::span<const RobotView* const> robots, bool all) {
  if (robots.empty() || !(jazzy_ ? jazzy_->states.is_addressed() : kilted_->states.is_addressed())) return;
  const WorldState& state = robots.front()->world_state();
  if (!all && !ros::IsDue(state.tick, scene_->world().interval_ns, ros::kRobotStatePeriod)) return;
  for (Member& member : members_) {
    const ros::RmfRobot robot = StateOf(member, state);
    dds::WireArena arena;
    if (jazzy_) jazzy_->states.Write(ros::MakeRobotState<ros::RobotStateMessage>(robot, arena));
    if (kilted_) kilted_->states.Write(ros::MakeRobotState<ros::LaterRobotStateMessage>(robot, arena));
  }
}

void SlotcarPort::Restart() {
  if (paths_) {
    paths_->Drain([](const ros::PathRequest&) {});
    pauses_->Drain([](const ros::PauseRequest&) {});
    const auto drop = [](const auto&) {};
    if (jazzy_) jazzy_->modes->Drain(drop);
    if (kilted_) kilted_->modes->Drain(drop);
  }
  // As at the start of the run: a task from before would make its repetition be ignored.
  for (Member& member : members_) member = MakeMember(member.id);
}

std::vector<std::string> SlotcarPort::DrainReports() {
  if (reports_.size() > kMaxReports) reports_.resize(kMaxReports);
  return std::exchange(reports_, {});
}

}  // namespace troupe
