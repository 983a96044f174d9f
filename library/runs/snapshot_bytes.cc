#include "troupe/snapshot_bytes.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "common/model/states.h"
#include "common/spatial/scene.h"
#include "library/simulation_content.h"
#include "recording/recorded_run.h"
#include "transport/wire/message_bytes.h"
#include "troupe/version.h"
#include "world-service/core/step.h"
#include "world-service/replay/replayed_world.h"

namespace troupe {
namespace {

// Parts, each behind its length: the version of the program, the run, the frame, and the motions.
constexpr std::size_t kParts = 4;

void AppendPart(std::vector<std::byte>& bytes, std::span<const std::byte> part) {
  const std::uint64_t size = part.size();
  const auto head = std::as_bytes(std::span(&size, 1));
  bytes.insert(bytes.end(), head.begin(), head.end());
  bytes.insert(bytes.end(), part.begin(), part.end());
}

std::optional<std::array<std::span<const std::byte>, kParts>> PartsOf(std::span<const std::byte> bytes) {
  std::array<std::span<const std::byte>, kParts> parts;
  for (std::span<const std::byte>& part : parts) {
    std::uint64_t size = 0;
    if (bytes.size() < sizeof(size)) return std::nullopt;
    std::memcpy(&size, bytes.data(), sizeof(size));
    bytes = bytes.subspan(sizeof(size));
    if (bytes.size() < size) return std::nullopt;
    part = bytes.first(static_cast<std::size_t>(size));
    bytes = bytes.subspan(static_cast<std::size_t>(size));
  }
  return bytes.empty() ? std::optional(parts) : std::nullopt;
}

// The motion by which a robot is driven.
using Motion = std::array<double, 6>;  // 1: it is driven; vx, vy, wz, speed, steering

Error NoSnapshot() {
  return BadInput("found bytes that are no snapshot");
}

}  // namespace

Status SnapshotBytes::CheckWritable(const Snapshot& snapshot) {
  const Snapshot::Content& content = *snapshot.content_;
  const WorldDescription& world = content.scene->world();
  if (!content.inputs.empty()) return BadInput("the snapshot has orders that wait for the next step");
  for (std::size_t i = 0; i < content.commands.size(); ++i) {
    const RobotId id(i);
    if (!RobotExists(world, id)) continue;
    const RobotDescription& robot = world.robot(id);
    const std::string name = "robot " + robot.name;
    if (robot.controller != ControllerDescription()) {
      return BadInput(name + " has the controller " + robot.controller.name +
                      ", whose memory is no part of the bytes: expected robots without (run_controllers false)");
    }
    if (!content.scene->joints_of(id).empty()) return BadInput(name + " has joints, expected robots without");
    const ExternalCommand& given = content.commands[i];
    if (!given.fleet.empty() || given.goal || !given.command.orders.empty() || !given.command.messages.empty() ||
        !given.command.say.empty()) {
      return BadInput(name + " has commands that wait for the next step");
    }
  }
  return {};
}

Result<std::vector<std::byte>> SnapshotBytes::Write(const Snapshot& snapshot) {
  if (Status problem = CheckWritable(snapshot); !problem.ok()) return problem.error();
  const Snapshot::Content& content = *snapshot.content_;
  RecordedRun run;
  run.program_version = VersionText();
  run.step_version = kStepVersion;
  run.file = content.origin->world.path;
  run.keyframe_interval = 1;
  run.world = content.scene->world();
  FrameMessage frame;
  frame.state = *content.state;
  frame.state_hash = StateHash(frame.state);
  frame.events = content.events;
  std::vector<Motion> motions;
  for (const ExternalCommand& given : content.commands) {
    motions.push_back({given.drives ? 1.0 : 0.0, given.command.twist.vx, given.command.twist.vy, given.command.twist.wz,
                       given.command.speed, given.command.steering});
  }
  std::vector<std::byte> bytes;
  AppendPart(bytes, std::as_bytes(std::span(run.program_version)));
  AppendPart(bytes, RunToBytes(run));
  AppendPart(bytes, wire::ToBytes(frame));
  AppendPart(bytes, std::as_bytes(std::span(motions)));
  return bytes;
}

Result<Snapshot> SnapshotBytes::Read(std::span<const std::byte> bytes) {
  const auto parts = PartsOf(bytes);
  if (!parts) return NoSnapshot();
  const auto& [version, run_bytes, frame_bytes, motion_bytes] = *parts;
  if (const std::string found(reinterpret_cast<const char*>(version.data()), version.size()); found != VersionText()) {
    return BadInput("found a snapshot of troupe " + found + ", expected one of " + VersionText());
  }
  Result<RecordedRun> run = RunFromBytes(run_bytes);
  if (!run.ok()) return run.error();
  if (run.value().step_version != kStepVersion) return BadInput("found a snapshot of another version of the step");
  Result<FrameMessage> frame = wire::FromBytes<FrameMessage>(frame_bytes);
  if (!frame.ok()) return frame.error();
  WorldDescription& world = run.value().world;
  if (Status problem = Validate(world); !problem.ok()) return problem.error();
  std::vector<Motion> motions(world.robots.size());
  if (motion_bytes.size() != motions.size() * sizeof(Motion)) return NoSnapshot();
  if (!motions.empty()) std::memcpy(motions.data(), motion_bytes.data(), motion_bytes.size());
  for (const Motion& motion : motions) {
    for (const double part : motion) {
      if (!std::isfinite(part)) return NoSnapshot();
    }
  }
  for (const RobotDescription& robot : world.robots) {
    if (robot.controller != ControllerDescription()) return NoSnapshot();
  }
  auto scene = std::make_shared<const Scene>(std::move(world));
  // Checks that a step may start from the state.
  RecordedTick tick;
  tick.keyframe = frame.value();
  if (Status problem = ReplayedWorld(scene).Restore(tick); !problem.ok()) return BadInput(problem.error().message);
  Result<Simulation> made = Simulation::AtState(
      scene, std::make_shared<const WorldState>(std::move(frame.value().state)), std::move(frame.value().events));
  if (!made.ok()) return made.error();
  Snapshot::Content& content = made.value().impl_->now;
  SimulationOrigin origin;
  origin.world.path = run.value().file;
  origin.runs_controllers = false;
  content.origin = std::make_shared<const SimulationOrigin>(std::move(origin));
  for (std::size_t i = 0; i < motions.size(); ++i) {
    const Motion& motion = motions[i];
    ExternalCommand& given = content.commands[i];
    given.drives = motion[0] != 0.0;
    given.command.twist = {motion[1], motion[2], motion[3]};
    given.command.speed = motion[4];
    given.command.steering = motion[5];
  }
  return made.value().Save();
}

}  // namespace troupe
