#include "worldfile/sites/crowd_yaml.h"

#include <set>
#include <utility>

namespace troupe {
namespace {

class CrowdReader {
 public:
  explicit CrowdReader(YamlReader& yaml) : yaml_(yaml) {}

  SiteCrowd Read(const YamlNode& node) {
    SiteCrowd crowd;
    if (node.is_missing_or_null()) return crowd;
    crowd.is_enabled = yaml_.Flag(yaml_.Find(node, "enable"), "'enable'", false);
    crowd.interval = yaml_.Number(yaml_.Find(node, "update_time_step"), "'update_time_step'", 0.1, 1e-6, 1e3);
    const auto each = [&](const char* key, auto visit) {
      yaml_.ForEachItem(yaml_.Find(node, key), Quoted(key), visit);
    };
    each("agent_profiles", [&](const YamlNode& item) { crowd.profiles.push_back(ReadProfile(item)); });
    each("states", [&](const YamlNode& item) {
      crowd.states.push_back({Text(item, "name"), static_cast<std::int64_t>(Number(item, "goal_set", -1.0)),
                              yaml_.Flag(yaml_.Find(item, "final"), "'final'", false)});
    });
    each("goal_sets", [&](const YamlNode& item) { crowd.goal_sets.push_back(ReadGoalSet(item)); });
    each("agent_groups", [&](const YamlNode& item) { crowd.groups.push_back(ReadGroup(item)); });
    each("transitions", [&](const YamlNode& item) { crowd.transitions.push_back(ReadTransition(item)); });
    if (!yaml_.failed()) CheckNames(crowd, node);
    return crowd;
  }

 private:
  double Number(const YamlNode& map, const char* key, double otherwise) {
    return yaml_.Number(yaml_.Find(map, key), Quoted(key), otherwise);
  }
  double Positive(const YamlNode& map, const char* key) {
    return yaml_.Number(yaml_.Find(map, key), Quoted(key), 0.0, 0.0);
  }
  std::string Text(const YamlNode& map, const char* key) { return yaml_.Text(yaml_.Find(map, key), Quoted(key)); }

  CrowdProfile ReadProfile(const YamlNode& item) {
    CrowdProfile profile;
    profile.name = Text(item, "name");
    profile.radius = Positive(item, "r");
    profile.speed = Positive(item, "pref_speed");
    profile.max_speed = Positive(item, "max_speed");
    profile.neighbor_dist = Positive(item, "neighbor_dist");
    profile.max_neighbors = static_cast<std::size_t>(Positive(item, "max_neighbors"));
    profile.horizon = Positive(item, "ORCA_tau");
    profile.horizon_obstacles = Positive(item, "ORCA_tauObst");
    return profile;
  }

  CrowdGoalSet ReadGoalSet(const YamlNode& item) {
    CrowdGoalSet set;
    set.id = static_cast<std::int64_t>(Number(item, "set_id", 0.0));
    set.capacity = static_cast<std::size_t>(Positive(item, "capacity"));
    yaml_.ForEachItem(yaml_.Find(item, "set_area"), "'set_area'",
                      [&](const YamlNode& area) { set.areas.push_back(yaml_.Text(area, "a name in 'set_area'")); });
    return set;
  }

  CrowdGroup ReadGroup(const YamlNode& item) {
    CrowdGroup group;
    group.count =
        static_cast<std::size_t>(yaml_.Number(yaml_.Find(item, "agents_number"), "'agents_number'", 0.0, 0.0));
    yaml_.ForEachItem(yaml_.Find(item, "agents_name"), "'agents_name'", [&](const YamlNode& name) {
      group.robots.push_back(yaml_.Text(name, "a name in 'agents_name'"));
    });
    group.profile = Text(item, "profile_selector");
    group.state = Text(item, "state_selector");
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
    transition.from = Text(item, "from");
    if (const std::string to = Text(item, "to"); !to.empty()) transition.to.push_back({to, 1.0});
    yaml_.ForEachItem(yaml_.Find(item, "Target"), "'Target'", [&](const YamlNode& target) {
      transition.to.push_back({Text(target, "name"), yaml_.Number(yaml_.Find(target, "weight"), "'weight'", 1.0, 0.0)});
    });
    ReadConditions(yaml_.Find(item, "Condition"), transition);
    return transition;
  }

  // Every profile and state that is named exists.
  void CheckNames(const SiteCrowd& crowd, const YamlNode& node) {
    const auto check = [&](const std::set<std::string>& known, const std::string& name, const char* what) {
      if (known.contains(name)) return;
      yaml_.Fail(node, "found no " + std::string(what) + " " + Quoted(name) + " in 'crowd_sim', expected one" +
                           DidYouMean(name, {known.begin(), known.end()}));
    };
    const auto names_of = [](const auto& named) {
      std::set<std::string> names;
      for (const auto& each : named) names.insert(each.name);
      return names;
    };
    const std::set<std::string> profiles = names_of(crowd.profiles);
    const std::set<std::string> states = names_of(crowd.states);
    for (const CrowdGroup& group : crowd.groups) {
      check(profiles, group.profile, "profile");
      check(states, group.state, "state");
    }
    for (const CrowdTransition& transition : crowd.transitions) {
      check(states, transition.from, "state");
      for (const CrowdChoice& choice : transition.to) check(states, choice.state, "state");
    }
  }

  YamlReader& yaml_;
};

}  // namespace

SiteCrowd ReadCrowd(YamlReader& yaml, const YamlNode& node) {
  return CrowdReader(yaml).Read(node);
}

}  // namespace troupe
