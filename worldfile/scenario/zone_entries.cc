#include "worldfile/scenario/zone_entries.h"

#include <algorithm>
#include <filesystem>
#include <memory>
#include <span>
#include <utility>

#include "common/base/source_text.h"
#include "common/model/zones.h"
#include "troupe/deterministic_math.h"
#include "troupe/rectangle.h"
#include "worldfile/map/zone_mask.h"
#include "worldfile/sites/site.h"
#include "worldfile/text/text_file.h"

namespace troupe {
namespace {

// The keys of a zone that only some kinds have, and those that have to have them.
Status CheckKeys(const JsonTree& tree, const JsonNode& object, ZoneKind kind) {
  const bool is_speed = kind == ZoneKind::kSpeed;
  const JsonNode* const limit = object.Find("speed_limit");
  const JsonNode* const mask = object.Find("mask");
  const std::string of_kind = std::string(NameOf(kind)) + " zone";
  if ((object.Find("region") == nullptr) == (mask == nullptr)) {
    return tree.ErrorAt(object, "found a zone with " + std::string(mask == nullptr ? "neither" : "both") +
                                    " of 'region' and 'mask', expected one of them");
  }
  if (mask != nullptr && kind != ZoneKind::kKeepout && !is_speed) {
    return tree.ErrorAt(*mask, "found a 'mask' of a " + of_kind + ", expected it of a keepout or speed zone");
  }
  if (is_speed && limit == nullptr && mask == nullptr) {
    return tree.ErrorAt(object, "found a speed zone without 'speed_limit', expected one in m/s");
  }
  if (!is_speed && limit != nullptr) {
    return tree.ErrorAt(*limit, "found a 'speed_limit' of a " + of_kind + ", expected it of a speed zone alone");
  }
  for (const char* key : {"base", "multiplier"}) {
    const JsonNode* const found = object.Find(key);
    if (found == nullptr || (is_speed && mask != nullptr)) continue;
    return tree.ErrorAt(*found, "found '" + std::string(key) + "' of a zone that is no speed mask, expected it of one");
  }
  const JsonNode* const heading = object.Find("heading");
  if (kind == ZoneKind::kOneWay && heading == nullptr) {
    return tree.ErrorAt(object, "found a one_way zone without 'heading', expected the direction of its traffic");
  }
  if (kind != ZoneKind::kOneWay && heading != nullptr) {
    return tree.ErrorAt(*heading, "found a 'heading' of a " + of_kind + ", expected it of a one_way zone alone");
  }
  const JsonNode* const exits = object.Find("exits");
  if ((kind == ZoneKind::kEvacuation) != (exits != nullptr && !exits->items.empty())) {
    return tree.ErrorAt(exits != nullptr ? *exits : object,
                        kind == ZoneKind::kEvacuation
                            ? "found an evacuation zone without an exit, expected 'exits' at which people leave"
                            : "found 'exits' of a " + of_kind + ", expected them of an evacuation zone alone");
  }
  const JsonNode* const on = object.Find("on");
  if (kind == ZoneKind::kOneWay && on != nullptr && on->kind == JsonNode::Kind::kFalse) {
    return tree.ErrorAt(*on, "found a one_way zone that is off, expected it to be on for the whole run");
  }
  return Status();
}

Result<ZoneEntry> ReadZone(const JsonTree& tree, const JsonNode& object) {
  ZoneEntry entry;
  ZoneDescription& zone = entry.zone;
  zone.name = object.Member("name").text;
  entry.where = tree.Where(object.Member("name"));
  object.Read("kind", zone.kind);
  if (Status problem = CheckKeys(tree, object, zone.kind); !problem.ok()) return problem.error();
  object.Read("z", zone.z);
  object.Read("speed_limit", zone.speed_limit);
  object.Read("on", zone.is_on);
  entry.exits = ReadGoals(tree, object, "exits", zone.z);
  object.Read("base", entry.base);
  object.Read("multiplier", entry.multiplier);
  double degrees = 0.0;
  object.Read("heading", degrees);
  zone.heading = WrapAngle(DegreesToRadians(degrees));
  if (const JsonNode* const mask = object.Find("mask")) {
    entry.mask = mask->text;
    entry.mask_where = tree.Where(*mask);
    return entry;
  }
  Result<Polygon> region = ReadRegion(tree, object.Member("region"));
  if (!region.ok()) return region.error();
  zone.outline = std::move(region).value();
  const Rectangle box = BoundingBox(zone.outline);
  const double cells = (box.max_x - box.min_x) * (box.max_y - box.min_y) / (kCoverageCell * kCoverageCell);
  if (zone.kind == ZoneKind::kCleaning && cells > static_cast<double>(kMaxCoverageCells)) {
    return tree.ErrorAt(object.Member("region"),
                        "found a cleaning zone of more than 10000 m^2, expected a smaller one");
  }
  return entry;
}

// m/s; 0: none.
double LimitOf(const ZoneEntry& entry, int number) {
  const double value = entry.base + entry.multiplier * number;
  return entry.zone.speed_limit > 0.0 ? value / 100.0 * entry.zone.speed_limit : value;
}

Result<std::vector<ZoneDescription>> ZonesOf(const ZoneEntry& entry, const std::string& path,
                                             const AllowedPaths& allowed) {
  if (!entry.mask) return std::vector{entry.zone};
  const std::filesystem::path file = std::filesystem::path(DirectoryOf(path)) / *entry.mask;
  const bool is_keepout = entry.zone.kind == ZoneKind::kKeepout;
  Result<std::vector<MaskArea>> areas =
      ReadZoneMask(file.lexically_normal().string(), entry.mask_where, allowed, is_keepout);
  if (!areas.ok()) return areas.error();
  std::vector<ZoneDescription> zones;
  for (MaskArea& area : areas.value()) {
    ZoneDescription zone = entry.zone;
    zone.outline = std::move(area.outline);
    zone.name = entry.zone.name + (areas.value().size() > 1 ? "." + std::to_string(zones.size() + 1) : "");
    if (!is_keepout) {
      zone.speed_limit = LimitOf(entry, area.number);
      if (zone.speed_limit == 0.0) continue;
      if (!(zone.speed_limit > 0.0)) {
        return Error{entry.mask_where, "found a limit of " + NumberText(zone.speed_limit) + " m/s for cells of " +
                                           std::to_string(area.number) + ", expected one above 0"};
      }
    }
    zones.push_back(std::move(zone));
  }
  return zones;
}

// The way back along a lane.
Lane Turned(const Lane& lane, double length) {
  Lane turned = lane;
  std::swap(turned.start, turned.end);
  if (lane.facing != LaneFacing::kAny) {
    turned.facing = lane.facing == LaneFacing::kForward ? LaneFacing::kBackward : LaneFacing::kForward;
  }
  std::reverse(turned.doors.begin(), turned.doors.end());
  for (LaneDoor& door : turned.doors) door.at = std::max(0.0, length - door.at);
  return turned;
}

// Removes lanes, and the waiting points on them alone.
void LeaveOut(const std::vector<bool>& is_left_out, LaneGraph& graph) {
  std::vector<bool> is_used(graph.vertices.size(), false);
  std::size_t lanes = 0;
  for (std::size_t i = 0; i < graph.lanes.size(); ++i) {
    if (is_left_out[i]) continue;
    is_used[graph.lanes[i].start] = is_used[graph.lanes[i].end] = true;
    if (lanes != i) graph.lanes[lanes] = std::move(graph.lanes[i]);
    ++lanes;
  }
  graph.lanes.resize(lanes);
  std::vector<std::uint32_t> numbers(graph.vertices.size(), 0);
  std::size_t vertices = 0;
  for (std::size_t i = 0; i < graph.vertices.size(); ++i) {
    if (graph.vertices[i].is_between && !is_used[i]) continue;
    numbers[i] = static_cast<std::uint32_t>(vertices);
    if (vertices != i) graph.vertices[vertices] = std::move(graph.vertices[i]);
    ++vertices;
  }
  graph.vertices.resize(vertices);
  for (Lane& lane : graph.lanes) {
    lane.start = numbers[lane.start];
    lane.end = numbers[lane.end];
  }
}

// Leaves a lane along `way` the directions that the zone allows; `turn` turns it round. False: none is left.
template <typename DirectedLane, typename Turn>
bool KeepDirections(const ZoneDescription& zone, const Vec2& way, DirectedLane& lane, const Turn& turn) {
  const bool may_go = !IsAgainst(zone, way);
  const bool may_return = lane.is_bidirectional && !IsAgainst(zone, -way);
  if (!may_go && may_return) turn(lane);
  lane.is_bidirectional = may_go && may_return;
  return may_go || may_return;
}

// A lane of the site is so as a whole, with all its parts.
void Direct(const WorldDescription& world, const ZoneDescription& zone, LaneGraph& graph) {
  std::vector<bool> is_left_out(graph.lanes.size(), false);
  for (const WholeLane& whole : WholeLanesOf(graph)) {
    const bool is_in = std::any_of(whole.parts.begin(), whole.parts.end(), [&](std::uint32_t part) {
      const Lane& lane = graph.lanes[part];
      const LaneVertex& start = graph.vertices[lane.start];
      return CrossesZone(world, zone, start.position, graph.vertices[lane.end].position, start.z);
    });
    if (!is_in) continue;
    const Vec2 way = graph.Way(whole.start, whole.end);
    for (const std::uint32_t part : whole.parts) {
      is_left_out[part] = !KeepDirections(zone, way, graph.lanes[part], [&](Lane& lane) {
        lane = Turned(lane, graph.Way(lane.start, lane.end).norm());
      });
    }
  }
  LeaveOut(is_left_out, graph);
}

// The same lanes of the site, which are whole: exported maps and the map of the building in ROS have them.
void Direct(const WorldDescription& world, const ZoneDescription& zone, SiteLevel& level) {
  std::erase_if(level.lanes, [&](SiteLane& lane) {
    const Vec2& start = level.vertices[lane.edge.start].position;
    const Vec2& end = level.vertices[lane.edge.end].position;
    if (!CrossesZone(world, zone, start, end, level.elevation)) return false;
    return !KeepDirections(zone, end - start, lane, [](SiteLane& turned) {
      std::swap(turned.edge.start, turned.edge.end);
      if (turned.orientation.empty()) return;
      turned.orientation = turned.orientation == "forward" ? "backward" : "forward";
    });
  });
}

// The lanes of the site, by the zones of the world from `first` on.
void DirectSite(std::size_t first, LoadedWorld& loaded) {
  const std::span zones = std::span(loaded.world.zones).subspan(first);
  const auto is_one_way = [](const ZoneDescription& zone) { return zone.kind == ZoneKind::kOneWay; };
  if (loaded.site == nullptr || std::none_of(zones.begin(), zones.end(), is_one_way)) return;
  auto site = std::make_shared<Site>(*loaded.site);  // the file's own is shared
  for (const ZoneDescription& zone : zones) {
    if (!is_one_way(zone)) continue;
    for (SiteLevel& level : site->levels) Direct(loaded.world, zone, level);
  }
  loaded.site = std::move(site);
}

}  // namespace

Result<std::vector<ZoneEntry>> ReadZoneEntries(const JsonTree& tree, const JsonNode& root) {
  std::vector<ZoneEntry> entries;
  for (const JsonNode& object : root.ItemsOf("zones")) {
    Result<ZoneEntry> entry = ReadZone(tree, object);
    if (!entry.ok()) return entry.error();
    entries.push_back(std::move(entry).value());
  }
  return entries;
}

Status AddZones(const std::vector<ZoneEntry>& entries, const std::string& path, const AllowedPaths& allowed,
                LoadedWorld& loaded) {
  WorldDescription& world = loaded.world;
  const std::size_t first = world.zones.size();
  for (const ZoneEntry& entry : entries) {
    Result<std::vector<ZoneDescription>> zones = ZonesOf(entry, path, allowed);
    if (!zones.ok()) return zones.error();
    if (entry.mask) {
      loaded.files.push_back((std::filesystem::path(DirectoryOf(path)) / *entry.mask).lexically_normal().string());
    }
    std::optional<std::uint32_t> exits;
    if (!entry.exits.empty()) {
      Result<GoalSet> places = PlacesOf(world, entry.exits);
      if (!places.ok()) return places.error();
      places.value().name = entry.zone.name + ", exit";
      exits = static_cast<std::uint32_t>(world.goal_sets.size());
      world.exits.push_back(*exits);
      world.goal_sets.push_back(std::move(places).value());
    }
    for (ZoneDescription& zone : zones.value()) {
      zone.exits = exits;
      if (FindZone(world, zone.name)) {
        return Error{entry.where, "found the zone '" + zone.name + "' again, expected another name"};
      }
      if (zone.kind == ZoneKind::kOneWay) {
        if (!world.lane_trips.empty()) {
          return Error{entry.where, "found a one_way zone in a problem of multi-agent paths, expected none there"};
        }
        for (LaneGraph& graph : world.lane_graphs) Direct(world, zone, graph);
      }
      world.zones.push_back(std::move(zone));
    }
  }
  DirectSite(first, loaded);
  return Status();
}

}  // namespace troupe
