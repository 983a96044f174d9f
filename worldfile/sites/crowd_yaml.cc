#include "worldfile/sites/crowd_yaml.h"

#include <set>
#include <utility>

#include "troupe/person_description.h"

namespace troupe {
namespace {

constexpr double kMinRadius = 0.05;       // m, of a person
constexpr std::size_t kMaxItems = 5'000;  // of each list

// Reads `crowd_sim` of a building. Names are checked here, so that each name in a SiteCrowd is known.
class CrowdReader {
 public:
  explicit CrowdReader(YamlReader& yaml) : yaml_(yaml) {}

  SiteCrowd Read(const YamlNode& node) {
    SiteCrowd crowd;
    if (node.is_missing_or_null()) return crowd;
    crowd.is_enabled = yaml_.Flag(yaml_.Find(node, "enable"), "'enable'", false);
    crowd.interval = yaml_.Number(yaml_.Find(node, "update_time_step"), "'update_time_step'", 0.1, 1e-6, 1e3);
    const auto each = [&](const char* key, auto visit) {
      const YamlNode& list = yaml_.Find(node, key);
      if (list.size() > kMaxItems) {
        yaml_.Fail(list, "found " + std::to_string(list.size()) + " items in " + Quoted(key) + ", expected at most " +
                             std::to_string(kMaxItems));
      }
      yaml_.ForEachItem(list, Quoted(key), visit);
    };
    each("agent_profiles", [&](const YamlNode& item) { crowd.profiles.push_back(ReadProfile(item)); });
    each("states", [&](const YamlNode& item) {
      crowd.states.push_back({Text(item, "name"), static_cast<std::int64_t>(Number(item, "goal_set", -1.0)),
                              yaml_.Flag(yaml_.Find(item, "final"), "'final'", false), yaml_.At(item)});
    });
    for (const CrowdProfile& profile : crowd.profiles) profiles_.insert(profile.name);
    for (const CrowdState& state : crowd.states) states_.insert(state.name);
    each("goal_sets", [&](const YamlNode& item) { crowd.goal_sets.push_back(ReadGoalSet(item)); });
    each("agent_groups", [&](const YamlNode& item) { crowd.groups.push_back(ReadGroup(item)); });
    each("transitions", [&](const YamlNode& item) { crowd.transitions.push_back(ReadTransition(item)); });
    return crowd;
  }

 private:
  double Number(const YamlNode& map, const char* key, double otherwise) {
    return yaml_.Number(yaml_.Find(map, key), Quoted(key), otherwise);
  }
  // 0: not given; the maker of people has the usual value.
  double Positive(const YamlNode& map, const char* key, double most = kMaxMagnitude) {
    return yaml_.Number(yaml_.Find(map, key), Quoted(key), 0.0, 0.0, most);
  }
  std::string Text(const YamlNode& map, const char* key) { return yaml_.Text(yaml_.Find(map, key), Quoted(key)); }

  CrowdProfile ReadProfile(const YamlNode& item) {
    CrowdProfile profile;
    profile.name = Text(item, "name");
    profile.radius = Positive(item, "r", kMaxPersonRadius);
    if (profile.radius > 0.0 && profile.radius < kMinRadius) {
      yaml_.Fail(yaml_.Find(item, "r"), "found " + NumberText(profile.radius) +
                                            " for 'r', expected 0, for the usual radius, or " + NumberText(kMinRadius) +
                                            " to " + NumberText(kMaxPersonRadius));
    }
    profile.speed = Positive(item, "pref_speed", kMaxPersonSpeed);
    profile.max_speed = Positive(item, "max_speed", kMaxPersonSpeed);
    profile.neighbor_dist = Positive(item, "neighbor_dist");
    profile.max_neighbors = static_cast<std::size_t>(Positive(item, "max_neighbors"));
    profile.horizon = Positive(item, "ORCA_tau");
    profile.horizon_obstacles = Positive(item, "ORCA_tauObst");
    return profile;
  }

  // `set_area` has the names that vertices give as `human_goal_set_name`.
  CrowdGoalSet ReadGoalSet(const YamlNode& item) {
    CrowdGoalSet set;
    set.where = yaml_.At(item);
    set.id = static_cast<std::int64_t>(Number(item, "set_id", 0.0));
    set.capacity = static_cast<std::size_t>(Positive(item, "capacity"));
    yaml_.ForEachItem(yaml_.Find(item, "set_area"), "'set_area'",
                      [&](const YamlNode& area) { set.areas.push_back(yaml_.Text(area, "a name in 'set_area'")); });
    return set;
  }

  CrowdGroup ReadGroup(const YamlNode& item) {
    CrowdGroup group;
    group.where = yaml_.At(item);
    group.count =
        static_cast<std::size_t>(yaml_.Number(yaml_.Find(item, "agents_number"), "'agents_number'", 0.0, 0.0));
    yaml_.ForEachItem(yaml_.Find(item, "agents_name"), "'agents_name'", [&](const YamlNode& name) {
      group.robots.push_back(yaml_.Text(name, "a name in 'agents_name'"));
    });
    group.profile = Name(yaml_.Find(item, "profile_selector"), item, profiles_, "profile");
    group.state = Name(yaml_.Find(item, "state_selector"), item, states_, "state");
    group.start = {Number(item, "x", 0.0), Number(item, "y", 0.0)};
    return group;
  }

  // A condition, or two with "type: or" or "type: and".
  void ReadConditions(const YamlNode& node, CrowdTransition& transition) {
    const auto read = [&](const YamlNode& condition) {
      const std::string type = Text(condition, "type");
      if (type == "goal_reached") transition.distance = Positive(condition, "distance");
      if (type == "timer") transition.wait = Positive(condition, "value");
    };
    read(node);
    for (const char* part : {"condition1", "condition2"}) read(yaml_.Find(node, part));
  }

  CrowdTransition ReadTransition(const YamlNode& item) {
    CrowdTransition transition;
    transition.from = Name(yaml_.Find(item, "from"), item, states_, "state");
    if (!Text(item, "to").empty()) transition.to.push_back({Name(yaml_.Find(item, "to"), item, states_, "state"), 1.0});
    yaml_.ForEachItem(yaml_.Find(item, "Target"), "'Target'", [&](const YamlNode& target) {
      transition.to.push_back({Name(yaml_.Find(target, "name"), target, states_, "state"),
                               yaml_.Number(yaml_.Find(target, "weight"), "'weight'", 1.0, 0.0)});
    });
    ReadConditions(yaml_.Find(item, "Condition"), transition);
    return transition;
  }

  // A name that is among the `known`; `item`: of which it is a value.
  std::string Name(const YamlNode& node, const YamlNode& item, const std::set<std::string>& known, const char* what) {
    std::string name = yaml_.Text(node, "a name of a " + std::string(what));
    if (!known.contains(name)) {
      yaml_.Fail(node ? node : item, "found no " + std::string(what) + " " + Quoted(name) +
                                         " in 'crowd_sim', expected one" +
                                         DidYouMean(name, {known.begin(), known.end()}));
    }
    return name;
  }

  YamlReader& yaml_;
  std::set<std::string> profiles_;  // names, like the next
  std::set<std::string> states_;
};

}  // namespace

SiteCrowd ReadCrowd(YamlReader& yaml, const YamlNode& node) {
  return CrowdReader(yaml).Read(node);
}

}  // namespace troupe
