// The inputs of a tick and its time: proposals of agents, commands of tools, pacing and resends.
// - ProposalCollector: which proposals enter the step. Everything that a peer sends is checked here, once, before the
//   core
//
// sees it; a rejected proposal counts as an answer, so that a wrong controller stops its robot and not the run.
// - RobotCommands: commands of tools to robots, each in force for a number of ticks, counted in simulated time, so that
//   a
//
// slow run obeys them as a fast one does.
// - Pacer, PaceWatch, ResendTimer: wall time. None of them enters a state or a hash.
//
// All are passive values without threads, owned by TickEngine. Proposals are kept by reference to their messages where
// the transport allows it (`shared`): for 10,000 robots in one message a copy costs as much as the barrier itself.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/spatial/scene.h"
#include "transport/protocol/messages.h"
#include "transport/protocol/run_progress.h"
#include "troupe/ids.h"
#include "troupe/robot_command.h"
#include "troupe/world_description.h"
#include "world-service/service/membership.h"
#include "worldfile/load_world.h"

namespace troupe {

// The inputs of the next tick: proposals of agents, and commands from outside of the simulation.

struct Rejection {
  std::optional<RobotId> robot;
  std::string reason;
};

// The proposals that enter the next step, all of them valid.
class ProposalCollector {
 public:
  // REQUIRES: the scene outlives the collector, or the next ChangeWorld.
  ProposalCollector(const Scene& scene, Mode mode);

  // An edit has changed the world or its state: all proposals are dropped.
  void ChangeWorld(const Scene& scene);

  // Collects the valid proposals of a member's first message for `message.tick`; returns the others. The result is
  // valid until the next call. REQUIRES: robots' states in `state` are those that the tick starts from.
  // `shared`: the message itself, which is then kept instead of copied; may be null.
  std::span<const Rejection> Collect(const Member& member, const ProposalMessage& message, const WorldState& state,
                                     const SharedProposal& shared = nullptr);

  // The proposals for the step from `state` to the next tick, in robot-id order; valid until the next call of this or
  // of Collect. In realtime mode, a robot without a proposal for that tick keeps the one for the tick before.
  std::span<const Proposal> ForStep(const WorldState& state);

 private:
  struct Newest {
    const Proposal* proposal = nullptr;  // valid while its message is kept, or it is one of copies_
    Tick tick = 0;                       // that it is for; 0: none yet
  };

  const Scene* scene_;
  const Mode mode_;
  std::vector<Newest> newest_;             // by robot
  std::vector<Proposal> copies_;           // by robot, of messages that are not kept; empty: all are
  Tick tick_ = 0;                          // that the next three are of
  std::vector<SharedProposal> kept_;       // in lockstep: no tick uses a proposal of the one before
  std::size_t messages_ = 0;               // collected
  const ProposalMessage* only_ = nullptr;  // the one that has all valid proposals, if it is kept
  // Members for their memory only.
  std::vector<Proposal> for_step_;
  std::vector<Rejection> rejections_;
};

// A part of a command that is in force. Beside the class, because clang 14 cannot compile it inside.
template <typename Value>
struct Timed {
  Value value;
  std::uint64_t ticks = 0;  // left
  bool sent = false;        // to the agents, for the next tick
};

// The commands to robots from outside of the simulation (tools, viewers), each in force for a number of ticks. A
// command replaces the one before of the same kind: motion, each gripper, goal. Messages of a fleet control queue up,
// each for one tick.
class RobotCommands {
 public:
  // Goals are numbered from the one after `last_goal` on: the robots of a run that is continued know other numbers.
  explicit RobotCommands(std::uint32_t last_goal = 0) : goals_(last_goal) {}

  // For the next `ticks` ticks. A goal without waypoints cancels the goal.
  // REQUIRES: CheckRobotCommand succeeded, but for that.
  void Add(const RobotCommand& command, std::uint64_t ticks);

  // Those for the next tick, in robot-id order, of robots that the world has.
  std::vector<RobotCommand> ForNextTick(const WorldDescription& world);
  // Those that ForNextTick returned last and that are still in force.
  std::vector<RobotCommand> Sent() const;
  // The tick for which ForNextTick was called last was stepped.
  void Elapse();

