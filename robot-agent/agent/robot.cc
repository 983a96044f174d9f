#include "robot-agent/agent/robot.h"

#include <fmt/format.h>

#include <exception>

#include "common/base/random.h"
#include "common/spatial/body_index.h"
#include "common/spatial/scene.h"
#include "common/trace/tick_trace.h"
#include "robot-agent/agent/scan_log.h"
#include "robot-agent/controller/create_controller.h"
#include "robot-agent/drive/drive.h"
#include "robot-agent/sensors/break_beam.h"
#include "robot-agent/sensors/ranger.h"

namespace troupe {
namespace {

// Keeps a controller's random numbers apart from the sensors', which have the same seed and robot in their keys.
constexpr std::uint64_t kControllerStream = 0x636f6e74726f6c;

double TimeOf(const WorldDescription& world, Tick tick) {
  return static_cast<double>(tick) * static_cast<double>(world.interval_ns) / 1e9;
}

}  // namespace

Robot::Robot(const Scene& scene, RobotId id, ScanLog* scan_log)
    : scene_(&scene),
      id_(id),
      scan_log_(scan_log),
      odometry_(scene.world().robot(id).localization),
      manipulator_(scene.world(), id) {
  subscribed_.resize(description().rangers.size(), false);
  readings_.resize(description().rangers.size());
  for (const GripperInfo& gripper : manipulator_.grippers()) reads_beams_.push_back(gripper.description->autosnatch);
  beams_.resize(reads_beams_.size());
}

Result<std::unique_ptr<Robot>> Robot::Create(const Scene& scene, RobotId id, ScanLog* scan_log) {
  std::unique_ptr<Robot> robot(new Robot(scene, id, scan_log));
  if (const std::string problem = robot->StartController(); !problem.empty()) {
    return Error{{}, fmt::format("robot {}: {}", robot->description().name, problem)};
  }
  return robot;
}

void Robot::ChangeWorld(const Scene& scene) {
  scene_ = &scene;
  manipulator_.ChangeWorld(scene.world());
}

const RobotDescription& Robot::description() const {
  return scene_->world().robot(id_);
}

std::string Robot::StartController() {
  RobotInfo info{.robot = &description(),
                 .parameters = description().controller.parameters,
                 .X_RM = {},
                 .joints = manipulator_.joints(),
                 .grippers = manipulator_.grippers()};
  for (const RangerDescription& ranger : description().rangers) info.X_RM.push_back(scene_->X_RM(ranger.model));
  Result<std::unique_ptr<Controller>> controller = CreateController(info);
  if (!controller.ok()) return controller.error().message;
  controller_ = std::move(controller).value();
  const std::string& name = description().controller.name;
  try {
    for (std::size_t ranger : controller_->Subscriptions()) {
      if (ranger >= subscribed_.size()) {
        return fmt::format("controller {} subscribes to ranger {}, but the robot has {}", name, ranger,
                           subscribed_.size());
      }
      subscribed_[ranger] = true;
    }
    for (std::size_t gripper : controller_->BeamSubscriptions()) {
      if (gripper >= reads_beams_.size()) {
        return fmt::format("controller {} subscribes to the beams of gripper {}, but the robot has {}", name, gripper,
                           reads_beams_.size());
      }
      reads_beams_[gripper] = true;
    }
  } catch (const std::exception& exception) {
    return fmt::format("controller {}: {}", name, exception.what());
  } catch (...) {
    return fmt::format("controller {} threw something that is not a std::exception", name);
  }
  return "";
}

Proposal Robot::Decide(const WorldState& state, const BodyIndex& bodies, const OutsideCommand& outside,
                       TraceLane* trace) {
  const RobotState& own = state.robots[id_.index()];
  odometry_.Update(own.X_WR);
  Enter(trace, TickPhase::kSense, state.tick + 1, id_);
  Sense(state.tick, bodies);
  Enter(trace, TickPhase::kDecide, state.tick + 1, id_);
  manipulator_.Sense(state, beams_);
  // Asked even when it is overruled: it is called at every tick, and goes on from there when it decides again.
  Command command = failure_.empty() ? AskController(state) : Command{};
  if (outside.drives) command = outside.command;
  manipulator_.Take(outside.command);
  const Twist twist = DriveTowards(description().drive, own.twist, command, scene_->world().interval_seconds());
  // After a failure the joints stay where they are, and hold what they hold.
  return {id_, twist, failure_.empty() ? manipulator_.Propose(state) : std::vector<double>{}};
}

const RangerReading& Robot::Measure(std::size_t ranger, Tick tick, const BodyIndex& bodies) {
  if (subscribed_[ranger] && readings_[ranger].tick == tick && !readings_[ranger].scans.empty()) {
    return readings_[ranger];
  }
  MeasureRanger(*scene_, bodies, id_, ranger, tick, unread_);
  return unread_;
}

void Robot::Sense(Tick tick, const BodyIndex& bodies) {
  const std::vector<RangerDescription>& rangers = description().rangers;
  for (std::size_t i = 0; i < rangers.size(); ++i) {
    if (tick % rangers[i].period_ticks != 0 || (!subscribed_[i] && scan_log_ == nullptr)) continue;
    // A controller sees what it subscribed to and no more, so that it decides the same with and without a scan log.
    RangerReading& reading = subscribed_[i] ? readings_[i] : unread_;
    MeasureRanger(*scene_, bodies, id_, i, tick, reading);
    if (scan_log_ != nullptr) scan_log_->Write(tick, description(), rangers[i], reading);
  }
  const std::span<const GripperId> grippers = scene_->grippers_of(id_);
  for (std::size_t i = 0; i < grippers.size(); ++i) {
    if (reads_beams_[i]) MeasureBeams(*scene_, bodies, grippers[i], beams_[i]);
  }
}

Command Robot::AskController(const WorldState& state) {
  const WorldDescription& world = scene_->world();
  const RobotState& own = state.robots[id_.index()];
  Observation observation;
  observation.tick = state.tick;
  observation.time = TimeOf(world, state.tick);
  observation.interval = world.interval_seconds();
  observation.pose_estimate = odometry_.estimate();
  observation.twist = own.twist;
  observation.stalled = own.stalled;
  observation.rangers = readings_;
  observation.joints = manipulator_.joint_readings();
  observation.grippers = manipulator_.gripper_readings();
  observation.random_key = RandomBits({kControllerStream, world.seed, id_.index(), state.tick});
  try {
    Command command = controller_->Update(observation);
    failure_ = manipulator_.Take(command);
    if (failure_.empty()) return command;
  } catch (const std::exception& exception) {
    failure_ = exception.what();
  } catch (...) {
    failure_ = "threw something that is not a std::exception";
  }
  failure_ = fmt::format("robot {}: controller {} failed at tick {}: {}", description().name,
                         description().controller.name, state.tick, failure_);
  return {};
}

}  // namespace troupe
