#include "worldfile/sites/lif_json.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <tuple>
#include <utility>

#include "common/base/json_reader.h"
#include "common/geometry/limits.h"
#include "troupe/deterministic_math.h"
#include "worldfile/sites/site_frame.h"
#include "worldfile/sites/site_tree.h"
#include "worldfile/text/text_file.h"

namespace troupe {
namespace {

// At the top of a layout, of any version, and of no scenario.
constexpr std::array kLayoutKeys = {"metaInformation", "layouts", "origins"};

// Angles beyond a turn are degrees: many writers give them so, against the standard.
double AngleOf(double value) {
  return WrapAngle(std::fabs(value) > 2.0 * kPi + 0.01 ? DegreesToRadians(value) : value);
}

// LIF 1.0 (VDMA, Layout Interchange Format): nodes become vertices, edges lanes, stations docks. A layout has no walls
// and no heights: its levels are kLayoutStorey apart.
class LayoutReader {
 public:
  explicit LayoutReader(JsonTree tree) : root_(std::move(tree)) {
    site_.file = root_.where().file;
    site_.name = "layout";
  }

  Result<Site> Read() {
    if (const std::optional<JsonReader> about = root_.Find("metaInformation")) {
      CheckVersion(*about);
      const std::string name = Text(*about, "projectIdentification", false);
      if (!name.empty()) site_.name = name;
    }
    RefuseKey(root_, "origins", "layouts");
    const std::vector<JsonReader> layouts = List(root_, "layouts", true);
    // Edges and stations may name nodes of other layouts.
    for (const JsonReader& layout : layouts) ReadNodes(layout);
    for (const JsonReader& layout : layouts) ReadRest(layout);
    if (site_.levels.empty()) root_.FailWith("found no layout, expected at least one");
    if (Status status = root_.status(); !status.ok()) return status.error();
    if (site_.levels.size() > 1) {
      Warn(root_, "found " + CountText(site_.levels.size(), "level") +
                      ", whose heights this file does not have; they are " + NumberText(kLayoutStorey) + " m apart");
    }
    site_.warnings = std::move(warnings_.warnings());
    return std::move(site_);
  }

 private:
  struct Place {
    std::size_t level = 0;
    std::size_t vertex = 0;
  };

  void Warn(const JsonReader& value, const std::string& message) { warnings_.Warn(value.where(), message); }

  // Files without a version, and drafts before version 1, have the keys of version 1.
  static void CheckVersion(const JsonReader& about) {
    const std::optional<JsonReader> version = about.Find("lifVersion");
    if (!version) return;
    const std::string& text = version->node().text;
    const bool is_known =
        version->node().is_string() && (text == "0" || text == "1" || text.starts_with("0.") || text.starts_with("1."));
    if (!is_known) version->Fail("version 1 of LIF");
  }

  // A key of version 2 of the format, or of a draft of that, in place of the one of version 1.
  static void RefuseKey(const JsonReader& object, const char* key, const char* expected) {
    const std::optional<JsonReader> found = object.Find(key);
    if (!found || object.Has(expected)) return;
    found->FailAtKey("found the key " + Quoted(key) + " of version 2 of LIF, expected " + Quoted(expected) +
                     " of version 1");
  }

  // Values of an object; a fault gives a default.
  static std::string Text(const JsonReader& object, const char* key, bool is_needed) {
    const std::optional<JsonReader> found = object.Find(key);
    if (!found && is_needed) object.FailWithout(key, "a text");
    if (!found) return "";
    const std::string& text = found->node().text;
    if (found->node().is_string() && IsPlainLine(text) && !(is_needed && text.empty())) return text;
    found->Fail("a text");
    return "";
  }
  static std::vector<JsonReader> List(const JsonReader& object, const char* key, bool is_needed) {
    if (is_needed && !object.Has(key)) object.FailWithout(key, "a list");
    return object.ItemsOf(key);
  }

