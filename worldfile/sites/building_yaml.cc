#include "worldfile/sites/building_yaml.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "troupe/deterministic_math.h"
#include "worldfile/sites/building_parts.h"
#include "worldfile/sites/crowd_yaml.h"
#include "worldfile/sites/site_frame.h"
#include "worldfile/text/yaml_reader.h"

namespace troupe {
namespace {

constexpr double kMinStorey = 2.6;  // m between levels: a wall and the floor above it

// Each lift has a row for each level.
constexpr std::size_t kMaxLevels = 1000;
constexpr std::size_t kMaxLifts = 1000;
// Vertices, edges, floors with their corners, and models of all levels: hundreds of times as many as a hotel has, and
// each becomes some kilobytes of models, also where aliases repeat it.
constexpr std::size_t kMaxParts = 100'000;

class BuildingReader {
 public:
  explicit BuildingReader(const std::string& path) : yaml_(path, diagnostics_) { site_.file = path; }

  Result<Site> Read(const std::string& text) {
    const YamlNode& root = yaml_.Read(text, "levels");
    if (!diagnostics_.failed()) ReadRoot(root);
    if (diagnostics_.failed()) return *diagnostics_.error();
    site_.warnings = std::move(diagnostics_.warnings());
    return std::move(site_);
  }

 private:
  void ReadRoot(const YamlNode& root) {
    const YamlNode& former_name = yaml_.Find(root, "building_name");
    site_.name = yaml_.Text(former_name ? former_name : yaml_.Find(root, "name"), "the building's name", "building");
    const YamlNode& levels = yaml_.Require(root, "levels", "the building");
    CheckCount(levels, kMaxLevels, "level");
    yaml_.ForEachEntry(levels, "'levels'",
                       [&](const std::string& name, const YamlNode& level) { ReadLevel(name, level); });
    if (!yaml_.failed() && site_.levels.empty()) yaml_.Fail(levels, "found no level, expected at least one");
    if (yaml_.failed()) return;
    // After all levels are read: the origin vertex and the reference level may be anywhere in the file.
    PlaceLevels(root);
    CheckCount(yaml_.Find(root, "lifts"), kMaxLifts, "lift");
    yaml_.ForEachEntry(yaml_.Find(root, "lifts"), "'lifts'",
                       [&](const std::string& name, const YamlNode& lift) { ReadLift(name, lift); });
    CheckLiftCabins();
    site_.crowd = ReadCrowd(yaml_, yaml_.Find(root, "crowd_sim"));
    yaml_.WarnOfUnknownKeys(root, "a building",
                            {"building_name", "name", "coordinate_system", "reference_level_name", "parameters",
                             "levels", "lifts", "graphs", "crowd_sim", "map_version"});
    if (site_.furniture > 0) {
      yaml_.Warn(*first_model_, "found " + CountText(site_.furniture, "model") + " of " +
                                    CountText(furniture_.size(), "kind") +
                                    ", whose shapes are not in this file; they are left out");
    }
  }

  void CheckCount(const YamlNode& map, std::size_t most, const char* what) {
    const std::size_t count = map.is_map() ? map.items.size() / 2 : 0;
    if (count > most) {
      yaml_.Fail(map, "found " + CountText(count, what) + ", expected at most " + std::to_string(most));
    }
  }

  // As yaml_.ForEachItem, for parts of levels.
  void ForEachPart(const YamlNode& list, const std::string& what, const std::function<void(const YamlNode&)>& visit) {
    parts_ += list.size();
    if (parts_ > kMaxParts) {
      yaml_.Fail(list, "found more than " + std::to_string(kMaxParts) +
                           " vertices, edges, floors and models of levels, expected at most as many");
    }
    yaml_.ForEachItem(list, what, visit);
  }

  // A robot would wait for ever at a vertex in a lift that is not there.
  void CheckLiftCabins() {
    std::vector<std::string> names;
    for (const SiteLift& lift : site_.lifts) names.push_back(lift.name);
    for (const SiteLevel& level : site_.levels) {
      for (const SiteVertex& vertex : level.vertices) {
        const std::string& lift = vertex.lift_cabin;
        if (lift.empty() || std::find(names.begin(), names.end(), lift) != names.end()) continue;
        return diagnostics_.Fail(vertex.where, "found a vertex in the cabin of lift " + Quoted(lift) +
                                                   ", expected the name of a lift" + DidYouMean(lift, names));
      }
    }
  }

