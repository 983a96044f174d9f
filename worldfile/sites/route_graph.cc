#include "worldfile/sites/route_graph.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "common/base/json_reader.h"
#include "common/geometry/limits.h"
#include "worldfile/sites/site_frame.h"
#include "worldfile/text/text_file.h"

namespace troupe {
namespace {

class RouteGraphReader {
 public:
  explicit RouteGraphReader(JsonTree tree) : root_(std::move(tree)) {
    site_.file = root_.where().file;
    site_.name = "route_graph";
    site_.levels.emplace_back().name = "L1";
    site_.levels[0].where = root_.where();
  }

  Result<Site> Read() {
    if (!root_.Has("features")) root_.FailWithout("features", "a list of nodes and edges");
    const std::vector<JsonReader> features = root_.ItemsOf("features");
    // Edges may precede their nodes.
    for (const JsonReader& feature : features) ReadNode(feature);
    for (const JsonReader& feature : features) ReadEdge(feature);
    if (site_.levels[0].vertices.empty()) root_.FailWith("found no node, expected features with points");
    if (Status status = root_.status(); !status.ok()) return status.error();
    site_.warnings = std::move(warnings_.warnings());
    return std::move(site_);
  }

 private:
  static std::string TypeOf(const JsonReader& feature) {
    const std::optional<JsonReader> geometry = feature.Find("geometry");
    const std::optional<JsonReader> type = geometry ? geometry->Find("type") : std::nullopt;
    if (!type || !type->node().is_string()) {
      feature.FailWithout("geometry", "an object with a type");
      return "";
    }
    return type->node().text;
  }

  void WarnOnce(const std::string& key, const JsonReader& value, const std::string& message) {
    if (warned_.insert(key).second) warnings_.Warn(value.where(), message);
  }

  // An id that no other feature has.
  std::optional<std::uint32_t> IdOf(const JsonReader& properties) {
    const auto id = properties.Get<std::uint32_t>("id");
    if (!root_.ok()) return std::nullopt;
    if (ids_.insert(id).second) return id;
    properties.Find("id")->Fail("an id that no other node or edge has");
    return std::nullopt;
  }

  void ReadNode(const JsonReader& feature) {
    if (!root_.ok() || TypeOf(feature) != "Point") return;
    const std::optional<JsonReader> properties = feature.Find("properties");
    if (!properties) {
      feature.FailWithout("properties", "an object with an id");
      return;
    }
    const std::optional<std::uint32_t> id = IdOf(*properties);
    if (!id) return;
    const std::optional<JsonReader> place = feature.Find("geometry")->Find("coordinates");
    const std::vector<JsonReader> numbers = place ? place->Items(3) : std::vector<JsonReader>();
    if (numbers.size() < 2) {
      feature.Find("geometry")->FailWithout("coordinates", "a list of x and y in metres");
      return;
    }
    const std::optional<double> x = numbers[0].Number(-kMaxMagnitude, kMaxMagnitude);
    const std::optional<double> y = numbers[1].Number(-kMaxMagnitude, kMaxMagnitude);
    if (!x || !y) return;
    SiteVertex vertex;
    vertex.position = Rounded({*x, *y});
    vertex.where = feature.where();
    vertex.name = std::to_string(*id);
    const std::optional<JsonReader> frame = properties->Find("frame");
    if (frame && frame->node().text != "map") {
      WarnOnce("frame", *frame, "found a node in another frame than 'map', whose coordinates are taken as those of it");
    }
    if (const std::optional<JsonReader> metadata = properties->Find("metadata")) {
      metadata->Read("name", vertex.name);
      metadata->Read("dock", vertex.dock);
      metadata->Read("charger", vertex.is_charger);
      if (!IsPlainLine(vertex.name) || vertex.name.empty()) metadata->Find("name")->Fail("a name on one line");
    }
    if (properties->Has("operations")) {
      WarnOnce("operations", *properties, "found operations of nodes, which have no effect");
    }
    std::vector<SiteVertex>& vertices = site_.levels[0].vertices;
    nodes_.emplace(*id, vertices.size());
    vertices.push_back(std::move(vertex));
  }

  std::optional<std::size_t> NodeOf(const JsonReader& properties, const char* key) const {
    const auto id = properties.Get<std::uint32_t>(key);
    if (!root_.ok()) return std::nullopt;
    const auto node = nodes_.find(id);
    if (node != nodes_.end()) return node->second;
    properties.Find(key)->Fail("the id of a node");
    return std::nullopt;
  }