  // Layouts of one level id are one level.
  std::size_t LevelOf(const JsonReader& layout) {
    std::string name = Text(layout, "layoutLevelId", false);
    if (name.empty()) name = Text(layout, "layoutId", true);
    for (std::size_t i = 0; i < site_.levels.size(); ++i) {
      if (site_.levels[i].name == name) return i;
    }
    SiteLevel& level = site_.levels.emplace_back();
    level.name = name;
    level.elevation = kLayoutStorey * static_cast<double>(site_.levels.size() - 1);
    level.where = layout.where();
    return site_.levels.size() - 1;
  }

  // Positions are in m in the project's frame, which becomes W.
  void ReadNodes(const JsonReader& layout) {
    const std::size_t number = LevelOf(layout);
    SiteLevel& level = site_.levels[number];
    for (const JsonReader& node : List(layout, "nodes", true)) {
      if (!root_.ok()) return;
      SiteVertex vertex;
      vertex.name = Text(node, "nodeId", true);
      vertex.where = node.where();
      const std::optional<JsonReader> position = node.Find("nodePosition");
      const auto x = position ? position->Number("x", -kMaxMagnitude, kMaxMagnitude) : std::nullopt;
      const auto y = position ? position->Number("y", -kMaxMagnitude, kMaxMagnitude) : std::nullopt;
      if (!x || !y) {
        node.FailWithout("nodePosition", "an object with the numbers x and y");
        return;
      }
      vertex.position = Rounded({*x, *y});
      RefuseKey(node, "mobileRobotTypeNodeProperties", "vehicleTypeNodeProperties");
      for (const JsonReader& properties : List(node, "vehicleTypeNodeProperties", false)) {
        for (const JsonReader& action : List(properties, "actions", false)) {
          vertex.is_charger = vertex.is_charger || Text(action, "actionType", false) == "startCharging";
        }
      }
      if (!places_.emplace(vertex.name, Place{number, level.vertices.size()}).second) {
        node.Find("nodeId")->Fail("an id that no other node has");
        return;
      }
      level.vertices.push_back(std::move(vertex));
    }
  }

  // The node that `id` names.
  std::optional<Place> Find(const JsonReader& id) const {
    const auto found = places_.find(id.node().text);
    if (id.node().is_string() && found != places_.end()) return found->second;
    id.Fail("the id of a node");
    return std::nullopt;
  }
  std::optional<Place> FindNode(const JsonReader& edge, const char* key) const {
    if (const std::optional<JsonReader> id = edge.Find(key)) return Find(*id);
    edge.FailWithout(key, "the id of a node");
    return std::nullopt;
  }

  void ReadRest(const JsonReader& layout) {
    for (const JsonReader& edge : List(layout, "edges", true)) {
      if (!root_.ok()) return;
      ReadEdge(edge);
    }
    for (const JsonReader& station : List(layout, "stations", false)) {
      const std::string id = Text(station, "stationId", true);
      for (const JsonReader& node : List(station, "interactionNodeIds", true)) {
        const std::optional<Place> place = Find(node);
        if (!root_.ok()) return;
        std::string& dock = site_.levels[place->level].vertices[place->vertex].dock;
        if (dock.empty()) dock = id;
      }
    }
  }

  void ReadEdge(const JsonReader& edge) {
    const std::optional<Place> start = FindNode(edge, "startNodeId");
    const std::optional<Place> end = FindNode(edge, "endNodeId");
    if (!root_.ok()) return;
    if (start->level != end->level) {
      return Warn(edge, "found an edge between two levels, expected both nodes on one; it is left out");
    }
    SiteLane lane;
    lane.edge = {start->vertex, end->vertex, edge.where()};
    RefuseKey(edge, "mobileRobotTypeEdgeProperties", "vehicleTypeEdgeProperties");
    const std::vector<JsonReader> types = List(edge, "vehicleTypeEdgeProperties", false);
    if (types.empty()) return AddLane(start->level, lane);
    for (const JsonReader& properties : types) {
      lane.graph = GraphOf(Text(properties, "vehicleTypeId", true));
      lane.speed_limit = properties.Number("maxSpeed", 0.0, kMaxMagnitude).value_or(0.0);
      lane.orientation = OrientationOf(properties, site_.levels[start->level], lane.edge);
      const std::optional<JsonReader> trajectory = properties.Find("trajectory");
      if (trajectory && List(*trajectory, "controlPoints", true).size() > 2 && !has_curve_) {
        has_curve_ = true;
        Warn(*trajectory, "found a trajectory, which is not followed: lanes are straight");
      }
      AddLane(start->level, lane);
    }
  }

