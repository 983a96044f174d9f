#include "world-service/service/membership.h"

#include <algorithm>
#include <utility>

#include "common/base/identity.h"
#include "common/base/text.h"
#include "troupe/check.h"

namespace troupe {
namespace {

JoinDecision Refuse(std::string reason) {
  return {JoinDecision::Outcome::kRefused, nullptr, std::move(reason)};
}

}  // namespace

std::string Describe(const Member& member) {
  return member.host + ", pid " + std::to_string(member.pid);
}

Membership::Membership(const WorldDescription& world, double lease_seconds, Edition world_edition)
    : world_edition_(world_edition), lease_seconds_(lease_seconds) {
  ResetForWorld(world);
}

void Membership::ResetForWorld(const WorldDescription& world) {
  const std::size_t count = world.robots.size();
  world_ = &world;
  world_hash_ = Hash(world);
  robot_by_name_.clear();
  for (std::size_t i = 0; i < count; ++i) {
    if (RobotExists(world, RobotId(i))) robot_by_name_.emplace(world.robots[i].name, RobotId(i));
  }
  owners_.assign(count, std::nullopt);
  contests_.assign(count, {});
  waits_of_forgotten_.assign(count, {});
}

Membership::WorldChange Membership::ChangeWorld(const WorldDescription& world, Edition edition, bool fresh) {
  std::vector<std::string> names;  // of the robots before, by id
  for (const RobotDescription& robot : world_->robots) names.push_back(robot.name);
  const std::map<std::string, RobotId> before = robot_by_name_;
  const std::vector<Waits> waits_before = RobotWaits();
  ResetForWorld(world);
  world_edition_ = edition;
  // The present id of an earlier robot. After a fresh edit (a load, a reset, a rewind) ids are those of another world,
  // and only names are comparable; after any other edit a robot keeps its id, even if its name was given to another
  // one.
  const auto successor = [&](RobotId robot) -> std::optional<RobotId> {
    if (!fresh) return RobotExists(world, robot) ? std::optional(robot) : std::nullopt;
    const auto found = robot_by_name_.find(names[robot.index()]);
    return found == robot_by_name_.end() ? std::nullopt : std::optional(found->second);
  };

  WorldChange change;
  std::vector<bool> was_there(world.robots.size(), false);
  for (const auto& [name, robot] : before) {
    const std::optional<RobotId> after = successor(robot);
    if (!after) continue;
    was_there[after->index()] = true;
    // The waits of a robot are of the whole run: they survive edits and changes of agents.
    waits_of_forgotten_[after->index()] = waits_before[robot.index()];
  }
  for (const auto& [name, robot] : robot_by_name_) {
    if (!was_there[robot.index()]) change.newcomers.push_back(robot);
  }
  std::sort(change.newcomers.begin(), change.newcomers.end());

  present_members_ = present_robots_ = 0;
  for (auto entry = members_.begin(); entry != members_.end();) {
    Member& member = entry->second;
    std::vector<RobotId> robots;
    for (const RobotId robot : member.robots) {
      if (const std::optional<RobotId> after = successor(robot)) robots.push_back(*after);
    }
    // A lost member is dropped, because it has not seen the edit: its proposals would be of the world before.
    if (robots.empty() || !member.present) {
      if (member.present) change.gone.push_back(member.id);
      entry = members_.erase(entry);
      continue;
    }
    std::sort(robots.begin(), robots.end());
    for (const RobotId robot : robots) owners_[robot.index()] = member.id;
    member.robots = std::move(robots);
    member.times_last = 0;  // counted above
    member.waited_seconds = 0.0;
    ++present_members_;
    present_robots_ += member.robots.size();
    ++entry;
  }
  return change;
}

JoinDecision Membership::Join(const JoinMessage& join, const StatePlace& next, double now, bool behind) {
  if (join.protocol_version != kProtocolVersion) {
    return Refuse("the agent speaks protocol version " + std::to_string(join.protocol_version) +
                  ", the world service version " + std::to_string(kProtocolVersion));
  }
  // A join for the world before the newest edit: the agent will join again for this one.
  if (join.world_edition < world_edition_) return {JoinDecision::Outcome::kUndecided, nullptr, {}};
  if (join.world_hash != world_hash_) return Refuse("the agent has another world than the world service");
  // Before the names are checked: a repeated join is answered as the first one was.
  if (Member* member = Find(join.agent); member != nullptr && member->present) {
    if (behind) return {JoinDecision::Outcome::kBehind, nullptr, {}};
    return {JoinDecision::Outcome::kRepeated, member, {}};
  }

  std::vector<RobotId> robots;
  for (const std::string& name : join.robots) {
    const auto robot = robot_by_name_.find(name);
    if (robot == robot_by_name_.end()) return Refuse("the world has no robot \"" + name + "\"");
    robots.push_back(robot->second);
  }
  if (robots.empty()) return Refuse("the agent names no robots");
  std::sort(robots.begin(), robots.end());
  if (const auto twice = std::adjacent_find(robots.begin(), robots.end()); twice != robots.end()) {
    return Refuse("the agent names robot \"" + world_->robot(*twice).name + "\" twice");
  }
  // All of them are contested at once: an agent that has been away may find several others in its place.
  JoinDecision contested;
  bool is_decided = true;
  for (RobotId robot : robots) {
    const Member* const owner = MemberOf(robot);
    if (owner == nullptr || !owner->present) continue;
    if (!OwnerLives(robot, join.agent, next, now)) {
      is_decided = false;
      continue;
    }
    const std::string& name = world_->robot(robot).name;
    if (contested.taken.empty()) {
      contested.reason = "robot \"" + name + "\" has an agent already (" + Describe(*owner) + ")";
    }
    contested.taken.push_back(name);
  }
  if (!is_decided) return {JoinDecision::Outcome::kUndecided, nullptr, {}};
  if (!contested.taken.empty()) return contested;

  if (behind) return {JoinDecision::Outcome::kBehind, nullptr, {}};
  for (RobotId robot : robots) {
    if (const std::optional<AgentId> lost = owners_[robot.index()]) Forget(*lost);
  }
  Forget(join.agent);  // it was lost, and rejoins for other robots
  for (RobotId robot : robots) owners_[robot.index()] = join.agent;
  present_robots_ += robots.size();
  ++present_members_;
  Member& member = members_[join.agent];
  member.id = join.agent;
  member.host = PlainLine(join.host, kMaxHost);
  member.pid = join.pid;
  member.robots = std::move(robots);
  return {JoinDecision::Outcome::kAdmitted, &member, {}};
}

// The death of an agent is known only after its lease. Until then its replacement must not be refused; once the old
// agent has answered, or the lease would long have expired, it must.
bool Membership::OwnerLives(RobotId robot, AgentId contender, const StatePlace& next, double now) {
  const Member& owner = *MemberOf(robot);
  Contest& contest = contests_[robot.index()];
  // A third agent that joins begins a contest of its own, which gives the owner its time again.
  if (contest.contender != contender) contest = {contender, next, now};
  return owner.last_answered > contest.next || now - contest.since > 2.0 * lease_seconds_;
}

Member* Membership::Find(AgentId agent) {
  const auto member = members_.find(agent);
  return member == members_.end() ? nullptr : &member->second;
}

void Membership::Lose(Member& member) {
  TROUPE_CHECK(member.present);
  member.present = false;
  --present_members_;
  present_robots_ -= member.robots.size();
}

void Membership::Restore(Member& member) {
  TROUPE_CHECK(!member.present);
  member.present = true;
  ++present_members_;
  present_robots_ += member.robots.size();
}

std::vector<AgentId> Membership::PresentMembers() const {
  std::vector<AgentId> present;
  for (const auto& [id, member] : members_) {
    if (member.present) present.push_back(id);
  }
  return present;
}

std::vector<AgentId> Membership::LostMembers() const {
  std::vector<AgentId> lost;
  for (const auto& [id, member] : members_) {
    if (!member.present) lost.push_back(id);
  }
  return lost;
}

bool Membership::IsPresent(RobotId robot) const {
  const std::optional<AgentId>& owner = owners_[robot.index()];
  return owner && members_.at(*owner).present;
}

const Member* Membership::MemberOf(RobotId robot) const {
  const std::optional<AgentId>& owner = owners_[robot.index()];
  return owner ? &members_.at(*owner) : nullptr;
}

std::vector<RobotId> Membership::AbsentRobots() const {
  std::vector<RobotId> absent;
  for (const auto& [name, robot] : robot_by_name_) {
    if (!IsPresent(robot)) absent.push_back(robot);
  }
  std::sort(absent.begin(), absent.end());
  return absent;
}

void Membership::Forget(AgentId agent) {
  const auto member = members_.find(agent);
  if (member == members_.end()) return;
  AddWaits(member->second, waits_of_forgotten_);
  for (RobotId robot : member->second.robots) owners_[robot.index()].reset();
  members_.erase(member);
}

void Membership::AddWaits(const Member& member, std::vector<Waits>& waits) {
  for (RobotId robot : member.robots) {
    waits[robot.index()].times_last += member.times_last;
    waits[robot.index()].waited_seconds += member.waited_seconds;
  }
}

std::vector<Membership::Waits> Membership::RobotWaits() const {
  std::vector<Waits> waits = waits_of_forgotten_;
  for (const auto& [agent, member] : members_) AddWaits(member, waits);
  return waits;
}

}  // namespace troupe
