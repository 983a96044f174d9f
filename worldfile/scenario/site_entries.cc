#include "worldfile/scenario/site_entries.h"

#include <algorithm>
#include <utility>

#include "common/base/text.h"
#include "common/model/lane_rules.h"
#include "common/model/zones.h"
#include "worldfile/text/text_file.h"

namespace troupe {
namespace {

FlowEntry ReadFlow(const JsonTree& tree, const JsonNode& object) {
  FlowEntry entry;
  GoodsFlow& flow = entry.flow;
  flow.from = object.Member("from").text;
  flow.to = object.Member("to").text;
  entry.from = tree.Where(object.Member("from"));
  entry.to = tree.Where(object.Member("to"));
  flow.name = flow.from + " - " + flow.to;
  object.Read("name", flow.name);
  object.Read("per_hour", flow.per_hour);
  if (const JsonNode* const arrival = object.Find("arrival")) flow.is_random = arrival->text == "random";
  object.Read("stock", flow.stock);
  object.Read("room", flow.room);
  object.Read("due", flow.due);
  object.Read("load", flow.load_seconds);
  object.Read("unload", flow.unload_seconds);
  object.Read("robots", flow.robots);
  return entry;
}

// A lane is closed, or has a limit, or is as the building says.
Status ReadLaneRule(const JsonTree& tree, const JsonNode& object, double& value) {
  const JsonNode* const closed = object.Find("closed");
  const JsonNode* const limit = object.Find("speed_limit");
  if ((closed == nullptr) == (limit == nullptr)) {
    return tree.ErrorAt(object, "found an event of a lane, expected one of 'closed' and 'speed_limit' in it");
  }
  bool is_closed = false;
  object.Read("closed", is_closed);
  value = is_closed ? 0.0 : -1.0;
  object.Read("speed_limit", value);
  return Status();
}

Result<EventEntry> ReadEvent(const JsonTree& tree, const JsonNode& object) {
  EventEntry entry;
  object.Read("at", entry.action.at);
  const JsonNode* subject = nullptr;
  for (const TimedKind kind : {TimedKind::kDoor, TimedKind::kLift, TimedKind::kLane, TimedKind::kZone}) {
    const JsonNode* const found = object.Find(NameOf(kind));
    if (found == nullptr) continue;
    if (subject != nullptr) return tree.ErrorAt(*found, "found a second thing in an event, expected one");
    subject = found;
    entry.action.kind = kind;
  }
  if (subject == nullptr) return tree.ErrorAt(object, "found an event of nothing, expected a door, lift, lane or zone");
  const JsonNode& first = subject->is_array() ? subject->items[0] : *subject;
  entry.name = first.text;
  entry.where = tree.Where(first);
  // What happens to each kind, and what does not.
  const auto expected_key = [&]() -> std::string {
    switch (entry.action.kind) {
      case TimedKind::kDoor:
        return "opening";
      case TimedKind::kLift:
        return "floor";
      case TimedKind::kLane:
        return "";
      case TimedKind::kZone:
        return "on";
    }
    return "";
  }();
  for (const char* key : {"opening", "floor", "on", "closed", "speed_limit"}) {
    const JsonNode* const found = object.Find(key);
    const bool is_of_lane = std::string(key) == "closed" || std::string(key) == "speed_limit";
    const bool fits = entry.action.kind == TimedKind::kLane ? is_of_lane : key == expected_key;
    if (found != nullptr && !fits) {
      return tree.ErrorAt(*found, "found '" + std::string(key) + "' in an event of a " + NameOf(entry.action.kind) +
                                      ", which does not have it");
    }
  }
  if (entry.action.kind == TimedKind::kLane) {
    entry.other = subject->items[1].text;
    if (Status problem = ReadLaneRule(tree, object, entry.action.value); !problem.ok()) return problem.error();
    return entry;
  }
  const JsonNode* const value = object.Find(expected_key);
  if (value == nullptr) {
    return tree.ErrorAt(object, "found an event of a " + std::string(NameOf(entry.action.kind)) + " without '" +
                                    expected_key + "', expected it");
  }
  if (entry.action.kind == TimedKind::kLift) {
    entry.other = value->text;
    entry.other_where = tree.Where(*value);
  } else if (entry.action.kind == TimedKind::kZone) {
    bool on = false;
    object.Read("on", on);
    entry.action.value = on ? 1.0 : 0.0;
  } else {
    object.Read("opening", entry.action.value);
  }
  return entry;
}

// Names of vertices that robots can be sent to.
std::vector<std::string> NamesOfVertices(const WorldDescription& world) {
  std::vector<std::string> names;
  for (const LaneGraph& graph : world.lane_graphs) {
    for (const LaneVertex& vertex : graph.vertices) {
      if (!vertex.name.empty()) names.push_back(vertex.name);
    }
  }
  return names;
}

const LaneVertex* FindVertex(const WorldDescription& world, const std::string& name) {
  for (const LaneGraph& graph : world.lane_graphs) {
    if (const std::optional<std::size_t> vertex = graph.Find(name)) return &graph.vertices[*vertex];
  }
  return nullptr;
}

Error NoVertex(const WorldDescription& world, const std::string& name, const SourceLocation& where) {
  return {where, "found no place " + Quoted(name) + " on a lane, expected the name of one" +
                     DidYouMean(name, NamesOfVertices(world))};
}

Status AddFlow(const FlowEntry& entry, WorldDescription& world) {
  GoodsFlow flow = entry.flow;
  const LaneVertex* const from = FindVertex(world, flow.from);
  if (from == nullptr) return NoVertex(world, flow.from, entry.from);
  if (FindVertex(world, flow.to) == nullptr) return NoVertex(world, flow.to, entry.to);
  if (flow.from == flow.to) return Error{entry.to, "found a flow to its own start, expected another place"};
  flow.place = from->position;
  flow.z = from->z;
  for (const GoodsFlow& other : world.flows) {
    if (other.name != flow.name) continue;
    return Error{entry.from, "found the flow " + Quoted(flow.name) + " again, expected another 'name'"};
  }
  world.flows.push_back(std::move(flow));
  return Status();
}

template <typename Parts>
std::vector<std::string> NamesOfModels(const WorldDescription& world, const Parts& parts) {
  std::vector<std::string> names;
  for (const auto& part : parts) names.push_back(world.model(part.model).name);
  return names;
}

Error NoThing(const EventEntry& event, const std::string& kind, const std::vector<std::string>& names) {
  return {event.where,
          "found no " + kind + " " + Quoted(event.name) + ", expected the name of one" + DidYouMean(event.name, names)};
}

Status AddEvent(const EventEntry& event, WorldDescription& world) {
  TimedAction action = event.action;
  const auto set = [&](std::optional<std::size_t> number) {
    if (number) action.number = static_cast<std::uint32_t>(*number);
    return number.has_value();
  };
  if (action.kind == TimedKind::kDoor) {
    if (!set(FindDoor(world, event.name))) return NoThing(event, "door", NamesOfModels(world, world.doors));
    if (!world.doors[action.number].is_operated) {
      return Error{event.where,
                   "found the door " + Quoted(event.name) + ", which is not operated, expected another one"};
    }
  } else if (action.kind == TimedKind::kLift) {
    if (!set(FindLift(world, event.name))) return NoThing(event, "lift", NamesOfModels(world, world.lifts));
    const std::vector<LiftFloor>& floors = world.lifts[action.number].floors;
    const auto floor = std::find_if(floors.begin(), floors.end(), [&](const auto& f) { return f.name == event.other; });
    if (floor == floors.end()) {
      return Error{event.other_where,
                   "found no floor " + Quoted(event.other) + " of the lift, expected one of its floors"};
    }
    action.value = static_cast<double>(floor - floors.begin());
  } else if (action.kind == TimedKind::kLane) {
    const std::optional<std::uint32_t> lane = FindLane(world, event.name, event.other);
    if (!lane) {
      return Error{event.where, "found no lane between " + Quoted(event.name) + " and " + Quoted(event.other) +
                                    ", expected the names of its ends"};
    }
    action.number = *lane;
  } else if (!set(FindZone(world, event.name))) {
    std::vector<std::string> names;
    for (const ZoneDescription& zone : world.zones) names.push_back(zone.name);
    return NoThing(event, "zone", names);
  } else if (world.zones[action.number].kind == ZoneKind::kOneWay) {
    return Error{event.where, "found the one_way zone " + Quoted(event.name) +
                                  ", which is on for the whole run, expected a zone of another kind"};
  }
  world.timed_actions.push_back(action);
  return Status();
}

}  // namespace

Result<SiteEntries> ReadSiteEntries(const JsonTree& tree, const JsonNode& root) {
  SiteEntries entries;
  Result<std::vector<ZoneEntry>> zones = ReadZoneEntries(tree, root);
  if (!zones.ok()) return zones.error();
  entries.zones = std::move(zones).value();
  for (const JsonNode& object : root.ItemsOf("flows")) entries.flows.push_back(ReadFlow(tree, object));
  for (const JsonNode& object : root.ItemsOf("events")) {
    Result<EventEntry> event = ReadEvent(tree, object);
    if (!event.ok()) return event.error();
    entries.events.push_back(std::move(event).value());
  }
  return entries;
}

Status AddSiteEntries(const SiteEntries& entries, const std::string& path, const AllowedPaths& allowed,
                      LoadedWorld& loaded) {
  if (Status problem = AddZones(entries.zones, path, allowed, loaded); !problem.ok()) return problem;
  WorldDescription& world = loaded.world;
  for (const FlowEntry& flow : entries.flows) {
    if (Status problem = AddFlow(flow, world); !problem.ok()) return problem;
  }
  for (const EventEntry& event : entries.events) {
    if (Status problem = AddEvent(event, world); !problem.ok()) return problem;
  }
  // Those of one time stay in the order of the file.
  std::stable_sort(world.timed_actions.begin(), world.timed_actions.end(),
                   [](const TimedAction& a, const TimedAction& b) { return a.at < b.at; });
  return Status();
}

}  // namespace troupe