  // Each vehicle type has its own lanes, as each robot type of a building has a graph; numbers in the order of the
  // file.
  std::uint32_t GraphOf(const std::string& vehicle_type) {
    return graphs_.emplace(vehicle_type, static_cast<std::uint32_t>(graphs_.size())).first->second;
  }

  // LIF has any angle between vehicle and edge; lanes know forward, backward and any. Angles between count as any.
  std::string OrientationOf(const JsonReader& properties, const SiteLevel& level, const SiteEdge& edge) {
    const std::optional<double> angle = properties.Number("vehicleOrientation", -kMaxMagnitude, kMaxMagnitude);
    if (!angle) return "";
    double relative = AngleOf(*angle);
    if (Text(properties, "orientationType", false) == "GLOBAL") {
      const Vec2 way = level.vertices[edge.end].position - level.vertices[edge.start].position;
      relative = WrapAngle(relative - Atan2(way.y(), way.x()));
    }
    if (std::fabs(relative) < 0.25 * kPi) return "forward";
    return std::fabs(relative) > 0.75 * kPi ? "backward" : "";
  }

  // Two edges of a type to and fro are one lane, if a robot may turn round or keeps its heading on the way back.
  void AddLane(std::size_t level, const SiteLane& lane) {
    std::vector<SiteLane>& lanes = site_.levels[level].lanes;
    const std::string back = lane.orientation == "forward"    ? "backward"
                             : lane.orientation == "backward" ? "forward"
                                                              : lane.orientation;
    const auto key = std::tuple(level, lane.graph, lane.edge.end, lane.edge.start);
    if (const auto found = numbers_.find(key); found != numbers_.end()) {
      SiteLane& other = lanes[found->second];
      if (!other.is_bidirectional && other.speed_limit == lane.speed_limit && other.orientation == back) {
        other.is_bidirectional = true;
        return;
      }
    }
    // The first edge of a pair stays the key: a third one in the same direction is a lane of its own.
    numbers_.emplace(std::tuple(level, lane.graph, lane.edge.start, lane.edge.end), lanes.size());
    lanes.push_back(lane);
  }

