#include "worldfile/models/crowd.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "worldfile/models/people.h"
#include "worldfile/sites/site.h"
#include "worldfile/text/text_file.h"

namespace troupe {
namespace {

// Turns the crowd of a building (states, goal sets, transitions, groups) into goal sets and rules for people. A state
// becomes one goal set, whose successors are the targets of its transitions.
class CrowdMaker {
 public:
  explicit CrowdMaker(LoadedWorld& loaded)
      : site_(*loaded.site),
        crowd_(loaded.site->crowd),
        sets_(loaded.world.goal_sets),
        first_(static_cast<std::uint32_t>(sets_.size())),
        warnings_(loaded.warnings) {}

  std::vector<PeopleRule> Make() {
    for (const CrowdState& state : crowd_.states) sets_.push_back(GoalsOf(state));
    std::vector<PeopleRule> rules;
    for (const CrowdGroup& group : crowd_.groups) {
      if (group.robots.empty() && group.count > 0) rules.push_back(RuleOf(group));
    }
    return rules;
  }

 private:
  void Warn(const SourceLocation& where, const std::string& message) { warnings_.push_back({where, message}); }

  // Of a state among the crowd's; the reader has checked the names.
  std::uint32_t NumberOf(const std::string& name) const {
    const auto found = std::find_if(crowd_.states.begin(), crowd_.states.end(),
                                    [&](const CrowdState& state) { return state.name == name; });
    return static_cast<std::uint32_t>(found - crowd_.states.begin());
  }

  // A state without goals, or with an unknown set, makes people stay: the file loads with a warning.
  GoalSet GoalsOf(const CrowdState& state) {
    GoalSet goals;
    goals.name = state.name;
    const auto set = std::find_if(crowd_.goal_sets.begin(), crowd_.goal_sets.end(),
                                  [&](const CrowdGoalSet& each) { return each.id == state.goal_set; });
    if (set != crowd_.goal_sets.end()) {
      AddPoints(*set, goals);
      if (goals.points.empty()) {
        Warn(set->where,
             "found a goal set without vertices, expected one whose 'human_goal_set_name' is in its "
             "'set_area'; people in state " +
                 Quoted(state.name) + " stay where they are");
      }
    } else if (state.goal_set >= 0) {
      Warn(state.where, "found no goal set " + std::to_string(state.goal_set) + " of state " + Quoted(state.name) +
                            ", expected the 'set_id' of one; its people stay where they are");
    }
    for (const CrowdTransition& transition : crowd_.transitions) {
      if (transition.from != state.name) continue;
      if (transition.distance > 0.0) goals.reach = transition.distance;
      goals.wait = {transition.wait, transition.wait};
      for (const CrowdChoice& choice : transition.to) {
        if (choice.weight > 0.0) goals.next.push_back({first_ + NumberOf(choice.state), choice.weight});
      }
    }
    return goals;
  }

  // The vertices of a goal set, on all levels.
  void AddPoints(const CrowdGoalSet& set, GoalSet& goals) const {
    for (const SiteLevel& level : site_.levels) {
      for (const SiteVertex& vertex : level.vertices) {
        const std::string& area = vertex.human_goal_set;
        if (area.empty() || std::find(set.areas.begin(), set.areas.end(), area) == set.areas.end()) continue;
        goals.points.push_back(vertex.position);
        goals.heights.push_back(level.elevation);
      }
    }
  }

  PeopleRule RuleOf(const CrowdGroup& group) {
    PeopleRule rule;
    rule.where = group.where;
    // One more than the limit, so that the check of the limit reports the excess.
    rule.count = static_cast<std::uint32_t>(std::min<std::size_t>(group.count, kMaxPeople + 1));
    const std::uint32_t state = NumberOf(group.state);
    rule.person.goals = first_ + state;
    // All of a group start at one point: beside each other there.
    const double half = 1.0 + std::sqrt(static_cast<double>(rule.count));
    const Vec2& at = group.start;
    rule.region = {at + Vec2(-half, -half), at + Vec2(half, -half), at + Vec2(half, half), at + Vec2(-half, half)};
    rule.point = at;
    rule.z = HeightOf(state);
    const auto profile = std::find_if(crowd_.profiles.begin(), crowd_.profiles.end(),
                                      [&](const CrowdProfile& each) { return each.name == group.profile; });
    if (profile != crowd_.profiles.end()) {
      if (profile->radius > 0.0) rule.person.radius = profile->radius;
      if (profile->speed > 0.0) rule.speed = {profile->speed, profile->speed};
      rule.person.max_speed = profile->max_speed;
    }
    WarnIfOutside(group, rule.z);
    return rule;
  }

  // The height of the level of a state's goals; a person that first stands has that of the goals that follow.
  double HeightOf(std::uint32_t state) const {
    for (std::size_t steps = 0; steps <= crowd_.states.size(); ++steps) {
      const GoalSet& goals = sets_[first_ + state];
      if (!goals.heights.empty()) return goals.heights.front();
      if (goals.next.empty()) break;
      state = goals.next.front().goals - first_;
    }
    return site_.levels.empty() ? 0.0 : site_.levels.front().elevation;
  }

  void WarnIfOutside(const CrowdGroup& group, double z) {
    const auto level = std::find_if(site_.levels.begin(), site_.levels.end(),
                                    [&](const SiteLevel& each) { return each.elevation == z; });
    if (level == site_.levels.end() || level->floors.empty()) return;
    const bool is_inside = std::any_of(level->floors.begin(), level->floors.end(), [&](const SiteFloor& floor) {
      Polygon outline;
      for (const std::size_t vertex : floor.vertices) outline.push_back(level->vertices[vertex].position);
      const Result<Polygon> normalized = Normalized(std::move(outline));
      return normalized.ok() && Contains(normalized.value(), group.start);
    });
    if (is_inside) return;
    Warn(group.where, "found a group of people at (" + NumberText(group.start.x()) + ", " +
                          NumberText(group.start.y()) + "), outside of the floors of level " + Quoted(level->name) +
                          ", expected a point on one of them");
  }

  const Site& site_;
  const SiteCrowd& crowd_;
  std::vector<GoalSet>& sets_;
  const std::uint32_t first_;  // the number of the goal set of the first state
  std::vector<Warning>& warnings_;
};

}  // namespace

Result<LoadedWorld> AddCrowd(LoadedWorld loaded) {
  const std::shared_ptr<const Site> site = loaded.site;
  if (site == nullptr || !site->crowd.is_enabled || site->crowd.people() == 0) return loaded;
  const std::vector<PeopleRule> rules = CrowdMaker(loaded).Make();
  const std::uint64_t seed = loaded.world.seed;
  return AddPeople(std::move(loaded), rules, seed);
}

}  // namespace troupe
