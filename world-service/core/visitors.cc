#include "world-service/core/visitors.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <utility>

#include "common/model/zones.h"
#include "troupe/deterministic_math.h"
#include "troupe/random.h"
#include "world-service/core/pedestrian_goals.h"
#include "world-service/core/person_room.h"

namespace troupe {
namespace {

constexpr std::uint64_t kVisitors = 0x7669'7369'7473;  // the stream of random numbers
constexpr double kStandstill = 0.05;                   // m/s: a recorded person that is slower keeps its heading

// Of a time table at a time.
double RateAt(const VisitorFlow& flow, double seconds) {
  const auto next = std::upper_bound(flow.times.begin(), flow.times.end(), seconds);
  return flow.per_hour[static_cast<std::size_t>(next - flow.times.begin()) - 1];
}

// The groups that have come by a time, of a flow whose groups come evenly.
double ComeBy(const VisitorFlow& flow, double seconds) {
  double groups = 0.0;
  for (std::size_t i = 0; i < flow.times.size() && flow.times[i] < seconds; ++i) {
    const double end = i + 1 < flow.times.size() ? std::min(flow.times[i + 1], seconds) : seconds;
    groups += (end - flow.times[i]) * flow.per_hour[i] / 3600.0;
  }
  return groups;
}

class Admission {
 public:
  explicit Admission(StepWorkspace& workspace)
      : workspace_(workspace), world_(workspace.world()), state_(workspace.next), room_(workspace) {}

  void Act() {
    for (std::size_t i = 0; i < world_.visitor_flows.size(); ++i) {
      if (Comes(i)) Draw(i);
    }
    for (std::size_t i = 0; i < world_.visitors.size(); ++i) Enter(i);
  }

 private:
  double TimeOf(Tick tick) const { return static_cast<double>(tick) * workspace_.seconds(); }
  double time() const { return TimeOf(state_.tick); }

  // A group of the flow comes in this tick: at most one.
  bool Comes(std::size_t number) const {
    const VisitorFlow& flow = world_.visitor_flows[number];
    const double before = TimeOf(state_.tick - 1);
    if (!flow.is_random) return std::floor(ComeBy(flow, time())) > std::floor(ComeBy(flow, before));
    const double share = RateAt(flow, before) * workspace_.seconds() / 3600.0;  // of a group in a tick
    return RandomUniform({world_.seed, kVisitors, number, state_.tick}) < share;
  }

  bool IsFree(std::size_t visitor) const {
    const PersonId person = world_.visitors[visitor].person;
    return IsAway(state_.people[person.index()]) && !state_.visitors[visitor].is_due &&
           !world_.model(world_.person(person).root).removed;
  }

  // The visitors of a group stand one after another, the leader first.
  std::size_t EndOfGroup(std::size_t leader) const {
    std::size_t end = leader + 1;
    while (end < world_.visitors.size() &&
           world_.person(world_.visitors[end].person).leader == world_.visitors[leader].person) {
      ++end;
    }
    return end;
  }

  // The next group of the flow whose members are all away is due.
  void Draw(std::size_t number) {
    VisitorFlowState& counts = state_.visitor_flows[number];
    std::size_t members = 1;
    for (std::size_t i = 0; i < world_.visitors.size(); ++i) {
      if (world_.visitors[i].flow != number || world_.person(world_.visitors[i].person).leader) continue;
      const std::size_t end = EndOfGroup(i);
      members = end - i;
      bool all_free = true;
      for (std::size_t k = i; k < end; ++k) all_free = all_free && IsFree(k);
      if (!all_free) continue;
      for (std::size_t k = i; k < end; ++k) state_.visitors[k].is_due = true;
      counts.came += static_cast<std::uint32_t>(members);
      return;
    }
    counts.refused += static_cast<std::uint32_t>(members);
  }

  // One without a flow comes once, at its time; a recorded one not after its last position.
  bool IsDue(std::size_t number) const {
    const VisitorDescription& visitor = world_.visitors[number];
    const VisitorState& state = state_.visitors[number];
    if (visitor.flow) return state.is_due;
    if (state.visits > 0 || time() < visitor.enters_at) return false;
    return visitor.track.empty() || time() <= visitor.track_times.back();
  }

  void Enter(std::size_t number) {
    const VisitorDescription& visitor = world_.visitors[number];
    PersonState& person = state_.people[visitor.person.index()];
    const PersonDescription& description = world_.person(visitor.person);
    if (!IsAway(person) || world_.model(description.root).removed || !IsDue(number)) return;
    Pose X_WP = world_.model(description.root).X_PM;
    if (!visitor.track.empty()) {
      const Vec2 at = TrackAt(visitor, time());
      X_WP.x = at.x();
      X_WP.y = at.y();
    }
    if (IsEvacuated(X_WP)) return;
    const Pose away = std::exchange(person.X_WP, X_WP);
    if (room_.On(visitor.person, X_WP.translation(), X_WP.translation()) != PersonRoom::Found::kFree) {
      person.X_WP = away;
      return;
    }
    ChooseFirstGoal(world_, visitor.person, person);
    state_.visitors[number].is_due = false;
    ++state_.visitors[number].visits;
    workspace_.bodies.Move(workspace_.scene.body_of(visitor.person), X_WP);
  }

  bool IsEvacuated(const Pose& X_WP) const {
    for (std::size_t i = 0; i < world_.zones.size(); ++i) {
      const ZoneDescription& zone = world_.zones[i];
      if (zone.exits && state_.zones[i].is_on && IsInZone(world_, zone, X_WP.translation(), X_WP.z)) return true;
    }
    return false;
  }

  StepWorkspace& workspace_;
  const WorldDescription& world_;
  WorldState& state_;
  PersonRoom room_;
};

}  // namespace

void AdmitVisitors(StepWorkspace& workspace) {
  if (!workspace.world().visitors.empty()) Admission(workspace).Act();
}

void FollowTrack(const WorldDescription& world, const VisitorDescription& visitor, Tick tick, PersonState& plan) {
  const double time = static_cast<double>(tick) * world.interval_seconds();
  if (time > visitor.track_times.back()) return LeaveWorld(world, visitor.person, plan);
  Vec2 velocity = (TrackAt(visitor, time) - plan.X_WP.translation()) / world.interval_seconds();
  const double speed = velocity.norm();
  const double most = world.person(visitor.person).max_speed;
  if (speed > most) velocity *= most / speed;
  plan.vx = velocity.x();
  plan.vy = velocity.y();
  if (speed > kStandstill) plan.X_WP.heading = Atan2(velocity.y(), velocity.x());
}

void LeaveWorld(const WorldDescription& world, PersonId id, PersonState& person) {
  const PersonDescription& description = world.person(id);
  person = {
      .X_WP = world.model(description.root).X_PM, .goals = description.goals, .goals_chosen = person.goals_chosen};
  person.X_WP.z = kAwayZ;
}

}  // namespace troupe