  // Levels, in coordinates of the file.

  void ReadLevel(const std::string& name, const YamlNode& node) {
    SiteLevel level;
    level.name = name;
    level.where = yaml_.At(node);
    const std::string of = "level " + Quoted(name);
    level.elevation = yaml_.Number(yaml_.Find(node, "elevation"), "the elevation of " + of, 0.0);
    level.drawing = yaml_.Text(yaml_.Find(yaml_.Find(node, "drawing"), "filename"), "the drawing of " + of);
    ForEachPart(yaml_.Find(node, "vertices"), "the vertices of " + of,
                [&](const YamlNode& vertex) { level.vertices.push_back(ReadVertex(yaml_, vertex)); });
    LevelPlan plan;
    ForEachPart(yaml_.Find(node, "fiducials"), "the fiducials of " + of, [&](const YamlNode& fiducial) {
      if (!yaml_.HasItems(fiducial, 3, "a fiducial")) return;
      plan.fiducials.push_back(
          {yaml_.Text(fiducial[2], "a fiducial's name"), ReadPoint(yaml_, fiducial, "a fiducial")});
    });
    ForEachEdge(node, "measurements", level,
                [&](const SiteEdge& edge, const YamlNode& params) { ReadMeasurement(level, edge, params, plan); });
    level.measurements = plan.measurements.size();
    plans_.push_back(std::move(plan));
    ForEachEdge(node, "walls", level, [&](const SiteEdge& edge, const YamlNode&) { level.walls.push_back(edge); });
    ForEachEdge(node, "doors", level, [&](const SiteEdge& edge, const YamlNode& params) {
      level.doors.push_back(ReadDoor(yaml_, edge, params));
    });
    ForEachEdge(node, "lanes", level, [&](const SiteEdge& edge, const YamlNode& params) {
      level.lanes.push_back(ReadLane(yaml_, edge, params));
    });
    ForEachEdge(node, "human_lanes", level, [&](const SiteEdge& edge, const YamlNode& params) {
      level.human_lanes.push_back(ReadHumanLane(yaml_, edge, params));
    });
    ForEachPart(yaml_.Find(node, "floors"), "the floors of " + of, [&](const YamlNode& floor) {
      SiteFloor read{{}, yaml_.At(floor)};
      ForEachPart(yaml_.Require(floor, "vertices", "a floor"), "the vertices of a floor", [&](const YamlNode& vertex) {
        read.vertices.push_back(yaml_.Index(vertex, "a vertex of a floor", level.vertices.size()));
      });
      level.floors.push_back(std::move(read));
    });
    ForEachPart(yaml_.Find(node, "models"), "the models of " + of, [&](const YamlNode& model) {
      if (std::optional<SiteWorkcell> workcell = ReadWorkcell(yaml_, model)) {
        return level.workcells.push_back(std::move(*workcell));
      }
      if (site_.furniture++ == 0) first_model_ = &model;
      furniture_.insert(yaml_.Text(yaml_.Find(model, "model_name"), "a model's name"));
    });
    if (const YamlNode& holes = yaml_.Find(node, "holes"); holes.size() > 0) {
      yaml_.Warn(holes, "found holes in floors; the floors are whole");
    }
    yaml_.WarnOfUnknownKeys(node, "a level",
                            {"elevation", "drawing", "vertices", "fiducials", "measurements", "walls", "doors", "lanes",
                             "human_lanes", "floors", "models", "holes", "layers", "features", "constraints",
                             "x_meters", "y_meters", "flattened_x_offset", "flattened_y_offset"});
    site_.levels.push_back(std::move(level));
  }

  void ForEachEdge(const YamlNode& level_node, const char* key, const SiteLevel& level,
                   const std::function<void(const SiteEdge& edge, const YamlNode& params)>& visit) {
    const std::string one = "one of the " + std::string(key) + " of level " + Quoted(level.name);
    ForEachPart(yaml_.Find(level_node, key), "the " + std::string(key), [&](const YamlNode& node) {
      if (!yaml_.HasItems(node, 2, one)) return;
      SiteEdge edge;
      edge.where = yaml_.At(node);
      edge.start = yaml_.Index(node[0], "the first vertex of " + one, level.vertices.size());
      edge.end = yaml_.Index(node[1], "the second vertex of " + one, level.vertices.size());
      if (!yaml_.failed()) visit(edge, node[2]);
    });
  }