  void Clear() { robots_.clear(); }

  // All of them, and the same for a service that continues the run.
  std::vector<CommandInForce> InForce() const;
  void Restore(const std::vector<CommandInForce>& commands);

 private:
  struct OfRobot {
    std::optional<Timed<Twist>> twist;
    std::map<std::size_t, Timed<GripperOrder>> grippers;
    std::optional<Timed<Goal>> goal;
    std::vector<Timed<FleetMessage>> messages;  // in the order of their arrival
    bool empty() const { return !twist && grippers.empty() && !goal && messages.empty(); }
  };
  std::map<RobotId, OfRobot> robots_;
  std::uint32_t goals_;  // numbers them
};

// When a tick may be committed, and when its frame is resent. Times in s, of any clock.

// Pacer: keeps simulated time at a fixed multiple of wall time. Due times are multiples of the period from a start, not
// sums of waits: so rounding and short delays do not accumulate.
class Pacer {
 public:
  // `speed`: multiple of real time; nothing: no pacing. `interval`: length of a tick in simulated s.
  Pacer(std::optional<double> speed, double interval) : speed_(speed) { SetInterval(interval); }

  void SetInterval(double interval) { period_ = speed_ ? interval / *speed_ : 0.0; }
  // The next tick is due after its period at the new speed.
  void SetSpeed(std::optional<double> speed, double interval, Tick tick, double now) {
    speed_ = speed;
    SetInterval(interval);
    Resume(tick, now);
  }
  const std::optional<double>& speed() const { return speed_; }
  void Start(double now) { start_ = now; }
  // Time continues after a pause, which is not caught up.
  void Resume(Tick tick, double now) { start_ = now - static_cast<double>(tick) * period_; }

  double Due(Tick tick) const {
    if (period_ == 0.0) return -std::numeric_limits<double>::infinity();
    return start_ + static_cast<double>(tick) * period_;
  }

  // Call when a tick was committed. A short delay is caught up; a long one shifts the later ticks.
  void Committed(Tick tick, double now) {
    const double late = now - Due(tick);
    if (period_ > 0.0 && late > kCatchUp) start_ += late;
  }

 private:
  static constexpr double kCatchUp = 0.5;  // s

  std::optional<double> speed_;
  double period_ = 0.0;  // wall time of a tick
  double start_ = 0.0;
};

// In realtime mode, whether the agents keep the pace.
class PaceWatch {
 public:
  static constexpr double kPeriod = 2.0;      // s, over which proposals are counted
  static constexpr double kSilence = 30.0;    // s, from one report to the next
  static constexpr double kUsualLate = 0.25;  // share of the proposals

  // A tick was committed without the proposals of `missing` of its members. A report, if one is due: the percentage of
  // the proposals that were late in the period before.
  std::optional<int> Committed(std::size_t members, std::size_t missing, double now) {
    if (!since_) since_ = now;
    members_ += members;
    missing_ += missing;
    if (now - *since_ < kPeriod) return std::nullopt;
    const double share = members_ == 0 ? 0.0 : static_cast<double>(missing_) / static_cast<double>(members_);
    since_ = now;
    members_ = missing_ = 0;
    if (share < kUsualLate || now < silent_until_) return std::nullopt;
    silent_until_ = now + kSilence;
    return static_cast<int>(std::lround(100.0 * share));
  }

 private:
  std::optional<double> since_;
  std::size_t members_ = 0;
  std::size_t missing_ = 0;
  double silent_until_ = 0.0;
};

// When to resend a frame that an agent seems to have missed. It learns the delay of answers from those that arrived
// before a resend.
//
// Resends come in bursts with silence between them. Over a slow link each resend to all agents fills the queue before
// it, and drops what is under way; in the silence the queue drains, and the middleware repeats what was dropped.
class ResendTimer {
 public:
  static constexpr double kMinWait = 0.004;
  static constexpr double kMaxFirstWait = 0.05;  // also before anything was learned
  static constexpr double kMaxWait = 1.0;
  // An agent that does not answer within the deadline is lost. With half as many resends in that time, as the silences
  // leave, the loss of messages loses no agent: if each round trip fails with probability 0.7, a hundred fail with
  // 3e-16.
  static constexpr double kResendsInDeadline = 200.0;
  // Resends without an answer of any agent, until a silence that is as long as they were.
  static constexpr int kBurst = 20;
  // Answers of other agents postpone a resend up to this many times the longest wait.
  static constexpr double kMaxPostponed = 20.0;
  // Waits are up to this many times as long while resends prove needless. So is the first wait after a silence was
  // needed.
  static constexpr double kMaxStretch = 10.0;

