#include "worldfile/sites/building_text.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <string_view>
#include <vector>

#include "troupe/deterministic_math.h"
#include "worldfile/sites/building_keys.h"

namespace troupe {
namespace {

// A text in double quotes is the same in JSON and YAML.
std::string InQuotes(const std::string& text) {
  return nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

// Numbers with all their digits.
std::string DigitsOf(double number) {
  return fmt::format("{}", number);
}

std::string InList(const std::vector<std::string>& texts) {
  return fmt::format("[{}]", fmt::join(texts, ", "));
}

// `key: [type, value]`, as the editor of building files writes parameters.
// The number before each value is its type in that editor: 1 text, 2 integer, 3 number, 4 flag.
class ParameterList {
 public:
  void Text(std::string_view key, const std::string& text) {
    if (!text.empty()) Add(key, 1, InQuotes(text));
  }
  void Whole(std::string_view key, std::int64_t number) { Add(key, 2, fmt::format("{}", number)); }
  void Number(std::string_view key, double number) { Add(key, 3, DigitsOf(number)); }
  void Flag(std::string_view key, bool flag) { Add(key, 4, flag ? "true" : "false"); }

  std::string ToText() const { return fmt::format("{{{}}}", fmt::join(entries_, ", ")); }
  bool empty() const { return entries_.empty(); }

 private:
  void Add(std::string_view key, int type, const std::string& value) {
    entries_.push_back(fmt::format("{}: [{}, {}]", key, type, value));
  }

  std::vector<std::string> entries_;
};

// Flags that are not set are left out, as the editor does.
std::string VertexText(const SiteVertex& vertex) {
  ParameterList parameters;
  for (const auto& [key, member] : kVertexFlags) {
    if (vertex.*member) parameters.Flag(key, true);
  }
  for (const auto& [key, member] : kVertexTexts) parameters.Text(key, vertex.*member);
  std::string text = fmt::format("[{}, {}, 0, {}", DigitsOf(vertex.position.x()), DigitsOf(vertex.position.y()),
                                 InQuotes(vertex.name));
  if (!parameters.empty()) text += ", " + parameters.ToText();
  return text + "]";
}

std::string EdgeText(const SiteEdge& edge, const ParameterList& parameters) {
  return fmt::format("[{}, {}, {}]", edge.start, edge.end, parameters.ToText());
}

std::string DoorText(const SiteDoor& door) {
  // Degrees that a user writes have few digits.
  const double degrees = std::round(RadiansToDegrees(door.swing) * 1e9) / 1e9;
  ParameterList parameters;
  parameters.Text("name", door.name);
  parameters.Text("type", NameOf(door.kind));
  parameters.Number("motion_degrees", degrees);
  parameters.Whole("motion_direction", door.opens_clockwise ? 1 : -1);
  parameters.Text("motion_axis", door.hinge_at_end ? "end" : "start");
  parameters.Number("right_left_ratio", door.right_left_ratio);
  parameters.Text("plugin", door.is_operated ? "normal" : "none");
  return EdgeText(door.edge, parameters);
}

std::string WorkcellText(const SiteWorkcell& workcell) {
  return fmt::format("{{model_name: {}, name: {}, static: true, x: {}, y: {}, yaw: 0, z: {}}}",
                     workcell.dispenses ? kDispenserModel : kIngestorModel, InQuotes(workcell.name),
                     DigitsOf(workcell.position.x()), DigitsOf(workcell.position.y()), DigitsOf(workcell.height));
}

std::string LaneText(const SiteLane& lane) {
  ParameterList parameters;
  parameters.Flag("bidirectional", lane.is_bidirectional);
  parameters.Whole("graph_idx", lane.graph);
  parameters.Text("orientation", lane.orientation);
  if (lane.speed_limit > 0.0) parameters.Number("speed_limit", lane.speed_limit);
  parameters.Text("mutex", lane.mutex);
  return EdgeText(lane.edge, parameters);
}

std::string HumanLaneText(const SiteHumanLane& lane) {
  ParameterList parameters;
  parameters.Whole("graph_idx", lane.graph);
  parameters.Number("width", lane.width);
  return EdgeText(lane.edge, parameters);
}

// A list of which each item is a line.
template <typename Item, typename ToText>
std::string Lines(const char* indent, const char* key, const std::vector<Item>& items, ToText to_text) {
  if (items.empty()) return {};
  std::string text = fmt::format("{}{}:\n", indent, key);
  for (const Item& item : items) text += fmt::format("{}  - {}\n", indent, to_text(item));
  return text;
}

std::string LevelText(const SiteLevel& level) {
  constexpr const char* kIndent = "    ";
  std::string text = fmt::format("  {}:\n    elevation: {}\n", InQuotes(level.name), DigitsOf(level.elevation));
  text += Lines(kIndent, "vertices", level.vertices, VertexText);
  text += Lines(kIndent, "walls", level.walls, [](const SiteEdge& wall) { return EdgeText(wall, {}); });
  text += Lines(kIndent, "floors", level.floors, [](const SiteFloor& floor) {
    return fmt::format("{{vertices: [{}]}}", fmt::join(floor.vertices, ", "));
  });
  text += Lines(kIndent, "doors", level.doors, DoorText);
  text += Lines(kIndent, "lanes", level.lanes, LaneText);
  text += Lines(kIndent, "models", level.workcells, WorkcellText);
  text += Lines(kIndent, "human_lanes", level.human_lanes, HumanLaneText);
  return text;
}

std::string LiftText(const Site& site, const SiteLift& lift) {
  const std::string initial = InQuotes(site.levels[lift.initial_level].name);
  std::string text = fmt::format("  {}:\n    initial_floor_name: {}\n    reference_floor_name: {}\n",
                                 InQuotes(lift.name), initial, initial);
  text += fmt::format("    plugins: {}\n    width: {}\n    depth: {}\n    x: {}\n    y: {}\n    yaw: {}\n",
                      lift.is_operated, DigitsOf(lift.width), DigitsOf(lift.depth), DigitsOf(lift.X_WC.x),
                      DigitsOf(lift.X_WC.y), DigitsOf(lift.X_WC.heading));
  if (!lift.doors.empty()) text += "    doors:\n";
  for (const SiteLiftDoor& door : lift.doors) {
    text += fmt::format("      {}: {{x: {}, y: {}, width: {}, motion_axis_orientation: {}}}\n", InQuotes(door.name),
                        DigitsOf(door.position.x()), DigitsOf(door.position.y()), DigitsOf(door.width),
                        DigitsOf(door.heading));
  }
  if (!lift.doors.empty()) text += "    level_doors:\n";
  for (std::size_t i = 0; i < site.levels.size(); ++i) {
    if (lift.doors_at[i].empty()) continue;
    std::vector<std::string> names;
    for (const std::size_t door : lift.doors_at[i]) names.push_back(InQuotes(lift.doors[door].name));
    text += fmt::format("      {}: {}\n", InQuotes(site.levels[i].name), InList(names));
  }
  return text;
}

std::string ProfileText(const CrowdProfile& profile) {
  return fmt::format(
      "{{name: {}, r: {}, pref_speed: {}, max_speed: {}, neighbor_dist: {}, max_neighbors: {}, ORCA_tau: {}, "
      "ORCA_tauObst: {}}}",
      InQuotes(profile.name), DigitsOf(profile.radius), DigitsOf(profile.speed), DigitsOf(profile.max_speed),
      DigitsOf(profile.neighbor_dist), profile.max_neighbors, DigitsOf(profile.horizon),
      DigitsOf(profile.horizon_obstacles));
}

std::string GroupText(const CrowdGroup& group) {
  std::vector<std::string> robots;
  for (const std::string& robot : group.robots) robots.push_back(InQuotes(robot));
  return fmt::format("{{agents_name: {}, agents_number: {}, profile_selector: {}, state_selector: {}, x: {}, y: {}}}",
                     InList(robots), group.count, InQuotes(group.profile), InQuotes(group.state),
                     DigitsOf(group.start.x()), DigitsOf(group.start.y()));
}

std::string GoalSetText(const CrowdGoalSet& set) {
  std::vector<std::string> areas;
  for (const std::string& area : set.areas) areas.push_back(InQuotes(area));
  return fmt::format("{{set_id: {}, capacity: {}, set_area: {}}}", set.id, set.capacity, InList(areas));
}

// A transition has both conditions in Troupe, the one that is not given with 0.
std::string TransitionText(const CrowdTransition& transition) {
  std::vector<std::string> targets;
  for (const CrowdChoice& choice : transition.to) {
    targets.push_back(fmt::format("{{name: {}, weight: {}}}", InQuotes(choice.state), DigitsOf(choice.weight)));
  }
  return fmt::format(
      "{{from: {}, Target: {}, Condition: {{type: or, condition1: {{type: goal_reached, distance: {}}}, condition2: "
      "{{type: timer, value: {}}}}}}}",
      InQuotes(transition.from), InList(targets), DigitsOf(transition.distance), DigitsOf(transition.wait));
}

std::string CrowdText(const SiteCrowd& crowd) {
  if (crowd.profiles.empty() && crowd.states.empty() && crowd.groups.empty()) return {};
  std::string text = fmt::format("crowd_sim:\n  enable: {}\n  update_time_step: {}\n", crowd.is_enabled ? 1 : 0,
                                 DigitsOf(crowd.interval));
  text += Lines("  ", "agent_profiles", crowd.profiles, ProfileText);
  text += Lines("  ", "agent_groups", crowd.groups, GroupText);
  text += Lines("  ", "states", crowd.states, [](const CrowdState& state) {
    return fmt::format("{{name: {}, goal_set: {}, final: {}}}", InQuotes(state.name), state.goal_set,
                       state.is_final ? 1 : 0);
  });
  text += Lines("  ", "goal_sets", crowd.goal_sets, GoalSetText);
  return text + Lines("  ", "transitions", crowd.transitions, TransitionText);
}

}  // namespace

// In metres and with y up (cartesian_meters): plans, scales and measurements have been applied.
std::string BuildingText(const Site& site) {
  std::string text = fmt::format("name: {}\ncoordinate_system: cartesian_meters\n", InQuotes(site.name));
  text += CrowdText(site.crowd);
  text += "levels:\n";
  for (const SiteLevel& level : site.levels) text += LevelText(level);
  if (!site.lifts.empty()) text += "lifts:\n";
  for (const SiteLift& lift : site.lifts) text += LiftText(site, lift);
  return text;
}

}  // namespace troupe