  void ReadEdge(const JsonReader& feature) {
    if (!root_.ok()) return;
    const std::string type = TypeOf(feature);
    if (type == "Point") return;
    if (type != "LineString" && type != "MultiLineString") {
      feature.Find("geometry")->Find("type")->Fail("'Point', 'LineString' or 'MultiLineString'");
      return;
    }
    const std::optional<JsonReader> properties = feature.Find("properties");
    if (!properties) {
      feature.FailWithout("properties", "an object with an id, a startid and an endid");
      return;
    }
    if (!IdOf(*properties)) return;
    const std::optional<std::size_t> start = NodeOf(*properties, "startid");
    const std::optional<std::size_t> end = NodeOf(*properties, "endid");
    if (!start || !end) return;
    if (start == end) {
      properties->Find("endid")->Fail("the id of another node than that of 'startid'");
      return;
    }
    SiteLane lane;
    lane.edge = {*start, *end, feature.where()};
    if (const std::optional<JsonReader> metadata = properties->Find("metadata")) {
      lane.speed_limit = metadata->Number("abs_speed_limit", 0.0, kMaxMagnitude).value_or(0.0);
      metadata->Read("mutex", lane.mutex);
      for (const char* key : {"speed_limit", "penalty"}) {
        const std::optional<JsonReader> found = metadata->Find(key);
        if (!found) continue;
        WarnOnce(key, *found,
                 "found '" + std::string(key) + "' of edges, which has no effect" +
                     (key[0] == 's' ? "; 'abs_speed_limit' is one in m/s" : ""));
      }
    }
    if (const std::optional<double> cost = properties->Number("cost", -kMaxMagnitude, kMaxMagnitude);
        cost && *cost != 0.0) {
      WarnOnce("cost", *properties, "found costs of edges, which have no effect: routes are the fastest ones");
    }
    AddEdge(lane);
  }

  void AddEdge(const SiteLane& lane) {
    std::vector<SiteLane>& lanes = site_.levels[0].lanes;
    if (const auto back = numbers_.find({lane.edge.end, lane.edge.start}); back != numbers_.end()) {
      SiteLane& other = lanes[back->second];
      if (!other.is_bidirectional && other.speed_limit == lane.speed_limit && other.mutex == lane.mutex) {
        other.is_bidirectional = true;
        return;
      }
    }
    numbers_.emplace(std::pair(lane.edge.start, lane.edge.end), lanes.size());
    lanes.push_back(lane);
  }

  const JsonReader root_;
  Diagnostics warnings_;
  Site site_;
  std::set<std::uint32_t> ids_;
  std::map<std::uint32_t, std::size_t> nodes_;                          // vertices by id
  std::map<std::pair<std::size_t, std::size_t>, std::size_t> numbers_;  // of lanes, by their vertices
  std::set<std::string> warned_;
};

}  // namespace

bool IsRouteGraphPath(const std::string& path) {
  return path.ends_with(".geojson");
}

Result<Site> ReadRouteGraphText(const std::string& text, const std::string& path) {
  Result<JsonTree> tree = JsonTree::Parse(text, path);
  if (!tree.ok()) return tree.error();
  return RouteGraphReader(std::move(tree).value()).Read();
}

Result<Site> ReadRouteGraph(const std::string& path, const AllowedPaths& allowed) {
  const Result<std::string> text = ReadTextFile(path, {path}, allowed);
  if (!text.ok()) return text.error();
  return ReadRouteGraphText(text.value(), path);
}

std::string RouteGraphText(const LaneGraph& graph, double z) {
  using Json = nlohmann::ordered_json;
  Json features = Json::array();
  std::vector<std::optional<std::size_t>> ids(graph.vertices.size());
  const auto place = [&](std::size_t vertex) {
    const Vec2& position = graph.vertices[vertex].position;
    return Json::array({position.x(), position.y()});
  };
  for (std::size_t i = 0; i < graph.vertices.size(); ++i) {
    const LaneVertex& vertex = graph.vertices[i];
    if (vertex.is_between || std::fabs(vertex.z - z) >= kLevelGap) continue;
    ids[i] = features.size();
    Json metadata = Json::object();
    if (!vertex.name.empty()) metadata["name"] = vertex.name;
    if (!vertex.dock.empty()) metadata["dock"] = vertex.dock;
    if (vertex.is_charger) metadata["charger"] = true;
    features.push_back({{"type", "Feature"},
                        {"properties", {{"id", *ids[i]}, {"frame", "map"}, {"metadata", std::move(metadata)}}},
                        {"geometry", {{"type", "Point"}, {"coordinates", place(i)}}}});
  }
  const auto add = [&](std::size_t from, std::size_t to, const Lane& lane) {
    Json metadata = Json::object();
    if (lane.speed_limit > 0.0) metadata["abs_speed_limit"] = lane.speed_limit;
    if (!lane.mutex.empty()) metadata["mutex"] = lane.mutex;
    features.push_back(
        {{"type", "Feature"},
         {"properties",
          {{"id", features.size()}, {"startid", *ids[from]}, {"endid", *ids[to]}, {"metadata", std::move(metadata)}}},
         {"geometry",
          {{"type", "MultiLineString"}, {"coordinates", Json::array({Json::array({place(from), place(to)})})}}}});
  };
  for (const WholeLane& whole : WholeLanesOf(graph)) {
    if (!ids[whole.start] || !ids[whole.end]) continue;
    const Lane& lane = graph.lanes[whole.parts.front()];
    add(whole.start, whole.end, lane);
    if (lane.is_bidirectional) add(whole.end, whole.start, lane);
  }
  const Json file = {{"type", "FeatureCollection"},
                     {"name", "graph"},
                     {"crs", {{"type", "name"}, {"properties", {{"name", "urn:ogc:def:crs:EPSG::3857"}}}}},
                     {"features", std::move(features)}};
  return file.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace troupe
