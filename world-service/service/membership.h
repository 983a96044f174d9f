// Membership: the agents of a run and their robots.
//
// A member that is lost keeps its robots until another agent joins for one of them, so that it can rejoin by itself.
//
// Invariants: a robot belongs to at most one member; a member has at least one robot; an agent belongs to the run by
// its random id, not by host or process, so a restarted program is another agent. A join is answered without a clock's
// decision wherever possible: what decides is whether the old agent answered a frame that was published after the new
// agent's first join. Only if the old agent stays silent, time (two leases) decides.
//
// Join has no effect but the admission itself, and may be called again with the same message: joins are resent until
// they are answered, and any answer may be lost.
//
// Costs: a join is linear in its robots, an edit in all robots and members; a tick with all agents needs Find alone.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "transport/protocol/messages.h"

namespace troupe {

// Bytes of the name of a peer's host that are shown: as many as a name in DNS has.
inline constexpr std::size_t kMaxHost = 255;

// An agent that was admitted. Times are wall times in s, of the coordinator's clock.
struct Member {
  AgentId id = 0;
  std::string host;
  std::uint32_t pid = 0;
  std::vector<RobotId> robots;         // in id order, never empty
  bool present = true;                 // false: lost
  bool gone = false;                   // the transport has reported its end, or that its lease has expired
  double asked_at = 0.0;               // when it was asked to join again
  StatePlace last_answered;            // the newest state that it sent a proposal for
  std::optional<double> silent_since;  // of the first frame that it left unanswered, when that is not the current one
  std::uint64_t times_last = 0;        // ticks in which it was the last to answer
  double waited_seconds = 0.0;         // that the barrier waited for it alone
  double answer_seconds = 0.0;         // from a frame to its answer, smoothed; 0: it has not answered yet
};

// "host, pid 123"
std::string Describe(const Member& member);

// The outcome of a join.
struct JoinDecision {
  enum class Outcome : std::uint8_t {
    kAdmitted,   // `member` has its robots now
    kRepeated,   // `member` was admitted before; the answer was lost
    kRefused,    // for `reason`
    kUndecided,  // the robot's agent may be dead or not; the joining agent will resend its join
    kBehind,     // it would be admitted, or is, but its robots have to remember more of the run first
  };
  Outcome outcome = Outcome::kRefused;
  Member* member = nullptr;  // kAdmitted, kRepeated
  std::string reason;
  std::vector<std::string> taken = {};  // kRefused: the robots that have another agent, if this is the reason
};

class Membership {
 public:
  // REQUIRES: the world outlives the membership, or the next ChangeWorld.
  Membership(const WorldDescription& world, double lease_seconds, Edition world_edition = 0);

  struct WorldChange {
    std::vector<AgentId> gone;       // members without robots now
    std::vector<RobotId> newcomers;  // new robots, which have no agent
  };
  // An edit has changed the world. Members keep their robots: by name if the edit is `fresh`, else by id. Lost
  // members are unknown from then on.
  WorldChange ChangeWorld(const WorldDescription& world, Edition edition, bool fresh);

  // `next` is the state that proposals are collected for. `behind`: the outcome is kBehind where it were kAdmitted
  // or kRepeated; nothing has changed then.
  JoinDecision Join(const JoinMessage& join, const StatePlace& next, double now, bool behind = false);

  // Null for an unknown agent. A pointer is valid until another agent joins for the member's robots.
  Member* Find(AgentId agent);
  // REQUIRES: Find finds it.
  const Member& member(AgentId agent) const { return members_.at(agent); }
  // REQUIRES: the member is present (Lose) or lost (Restore).
  void Lose(Member& member);
  void Restore(Member& member);

  std::size_t present_members() const { return present_members_; }
  std::vector<AgentId> PresentMembers() const;
  std::vector<AgentId> LostMembers() const;
  bool all_robots_present() const { return present_robots_ == robot_by_name_.size(); }
  bool IsPresent(RobotId robot) const;
  // The member of the robot, also a lost one; null: none has joined for it.
  const Member* MemberOf(RobotId robot) const;
  // But for removed ones.
  std::size_t robots() const { return robot_by_name_.size(); }
  std::vector<RobotId> AbsentRobots() const;

  struct Waits {
    std::uint64_t times_last = 0;
    double waited_seconds = 0.0;
  };
  // The waits of the barrier for each robot, by robot id, all its agents together.
  std::vector<Waits> RobotWaits() const;

 private:
  // An agent that joins for a robot of another agent.
  struct Contest {
    AgentId contender = 0;
    StatePlace next;     // that proposals were collected for at its first join
    double since = 0.0;  // time of its first join
  };

  // A join for a robot that has a present agent: that agent lives. False: it may be dead.
  bool OwnerLives(RobotId robot, AgentId contender, const StatePlace& next, double now);
  void Forget(AgentId agent);
  void ResetForWorld(const WorldDescription& world);
  static void AddWaits(const Member& member, std::vector<Waits>& waits);

  const WorldDescription* world_ = nullptr;
  std::uint64_t world_hash_ = 0;
  Edition world_edition_ = 0;
  const double lease_seconds_;
  std::map<std::string, RobotId> robot_by_name_;  // except removed ones
  std::map<AgentId, Member> members_;
  std::vector<std::optional<AgentId>> owners_;  // by robot; also lost ones
  std::vector<Contest> contests_;               // by robot
  std::vector<Waits> waits_of_forgotten_;       // by robot
  std::size_t present_members_ = 0;
  std::size_t present_robots_ = 0;
};

}  // namespace troupe