  // `deadline`: of an agent for its answer; 0: none.
  explicit ResendTimer(double deadline = 0.0)
      : longest_wait_(deadline > 0.0 ? std::clamp(deadline / kResendsInDeadline, kMinWait, kMaxWait) : kMaxWait),
        silence_(std::min(kBurst * longest_wait_, kMaxWait)) {}

  // A frame was sent for the first time; the one before is answered. The first resend is due after the wait that was
  // learned, each later one after twice the wait before.
  void Start(double now) {
    if (heard_) Learn(longest_);
    stretch_ = 2 * twice_ > answers_ ? std::min(2.0 * stretch_, kMaxStretch) : std::max(0.9 * stretch_, 1.0);
    if (is_silent_ || is_calm_) mean_ = kMaxStretch * kMaxFirstWait;
    const double longest = mean_ > kMaxFirstWait ? kMaxStretch : stretch_;
    Start(now, std::clamp(mean_ + 4.0 * deviation_, kMinWait, longest * kMaxFirstWait));
  }
  // The same with a wait of the caller's choice; nothing is learned from it.
  void Start(double now, double first_wait) {
    heard_ = resent_ = is_silent_ = is_calm_ = false;
    answers_ = twice_ = 0;
    fruitless_ = 0;
    longest_ = 0.0;
    last_ = now;
    Wait(now, first_wait);
  }
  // An answer arrived. While answers arrive, the other agents are probably busy, and more frames would delay them.
  void Answered(double now) {
    ++answers_;
    fruitless_ = 0;
    is_calm_ = is_calm_ || is_silent_;
    if (!resent_) {
      heard_ = true;
      longest_ = std::max(longest_, now - last_);
      last_ = now;
    }
    due_ = std::min(now + wait_, latest_);
  }
  void Resent(double now) {
    resent_ = true;
    is_silent_ = is_calm_ || ++fruitless_ % kBurst == 0;
    Wait(now, is_silent_ ? silence_ : std::min(2.0 * wait_, stretch_ * longest_wait_));
  }
  // An answer arrived twice: a resend was needless, so answers need longer than was learned.
  void AnsweredTwice() {
    if (resent_) ++twice_;
    mean_ = std::max(mean_, std::min(1.25 * mean_ + 0.001, stretch_ * kMaxFirstWait));
  }
  double due() const { return due_; }

 private:
  void Wait(double now, double wait) {
    wait_ = wait;
    due_ = now + wait_;
    latest_ = now + kMaxPostponed * std::max(wait_, stretch_ * longest_wait_);
  }
  // Mean and mean deviation with the gains 1/8 and 1/4, as TCP estimates its round-trip time (V. Jacobson, Congestion
  // Avoidance and Control, 1988).
  void Learn(double longest) {
    const double surprise = longest - mean_;
    mean_ += surprise / 8.0;
    deviation_ += (std::abs(surprise) - deviation_) / 4.0;
  }

  double longest_wait_;
  double silence_;
  double mean_ = kMaxFirstWait;  // of the longest silence in a tick
  double deviation_ = 0.0;
  double stretch_ = 1.0;  // of the waits
  double wait_ = 0.0;
  double due_ = 0.0;
  double latest_ = 0.0;  // that due_ may be postponed to
  // Times of the tick that is open.
  double last_ = 0.0;     // time of the newest answer, or the start
  double longest_ = 0.0;  // silence
  std::size_t answers_ = 0;
  std::size_t twice_ = 0;   // answers to a resent frame that had been answered before
  int fruitless_ = 0;       // resends since the newest answer
  bool is_silent_ = false;  // after a burst
  bool is_calm_ = false;    // silence has brought answers: resends have it between them from now on
  bool heard_ = false;
  bool resent_ = false;
};

}  // namespace troupe