  void ReadMeasurement(const SiteLevel& level, const SiteEdge& edge, const YamlNode& params, LevelPlan& plan) {
    const double meters = yaml_.Number(yaml_.Parameter(params, "distance"), "the distance of a measurement", 0.0);
    const double length = (level.vertices[edge.end].position - level.vertices[edge.start].position).norm();
    if (yaml_.failed()) return;
    if (length > 0.0 && meters > 0.0) return plan.measurements.push_back({length, meters});
    diagnostics_.Fail(edge.where, "found a measurement of " + NumberText(meters) +
                                      " m between points at a distance of " + NumberText(length) +
                                      ", expected both above 0");
  }

  // From coordinates of the file to W.

  SiteCoordinates ReadCoordinates(const YamlNode& root) {
    const YamlNode& node = yaml_.Find(root, "coordinate_system");
    const std::string text = yaml_.Text(node, "'coordinate_system'", "reference_image");
    if (text == "reference_image") return SiteCoordinates::kReferenceImage;
    if (text == "cartesian_meters") return SiteCoordinates::kCartesianMeters;
    if (text == "web_mercator") return SiteCoordinates::kWebMercator;
    if (text == "wgs84") return SiteCoordinates::kWgs84;
    yaml_.Fail(node, "found the coordinate system " + Quoted(text) +
                         ", expected reference_image, cartesian_meters, web_mercator or wgs84");
    return SiteCoordinates::kReferenceImage;
  }

  // Degrees of a place of a file on the globe.
  static Vec2 DegreesOf(SiteCoordinates coordinates, const Vec2& p) {
    return coordinates == SiteCoordinates::kWebMercator ? FromWebMercator(p) : p;
  }

  SiteFrame MakeFrame(const YamlNode& root, SiteCoordinates coordinates) {
    const YamlNode& params = yaml_.Find(root, "parameters");
    const auto number = [&](const char* key) {
      return yaml_.Number(yaml_.Parameter(params, key), Quoted(key), 0.0, -1e9, 1e9);
    };
    if (coordinates == SiteCoordinates::kReferenceImage) return {coordinates, {}, {0.0, 0.0}};
    if (coordinates == SiteCoordinates::kCartesianMeters)
      return {coordinates, {}, {number("offset_x"), number("offset_y")}};
    const YamlNode& crs = yaml_.Parameter(params, "generate_crs");
    const std::string name = yaml_.Text(crs, "'generate_crs'");
    const std::optional<TransverseMercator> known = ProjectionOf(name);
    const SiteVertex* const origin = FindOrigin(params);
    if (known && coordinates == SiteCoordinates::kWgs84) {
      return {coordinates, *known, {number("suggested_offset_x"), number("suggested_offset_y")}};
    }
    if (origin == nullptr) return {coordinates, {}, {0.0, 0.0}};
    const Vec2 degrees = DegreesOf(coordinates, origin->position);
    if (known) return {coordinates, *known, known->Project(degrees.x(), degrees.y())};
    yaml_.Warn(crs, "found the coordinate reference system " + Quoted(name) +
                        ", expected EPSG:3414 or one of UTM (EPSG:326xx, EPSG:327xx); metres east and north of the "
                        "first vertex are used");
    TransverseMercator local;
    local.latitude = DegreesToRadians(degrees.y());
    local.longitude = DegreesToRadians(degrees.x());
    return {coordinates, local, {0.0, 0.0}};
  }

  // The vertex that the parameters name as the origin, or the first one; null if there is none.
  const SiteVertex* FindOrigin(const YamlNode& params) {
    const std::string name =
        yaml_.Text(yaml_.Parameter(params, "generate_origin_vertex"), "'generate_origin_vertex'", "origin");
    const SiteVertex* first = nullptr;
    for (const SiteLevel& level : site_.levels) {
      for (const SiteVertex& vertex : level.vertices) {
        if (vertex.name == name) return &vertex;
        if (first == nullptr) first = &vertex;
      }
    }
    return first;
  }

