#include "worldfile/sites/building_parts.h"

#include <algorithm>
#include <numbers>
#include <set>

#include "worldfile/sites/building_keys.h"

namespace troupe {
namespace {

std::uint32_t ReadGraph(YamlReader& yaml, const YamlNode& params) {
  return static_cast<std::uint32_t>(yaml.Number(yaml.Parameter(params, "graph_idx"), "'graph_idx'", 0.0, 0.0, 1e6));
}

}  // namespace

Vec2 ReadPoint(YamlReader& yaml, const YamlNode& list, const std::string& what) {
  const double x = yaml.Number(list[0], "the x of " + what, 0.0);
  const double y = yaml.Number(list[1], "the y of " + what, 0.0);
  return {x, y};
}

// [x, y, z, name, {parameters}] in the plan's coordinates; y points down where they are pixels. Unknown parameters are
// warnings: editors of buildings add their own.
SiteVertex ReadVertex(YamlReader& yaml, const YamlNode& node) {
  SiteVertex vertex;
  if (!yaml.HasItems(node, 2, "a vertex")) return vertex;
  vertex.where = yaml.At(node);
  vertex.position = ReadPoint(yaml, node, "a vertex");
  if (node.size() > 3) vertex.name = yaml.Text(node[3], "a vertex's name");
  if (node.size() < 5) return vertex;
  const YamlNode& params = node[4];
  std::set<std::string> known;
  for (const auto& [key, member] : kVertexFlags) {
    vertex.*member = yaml.Flag(yaml.Parameter(params, key), Quoted(key), false);
    known.insert(key);
  }
  for (const auto& [key, member] : kVertexTexts) {
    vertex.*member = yaml.Text(yaml.Parameter(params, key), Quoted(key));
    known.insert(key);
  }
  yaml.WarnOfUnknownKeys(params, "a vertex", known);
  return vertex;
}

// Only dispensers and ingestors have a meaning here; other models of a building are left out.
std::optional<SiteWorkcell> ReadWorkcell(YamlReader& yaml, const YamlNode& model) {
  const std::string model_name = yaml.Text(yaml.Find(model, "model_name"), "a model's name");
  const std::string kind = model_name.substr(model_name.rfind('/') + 1);  // "OpenRobotics/TeleportDispenser", too
  if (kind != kDispenserModel && kind != kIngestorModel) return std::nullopt;
  SiteWorkcell workcell;
  workcell.where = yaml.At(model);
  workcell.dispenses = kind == kDispenserModel;
  workcell.name = yaml.Text(yaml.Require(model, "name", "a " + kind), "the name of a " + kind);
  const auto number = [&](const char* key) {
    return yaml.Number(yaml.Require(model, key, "a " + kind), Quoted(key) + " of a " + kind, 0.0, -1e9, 1e9);
  };
  workcell.position = {number("x"), number("y")};
  workcell.height = yaml.Number(yaml.Find(model, "z"), "'z' of a " + kind, 0.0, -kMaxMagnitude, kMaxMagnitude);
  return workcell;
}

// Most files leave parameters out, so that each has a default. A telescope door is simulated as a sliding one.
SiteDoor ReadDoor(YamlReader& yaml, const SiteEdge& edge, const YamlNode& params) {
  SiteDoor door;
  door.edge = edge;
  door.name = yaml.Text(yaml.Parameter(params, "name"), "a door's name");
  const YamlNode& kind = yaml.Parameter(params, "type");
  const std::string text = yaml.Text(kind, "the type of door " + Quoted(door.name), "hinged");
  constexpr std::string_view kTelescope = "telescope";  // slides
  std::string word = text;
  if (text.ends_with(kTelescope)) word.replace(text.size() - kTelescope.size(), kTelescope.size(), "sliding");
  if (const auto found = FindByName<DoorKind>(word)) {
    door.kind = *found;
  } else {
    yaml.Fail(kind,
              "found the door type " + Quoted(text) + ", expected hinged, double_hinged, sliding or double_sliding");
  }
  door.swing = std::numbers::pi / 180.0 *
               yaml.Number(yaml.Parameter(params, "motion_degrees"), "'motion_degrees'", 90.0, -360.0, 360.0);
  door.opens_clockwise = yaml.Number(yaml.Parameter(params, "motion_direction"), "'motion_direction'", 1.0) >= 0.0;
  door.hinge_at_end = yaml.Text(yaml.Parameter(params, "motion_axis"), "'motion_axis'", "start") == "end";
  door.right_left_ratio = yaml.Number(yaml.Parameter(params, "right_left_ratio"), "'right_left_ratio'", 1.0, 1e-3, 1e3);
  door.is_operated = yaml.Text(yaml.Parameter(params, "plugin"), "'plugin'", "normal") != "none";
  return door;
}

// `is_bidirectional` is the name in older files.
SiteLane ReadLane(YamlReader& yaml, const SiteEdge& edge, const YamlNode& params) {
  SiteLane lane;
  lane.edge = edge;
  lane.graph = ReadGraph(yaml, params);
  const YamlNode& both_ways = yaml.Parameter(params, "bidirectional");
  const YamlNode& former_name = yaml.Parameter(params, "is_bidirectional");
  lane.is_bidirectional = yaml.Flag(both_ways ? both_ways : former_name, "'bidirectional'", false);
  lane.orientation = yaml.Text(yaml.Parameter(params, "orientation"), "'orientation'");
  lane.speed_limit = std::max(0.0, yaml.Number(yaml.Parameter(params, "speed_limit"), "'speed_limit'", 0.0));
  lane.mutex = yaml.Text(yaml.Parameter(params, "mutex"), "'mutex'");
  return lane;
}

SiteHumanLane ReadHumanLane(YamlReader& yaml, const SiteEdge& edge, const YamlNode& params) {
  const double width = yaml.Number(yaml.Parameter(params, "width"), "'width'", 0.0, 0.0);
  return {edge, ReadGraph(yaml, params), width};
}

}  // namespace troupe
