#include "launcher/commands/controller_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <thread>
#include <utility>

#include "world-service/core/validate_proposal.h"

namespace troupe {
namespace {

struct Number {
  std::string name;
  double value = 0.0;
};

// The numbers of a proposal.
std::vector<Number> NumbersOf(const WorldDescription& world, const Proposal& proposal) {
  std::vector<Number> numbers = {{"vx", proposal.twist.vx}, {"vy", proposal.twist.vy}, {"wz", proposal.twist.wz}};
  std::size_t joint = 0;
  for (const JointDescription& description : world.joints) {
    if (description.robot != proposal.robot || joint == proposal.joint_velocities.size()) continue;
    numbers.push_back({"velocity of joint " + description.name, proposal.joint_velocities[joint++]});
  }
  return numbers;
}

// Empty if both are equal.
std::string DifferenceOf(const WorldDescription& world, const Proposal& found, const Proposal& expected) {
  const std::vector<Number> mine = NumbersOf(world, found);
  const std::vector<Number> recorded = NumbersOf(world, expected);
  for (std::size_t i = 0; i < std::min(mine.size(), recorded.size()); ++i) {
    if (mine[i].value == recorded[i].value) continue;
    return fmt::format("the {} is {}, expected {}", mine[i].name, mine[i].value, recorded[i].value);
  }
  if (mine.size() == recorded.size()) return {};
  return fmt::format("the number of joint velocities is {}, expected {}", found.joint_velocities.size(),
                     expected.joint_velocities.size());
}

std::vector<std::string> RobotsOf(const WorldDescription& world) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < world.robots.size(); ++i) {
    if (IsThere(world, RobotId(i))) names.push_back(world.robots[i].name);
  }
  return names;
}

}  // namespace

Result<ControllerCheck> ControllerCheck::Create(const Recording& recording) {
  if (recording.run().settings.mode == Mode::kRealtime) {
    return Error{{recording.name()},
                 "found a recording of mode realtime, in which late robots repeat proposals; expected one of mode "
                 "lockstep to run the controllers again"};
  }
  return ControllerCheck(recording);
}

Status ControllerCheck::AddReplica(const ReplayedWorld& world, const std::vector<std::string>& robots) {
  if (robots.empty()) return {};
  RobotOptions options;
  options.libraries = AllowedPaths::All();  // as of the user's own scenario
  Result<std::unique_ptr<Replica>> replica = Replica::Create(world.world(), robots, options, pool_);
  if (!replica.ok()) return replica.error();
  replicas_.push_back(std::move(replica).value());
  return {};
}

Status ControllerCheck::Follow(const ReplayedWorld& world) {
  const bool fresh = world.fresh_edition() != fresh_edition_;
  const bool is_first = scene_ == nullptr;
  if (fresh) unknown_.clear();
  fresh_edition_ = world.fresh_edition();
  for (const auto& replica : replicas_) {
    Status changed;
    if (world.scene() != scene_) {
      changed = replica->ChangeWorld(world.world(), fresh, fresh_edition_);
    } else if (fresh) {
      changed = replica->Renew(fresh_edition_);
    }
    if (!changed.ok()) return changed;
    if (edition_ != followed_edition_) replica->Relocate(world.state());
  }
  followed_edition_ = edition_;
  if (world.scene() == scene_) return {};
  scene_ = world.scene();
  std::erase_if(replicas_, [](const auto& replica) { return !replica->has_robots(); });
  std::set<std::string> known;
  for (const auto& replica : replicas_) {
    for (const std::string& name : replica->RobotNames()) known.insert(name);
  }
  std::vector<std::string> others = RobotsOf(world.world());
  std::erase_if(others, [&](const std::string& name) { return known.contains(name); });
  if (!is_first) {
    for (const std::string& name : others) unknown_.erase(name);
  }
  return AddReplica(world, others);
}

void ControllerCheck::NoteLosses(const WorldDescription& world, const RecordedTick& next) {
  if (settings_.on_agent_loss == OnAgentLoss::kRebuild) return;  // its memory is restored
  for (const Event& event : next.events) {
    if (!event.robot || event.robot->index() >= world.robots.size()) continue;
    const std::string& name = world.robot(*event.robot).name;
    if (event.type == EventType::kJoined) absent_.erase(name);
    if (event.type != EventType::kLeft) continue;
    absent_.insert(name);
    unknown_.insert(name);
  }
}

Result<std::optional<std::string>> ControllerCheck::Check(const ReplayedWorld& world, const RecordedTick& next) {
  if (next.number == 0) return std::optional<std::string>();
  if (Status problem = Follow(world); !problem.ok()) return problem.error();
  NoteLosses(world.world(), next);
  if (next.is_step()) return Compare(world, next);
  for (const auto& replica : replicas_) replica->Pause(world.state());  // an edit follows
  edition_ = next.edition;
  return std::optional<std::string>();
}

std::optional<std::string> ControllerCheck::Compare(const ReplayedWorld& world, const RecordedTick& next) {
  std::vector<Proposal> decided;
  for (const auto& replica : replicas_) {
    for (Proposal& proposal : replica->Retrace(world.state(), next.commands)) decided.push_back(std::move(proposal));
  }
  std::sort(decided.begin(), decided.end(), [](const Proposal& a, const Proposal& b) { return a.robot < b.robot; });
  auto recorded = next.proposals.begin();
  for (const Proposal& proposal : decided) {
    while (recorded != next.proposals.end() && recorded->robot < proposal.robot) ++recorded;
    const bool is_recorded = recorded != next.proposals.end() && recorded->robot == proposal.robot;
    const std::string& name = world.world().robot(proposal.robot).name;
    if (unknown_.contains(name) || (absent_.contains(name) && !is_recorded)) {
      lost_.insert(name);
      continue;
    }
    // The service refused a proposal that is not valid.
    const bool is_valid = ValidateProposal(world.world(), world.state(), proposal).ok();
    std::string difference;
    if (is_valid != is_recorded) {
      difference =
          is_valid ? "the proposal is valid, expected none that is" : "the proposal is not valid, expected one";
    } else if (is_recorded) {
      difference = DifferenceOf(world.world(), proposal, *recorded);
    }
    ++compared_;
    if (difference.empty()) continue;
    return fmt::format("tick {}: robot {}: {}{}", next.tick, name, difference,
                       settings_.ros ? "; a command of ROS 2 may be the cause, which a recording does not have" : "");
  }
  return std::nullopt;
}

}  // namespace troupe