  // False for NaN, too: a place near a pole may have no projection.
  static bool IsNear(const Vec2& p) { return std::fabs(p.x()) <= kMaxMagnitude && std::fabs(p.y()) <= kMaxMagnitude; }

  void PlaceLevels(const YamlNode& root) {
    const SiteCoordinates coordinates = ReadCoordinates(root);
    const SiteFrame frame = MakeFrame(root, coordinates);
    const YamlNode& reference_node = yaml_.Find(root, "reference_level_name");
    const std::string reference_name = yaml_.Text(reference_node, "'reference_level_name'", site_.levels[0].name);
    reference_ = FindLevel(reference_node, reference_name);
    if (yaml_.failed()) return;
    // Fiducials first: the map of a level needs the fiducials of the reference level, with y up.
    for (LevelPlan& plan : plans_) {
      for (SiteFiducial& fiducial : plan.fiducials) fiducial.position = frame * fiducial.position;
    }
    for (std::size_t i = 0; i < site_.levels.size(); ++i) {
      maps_.push_back(coordinates == SiteCoordinates::kReferenceImage ? MapOf(i) : PlaneMap());
      const PlaneMap& map = maps_.back();
      site_.levels[i].scale = map.scale;
      site_.levels[i].X_WF = {map.shift.x(), map.shift.y(), 0.0, Atan2(map.sin, map.cos)};
    }
    to_world_ = [this, frame](std::size_t level, const Vec2& p) { return Rounded(maps_[level] * (frame * p)); };
    for (std::size_t i = 0; i < site_.levels.size(); ++i) {
      for (SiteVertex& vertex : site_.levels[i].vertices) {
        vertex.position = to_world_(i, vertex.position);
        if (IsNear(vertex.position)) continue;
        return diagnostics_.Fail(vertex.where, "found a vertex beyond 1000 km, expected it nearer");
      }
      for (SiteWorkcell& workcell : site_.levels[i].workcells) {
        workcell.position = to_world_(i, workcell.position);
        if (IsNear(workcell.position)) continue;
        return diagnostics_.Fail(workcell.where, "found a model beyond 1000 km, expected it nearer");
      }
    }
    SeparateLevels();
  }

  PlaneMap MapOf(std::size_t level) {
    const SiteLevel& own = site_.levels[level];
    const std::optional<double> scale = ScaleOf(plans_[reference_]);
    const std::optional<double> own_scale = ScaleOf(plans_[level]);
    PlaneMap map;
    if (level != reference_) {
      if (const auto aligned = AlignLevel(plans_[reference_], scale.value_or(1.0), plans_[level])) return *aligned;
      diagnostics_.Warn(own.where, "found no two fiducials that level " + Quoted(own.name) +
                                       " has in common with level " + Quoted(site_.levels[reference_].name) +
                                       ", expected them; the corners of the drawings are at one place");
    }
    if (!own_scale && (level == reference_ || !scale)) {
      diagnostics_.Warn(own.where, "found no measurement on level " + Quoted(own.name) +
                                       ", expected one; a pixel of its drawing is 1 m");
    }
    map.scale = own_scale.value_or(scale.value_or(1.0));
    return map;
  }

  // Levels share x and y, so that their heights must not overlap.
  void SeparateLevels() {
    std::vector<SiteLevel*> by_height;
    for (SiteLevel& level : site_.levels) by_height.push_back(&level);
    std::stable_sort(by_height.begin(), by_height.end(),
                     [](const SiteLevel* a, const SiteLevel* b) { return a->elevation < b->elevation; });
    for (std::size_t i = 1; i < by_height.size(); ++i) {
      const double least = by_height[i - 1]->elevation + kMinStorey;
      if (by_height[i]->elevation >= least) continue;
      diagnostics_.Warn(by_height[i]->where, "found level " + Quoted(by_height[i]->name) + " at an elevation of " +
                                                 NumberText(by_height[i]->elevation) + " m, expected at least " +
                                                 NumberText(least) + " m, above level " +
                                                 Quoted(by_height[i - 1]->name) + "; that is used");
      // Changed in place: the next level is compared with the corrected height.
      by_height[i]->elevation = least;
    }
  }

