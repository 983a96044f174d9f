#include "world-service/core/people.h"

#include <algorithm>
#include <atomic>
#include <optional>
#include <vector>

#include "troupe/random.h"
#include "world-service/core/avoidance.h"
#include "world-service/core/lift_boarding.h"
#include "world-service/core/pedestrian_motion.h"
#include "world-service/core/people_view.h"
#include "world-service/core/preferred_velocity.h"
#include "world-service/core/visitors.h"

namespace troupe {
namespace {

// Separates these random numbers from other uses of the same seed.
constexpr std::uint64_t kSwayStream = 0x7377'6179;

constexpr double kSway = 0.02;            // of the speed, to all sides: two that are as mirrors of each other pass
constexpr double kTurnRate = 4.0;         // rad/s
constexpr double kIntent = 0.5;           // people look where they would like to go, too: others see it
constexpr double kStroll = 0.1;           // m/s: slower ones keep their heading
constexpr std::size_t kPeopleClaim = 16;  // people that a thread claims at a time

// The decision of one person: `person` is its state, and becomes its plan.
void Decide(const PeopleView& view, PersonId id, Avoidance& avoidance, PersonState& person) {
  const std::optional<std::size_t> visitor = FindVisitor(view.world(), id);
  if (visitor && !view.world().visitors[*visitor].track.empty()) {
    return FollowTrack(view.world(), view.world().visitors[*visitor], view.state().tick, person);
  }
  AloneWalk walk = WalkAlone(view, id, person);
  if (walk.leaves) return LeaveWorld(view.world(), id, person);
  Vec2& preferred = walk.velocity;
  std::optional<Vec2> look_at;
  if (!walk.is_bound) look_at = ReactToRobots(view, id, person, preferred);
  if (preferred.x() != 0.0 || preferred.y() != 0.0) {
    const Tick tick = view.state().tick;
    const double size = 2.0 * kSway * view.world().person(id).speed;
    // Exactly symmetric encounters, as of a file with people on a grid, would otherwise stand for ever. Random by seed,
    // person and tick: the same in every run.
    preferred += size * Vec2(RandomUniform({view.world().seed, kSwayStream, id.index(), tick, 0}) - 0.5,
                             RandomUniform({view.world().seed, kSwayStream, id.index(), tick, 1}) - 0.5);
  }
  const Vec2 velocity = avoidance.Velocity(id, preferred, !walk.is_bound);
  person.vx = velocity.x();
  person.vy = velocity.y();
  const Vec2 ahead = look_at ? Vec2(*look_at - view.disc(id.index()).center) : Vec2(velocity + kIntent * preferred);
  // Very slow and without a way: the direction is mostly avoidance, and would make the person spin.
  if (!look_at && ahead.squaredNorm() < kStroll * kStroll) return;
  const double most = kTurnRate * view.seconds();
  const double turn = WrapAngle(Atan2(ahead.y(), ahead.x()) - person.X_WP.heading);
  person.X_WP.heading = WrapAngle(person.X_WP.heading + std::clamp(turn, -most, most));
}

// The plan of one on whose head an object rests: it stands, lets its door go, and its lift if it is not in that.
void Stand(const PeopleView& view, PersonState& person) {
  person.door = 0;
  if (person.lift != 0 && CabinAround(view, person.X_WP) != person.lift - 1) person.EndRide();
}

// The plans of all people, by the threads of `pool`, which may be null.
std::vector<PersonState> DecideAll(const PeopleView& view, ThreadPool* pool) {
  const std::size_t count = view.count();
  std::vector<PersonState> plans(count);
  std::atomic<std::size_t> next = 0;  // the first person that no thread has claimed
  // Each thread claims the next few people. Which thread decides for whom does not matter: a plan depends on the view
  // alone, and each is written once.
  const auto decide = [&](std::size_t) {
    Avoidance avoidance(view);
    for (std::size_t first = next.fetch_add(kPeopleClaim); first < count; first = next.fetch_add(kPeopleClaim)) {
      for (std::size_t i = first; i < std::min(first + kPeopleClaim, count); ++i) {
        plans[i] = view.person(i);
        plans[i].vx = plans[i].vy = 0.0;
        if (!view.Exists(i)) continue;
        if (view.IsBurdened(i)) {
          Stand(view, plans[i]);
        } else {
          Decide(view, PersonId(i), avoidance, plans[i]);
        }
      }
    }
  };
  if (pool != nullptr) {
    pool->Run(pool->size(), decide);
  } else {
    decide(0);
  }
  return plans;
}

}  // namespace

void MovePeople(StepWorkspace& workspace, ThreadPool* pool) {
  const std::size_t count = workspace.next.people.size();
  if (count == 0) return;
  AdmitVisitors(workspace);
  const PeopleView view(workspace);
  const std::vector<PersonState> plans = DecideAll(view, pool);
  PeopleMover mover(workspace);
  for (std::size_t k = 0; k < count; ++k) {
    // No person is always first at a door or in a gap.
    const std::size_t i = (workspace.next.tick + k) % count;
    if (view.Exists(i)) mover.Move(PersonId(i), plans[i]);
  }
}

}  // namespace troupe