  const JsonReader root_;
  Diagnostics warnings_;
  Site site_;
  std::map<std::string, Place> places_;                                                              // of nodes, by id
  std::map<std::string, std::uint32_t> graphs_;                                                      // by vehicle type
  std::map<std::tuple<std::size_t, std::uint32_t, std::size_t, std::size_t>, std::size_t> numbers_;  // of lanes
  bool has_curve_ = false;
};

}  // namespace

std::vector<std::vector<std::string>> NodeIds(const Site& site) {
  std::vector<std::vector<std::string>> ids = PlaceNames(site);
  for (std::size_t i = 0; i < ids.size(); ++i) {
    for (std::size_t vertex = 0; vertex < ids[i].size(); ++vertex) {
      if (ids[i][vertex].empty()) ids[i][vertex] = site.levels[i].name + "." + std::to_string(vertex);
    }
  }
  return ids;
}

// The inverse, without what LIF has no key for: walls, doors and lifts. Each direction of a lane is an edge.
std::string LayoutText(const Site& site, const std::string& timestamp) {
  using Json = nlohmann::ordered_json;
  Json layouts = Json::array();
  const std::vector<std::vector<std::string>> ids = NodeIds(site);
  for (std::size_t i = 0; i < site.levels.size(); ++i) {
    const SiteLevel& level = site.levels[i];
    const auto id = [&](std::size_t vertex) { return ids[i][vertex]; };
    std::map<std::size_t, std::set<std::uint32_t>> graphs;  // of vertices
    Json edges = Json::array();
    const auto add_edge = [&](const SiteLane& lane, bool is_back) {
      Json properties = Json::object();
      properties["vehicleTypeId"] = "graph_" + std::to_string(lane.graph);
      if (!lane.orientation.empty()) {
        properties["vehicleOrientation"] = (lane.orientation == "forward") != is_back ? 0.0 : kPi;
        properties["orientationType"] = "TANGENTIAL";
      }
      if (lane.speed_limit > 0.0) properties["maxSpeed"] = lane.speed_limit;
      const std::size_t start = is_back ? lane.edge.end : lane.edge.start;
      const std::size_t end = is_back ? lane.edge.start : lane.edge.end;
      edges.push_back({{"edgeId", level.name + ".edge_" + std::to_string(edges.size())},
                       {"startNodeId", id(start)},
                       {"endNodeId", id(end)},
                       {"vehicleTypeEdgeProperties", Json::array({std::move(properties)})}});
    };
    for (const SiteLane& lane : level.lanes) {
      graphs[lane.edge.start].insert(lane.graph);
      graphs[lane.edge.end].insert(lane.graph);
      add_edge(lane, false);
      if (lane.is_bidirectional) add_edge(lane, true);
    }
    Json nodes = Json::array();
    std::map<std::string, std::vector<std::string>> docks;
    for (const auto& [number, types] : graphs) {
      const SiteVertex& vertex = level.vertices[number];
      Json of_types = Json::array();
      for (const std::uint32_t graph : types) {
        Json& of_type = of_types.emplace_back(Json::object());
        of_type["vehicleTypeId"] = "graph_" + std::to_string(graph);
        if (!vertex.is_charger) continue;
        of_type["actions"] =
            Json::array({Json{{"actionType", "startCharging"}, {"required", false}, {"blockingType", "HARD"}}});
      }
      nodes.push_back({{"nodeId", id(number)},
                       {"mapId", level.name},
                       {"nodePosition", {{"x", vertex.position.x()}, {"y", vertex.position.y()}}},
                       {"vehicleTypeNodeProperties", std::move(of_types)}});
      if (!vertex.dock.empty()) docks[vertex.dock].push_back(id(number));
    }
    Json stations = Json::array();
    for (const auto& [dock, at] : docks) stations.push_back({{"stationId", dock}, {"interactionNodeIds", at}});
    layouts.push_back({{"layoutId", level.name},
                       {"layoutVersion", "1"},
                       {"layoutLevelId", level.name},
                       {"nodes", std::move(nodes)},
                       {"edges", std::move(edges)},
                       {"stations", std::move(stations)}});
  }
  const Json file{{"metaInformation",
                   {{"projectIdentification", site.name},
                    {"creator", "Troupe"},
                    {"exportTimestamp", timestamp},
                    {"lifVersion", "1.0.0"}}},
                  {"layouts", std::move(layouts)}};
  return file.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

bool IsLayoutPath(const std::string& path, const AllowedPaths& allowed) {
  if (!path.ends_with(".json")) return false;
  const Result<std::string> text = ReadTextFile(path, {path}, allowed);
  if (!text.ok()) return false;
  // A cheap test before the parse: every scenario passes through here.
  const auto has = [&](const std::string& key) { return text.value().find('"' + key + '"') != std::string::npos; };
  if (std::none_of(kLayoutKeys.begin(), kLayoutKeys.end(), has)) return false;
  const Result<JsonTree> tree = JsonTree::Parse(text.value(), path);
  // One that cannot be parsed is still none of the other kinds.
  if (!tree.ok()) return path.ends_with(".lif.json");
  return std::any_of(kLayoutKeys.begin(), kLayoutKeys.end(),
                     [&](const char* key) { return tree.value().root().Find(key) != nullptr; });
}

Result<Site> ReadLayoutText(const std::string& text, const std::string& path) {
  Result<JsonTree> tree = JsonTree::Parse(text, path);
  if (!tree.ok()) return tree.error();
  return LayoutReader(std::move(tree).value()).Read();
}

Result<Site> ReadLayout(const std::string& path, const AllowedPaths& allowed) {
  const Result<std::string> text = ReadTextFile(path, {path}, allowed);
  if (!text.ok()) return text.error();
  return ReadLayoutText(text.value(), path);
}

}  // namespace troupe