  std::size_t FindLevel(const YamlNode& node, const std::string& name) {
    std::vector<std::string> names;
    for (std::size_t i = 0; i < site_.levels.size(); ++i) {
      if (site_.levels[i].name == name) return i;
      names.push_back(site_.levels[i].name);
    }
    yaml_.Fail(node, "found no level " + Quoted(name) + ", expected the name of one" + DidYouMean(name, names));
    return 0;
  }

  void ReadLift(const std::string& name, const YamlNode& node) {
    SiteLift lift;
    lift.name = name;
    lift.where = yaml_.At(node);
    const std::string of = "lift " + Quoted(name);
    const auto number = [&](const YamlNode& map, const char* key, double least) {
      return yaml_.Number(yaml_.Require(map, key, of), Quoted(key) + " of " + of, 0.0, least);
    };
    const auto level = [&](const char* key, std::size_t otherwise) {
      const YamlNode& found = yaml_.Find(node, key);
      const std::string text = yaml_.Text(found, Quoted(key) + " of " + of);
      return text.empty() ? otherwise : FindLevel(found, text);
    };
    constexpr double kMinSide = 0.2;  // m
    lift.width = number(node, "width", kMinSide);
    lift.depth = number(node, "depth", kMinSide);
    lift.is_operated = yaml_.Flag(yaml_.Find(node, "plugins"), "'plugins' of " + of, true);
    const Vec2 raw(number(node, "x", -kMaxMagnitude), number(node, "y", -kMaxMagnitude));
    const double heading = WrapAngle(number(node, "yaw", -1e3));
    std::map<std::string, std::size_t> numbers;
    yaml_.ForEachEntry(yaml_.Find(node, "doors"), "the doors of " + of,
                       [&](const std::string& door, const YamlNode& at) {
                         numbers.emplace(door, lift.doors.size());
                         const Vec2 position(number(at, "x", -kMaxMagnitude), number(at, "y", -kMaxMagnitude));
                         const double along =
                             yaml_.Number(yaml_.Find(at, "motion_axis_orientation"), "'motion_axis_orientation'", 0.0);
                         lift.doors.push_back({door, position, along, number(at, "width", 0.0)});
                       });
    lift.doors_at.resize(site_.levels.size());
    std::optional<std::size_t> first;
    yaml_.ForEachEntry(yaml_.Find(node, "level_doors"), "the level_doors of " + of,
                       [&](const std::string& level_name, const YamlNode& names) {
                         const std::size_t stop = FindLevel(names, level_name);
                         if (!first) first = stop;
                         yaml_.ForEachItem(names, "the level_doors of " + of, [&](const YamlNode& door) {
                           const auto found = numbers.find(yaml_.Text(door, "a door of " + of));
                           if (found != numbers.end()) return lift.doors_at[stop].push_back(found->second);
                           yaml_.Fail(door, "found no door of this name in " + of + ", expected one of its doors");
                         });
                       });
    lift.initial_level = level("initial_floor_name", first.value_or(reference_));
    const std::size_t drawn_on = level("reference_floor_name", reference_);
    if (yaml_.failed()) return;
    const Vec2 position = to_world_(drawn_on, raw);
    if (!IsNear(position)) return yaml_.Fail(node, "found a lift beyond 1000 km, expected it nearer");
    lift.X_WC = {position.x(), position.y(), site_.levels[lift.initial_level].elevation, heading};
    site_.lifts.push_back(std::move(lift));
  }

  Site site_;
  Diagnostics diagnostics_;
  YamlReader yaml_;
  std::size_t parts_ = 0;         // of the levels so far
  std::vector<LevelPlan> plans_;  // by level
  std::vector<PlaneMap> maps_;    // by level
  std::size_t reference_ = 0;     // level
  std::function<Vec2(std::size_t level, const Vec2& p)> to_world_;
  const YamlNode* first_model_ = nullptr;
  std::set<std::string> furniture_;  // kinds
};

}  // namespace

Result<Site> ReadBuildingText(const std::string& text, const std::string& path) {
  return BuildingReader(path).Read(text);
}

Result<Site> ReadBuilding(const std::string& path, const AllowedPaths& allowed) {
  const Result<std::string> text = ReadTextFile(path, {path}, allowed);
  if (!text.ok()) return text.error();
  return ReadBuildingText(text.value(), path);
}

}  // namespace troupe
