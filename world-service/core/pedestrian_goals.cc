#include "world-service/core/pedestrian_goals.h"

#include <algorithm>
#include <cstddef>
#include <vector>

#include "troupe/random.h"

namespace troupe {
namespace {

// Separates the choices of people from other uses of the same seed.
constexpr std::uint64_t kChoiceStream = 0x7065'6f70'6c65;

// Uniform in [0, 1). `number`: 0 for the next set, 1 for the point, 2 for the time of waiting.
double Draw(const WorldDescription& world, PersonId id, std::uint32_t choices, std::uint64_t number) {
  return RandomUniform({world.seed, kChoiceStream, id.index(), choices, number});
}

}  // namespace

std::uint32_t TicksOf(const WorldDescription& world, double seconds) {
  return static_cast<std::uint32_t>(std::min(seconds / world.interval_seconds() + 0.5, 1e9));
}

void ChooseFirstGoal(const WorldDescription& world, PersonId id, PersonState& person) {
  person.goals = world.person(id).goals;
  const std::size_t points = std::max<std::size_t>(world.goal_sets[person.goals].points.size(), 1);
  person.goal = static_cast<std::uint32_t>(Draw(world, id, person.goals_chosen, 1) * static_cast<double>(points));
  ++person.goals_chosen;
  person.dwell_ticks = 0;
}

void ChooseGoal(const WorldDescription& world, PersonId id, PersonState& person) {
  if (person.goals_chosen == 0) return ChooseFirstGoal(world, id, person);
  const std::vector<NextGoals>& next = world.goal_sets[person.goals].next;
  if (next.empty()) return;
  const std::uint32_t before = person.goals;
  double total = 0.0;
  for (const NextGoals& choice : next) total += choice.weight;
  double left = Draw(world, id, person.goals_chosen, 0) * total;
  // The last one also where rounding leaves `left` at 0 or above.
  person.goals = next.back().goals;
  for (const NextGoals& choice : next) {
    left -= choice.weight;
    if (left >= 0.0) continue;
    person.goals = choice.goals;
    break;
  }
  const std::size_t points = world.goal_sets[person.goals].points.size();
  const bool is_another = person.goals == before && points > 1;
  // Not the same point again.
  const std::size_t choices = std::max<std::size_t>(points, 1) - (is_another ? 1 : 0);
  auto goal = static_cast<std::uint32_t>(Draw(world, id, person.goals_chosen, 1) * static_cast<double>(choices));
  // The draw is among the other points: the points from the present one on move up by one.
  if (is_another && goal >= person.goal) ++goal;
  person.goal = goal;
  ++person.goals_chosen;
  person.dwell_ticks = 0;
}

bool IsExit(const WorldDescription& world, std::uint32_t goals) {
  return std::binary_search(world.exits.begin(), world.exits.end(), goals);
}

void ArriveAtGoal(const WorldDescription& world, PersonId id, PersonState& person) {
  const GoalSet& set = world.goal_sets[person.goals];
  // The last goal: the person stays.
  if (set.next.empty()) return;
  person.dwell_ticks =
      TicksOf(world, set.wait.min + Draw(world, id, person.goals_chosen, 2) * (set.wait.max - set.wait.min));
  if (person.dwell_ticks == 0) ChooseGoal(world, id, person);
}

}  // namespace troupe
