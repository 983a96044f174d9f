#include "worldfile/sites/site_tree.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "troupe/deterministic_math.h"
#include "troupe/rectangle.h"
#include "worldfile/sites/building_keys.h"
#include "worldfile/sites/building_yaml.h"
#include "worldfile/sites/floor_edges.h"
#include "worldfile/sites/lif_json.h"
#include "worldfile/sites/node_maker.h"
#include "worldfile/sites/route_graph.h"
#include "worldfile/sites/site_robots.h"
#include "worldfile/stage/stage_world.h"
#include "worldfile/text/text_file.h"

namespace troupe {
namespace {

// As in the worlds that Open-RMF generates; m.
constexpr double kWallHeight = 2.5;
constexpr double kWallThickness = 0.1;
constexpr double kFloorThickness = 0.1;
constexpr double kRailingHeight = 1.0;
constexpr double kRailingThickness = 0.05;
constexpr double kDoorHeight = 2.2;
constexpr double kDoorThickness = 0.03;
constexpr double kDoorSill = 0.01;  // below the leaves
constexpr double kCabinHeight = 2.5;
constexpr double kCabinThickness = 0.05;
constexpr double kShaftGap = 0.05;
constexpr double kCabinDoorInset = 0.025;

// Speeds of the joints in the worlds that Open-RMF generates; its doors and cabins reach them gently, ours at once.
constexpr double kSlidingSpeed = 0.2;  // m/s, of leaves
constexpr double kTurningSpeed = 0.5;  // rad/s, of leaves
constexpr double kCabinSpeed = 2.0;    // m/s

constexpr double kLaneWidth = 0.06;  // of the stripe that shows a lane
constexpr double kLaneHeight = 0.005;

struct SiteBlock {
  std::vector<Vec2> outline;
  double min_z = 0.0;
  double max_z = 0.0;
};

// A model whose blocks are in its parent's frame.
NodeMaker BlocksModel(const std::string& name, const std::vector<SiteBlock>& blocks, const std::string& color,
                      const SourceLocation& where, const std::string& type = "model") {
  NodeMaker model(type, where);
  Rectangle box = Rectangle::Nothing();
  double min_z = blocks.front().min_z;
  double max_z = blocks.front().max_z;
  for (const SiteBlock& block : blocks) {
    for (const Vec2& p : block.outline) box.Extend(p);
    min_z = std::min(min_z, block.min_z);
    max_z = std::max(max_z, block.max_z);
    NodeMaker node("block", where);
    node.Number("points", static_cast<double>(block.outline.size()));
    for (std::size_t i = 0; i < block.outline.size(); ++i) {
      node.Numbers("point[" + std::to_string(i) + "]", {block.outline[i].x(), block.outline[i].y()});
    }
    model.Child(node.Numbers("z", {block.min_z, block.max_z}).node);
  }
  // A model's blocks fill its size, so this is theirs.
  const Vec2 center = box.center();
  model.Text("name", name).Text("color", color).Numbers("pose", {center.x(), center.y(), 0.0, 0.0});
  return model.Numbers("size", {box.max_x - box.min_x, box.max_y - box.min_y, max_z - min_z});
}

// A model without a body of its own.
NodeMaker Group(const std::string& name, const Pose& pose, const SourceLocation& where) {
  NodeMaker group("model", where);
  return group.Text("name", name).At(pose).Number("noblocks", 1).Number("stack_children", 0);
}

// A rectangle along the line from `a` to `b`, longer by `extra` m at both ends.
std::vector<Vec2> Bar(const Vec2& a, const Vec2& b, double width, double extra) {
  const Vec2 along = (b - a).normalized();
  const Vec2 left = 0.5 * width * Vec2(-along.y(), along.x());
  const Vec2 from = a - extra * along;
  const Vec2 to = b + extra * along;
  return {from - left, to - left, to + left, from + left};
}

std::vector<Vec2> Box(double min_x, double min_y, double max_x, double max_y) {
  return {{min_x, min_y}, {max_x, min_y}, {max_x, max_y}, {min_x, max_y}};
}

// The door of a doorway of `width` m whose middle is at X_WD; its x axis points to its right leaf.
WorldNode DoorNode(const std::string& name, const Pose& X_WD, double width, double height, const DoorDraft& draft,
                   const SourceLocation& where) {
  NodeMaker door("door", where);
  door.Text("name", name).Text("color", "peru").At(X_WD).Numbers("size", {width, kDoorThickness, height});
  door.Numbers("origin", {0.0, 0.0, kDoorSill, 0.0});
  door.node.draft = std::make_shared<const PartDraft>(draft);
  return std::move(door.node);
}

class TreeMaker {
 public:
  TreeMaker(const Site& site, WorldTree& tree) : site_(site), tree_(tree) {}

  Status Make() {
    for (const SiteLevel& level : site_.levels) AddLevel(level);
    for (const SiteLift& lift : site_.lifts) AddLift(lift);
    for (const SiteLevel& level : site_.levels) {
      if (Status error = AddRobots(level); !error.ok()) return error;
    }
    return Status();
  }

 private:
  void Warn(const SourceLocation& where, const std::string& message) { tree_.warnings.push_back({where, message}); }
  void AddToWorld(WorldNode node) { tree_.world.children.Add(std::move(node)); }

  static const Vec2& StartOf(const SiteLevel& level, const SiteEdge& edge) {
    return level.vertices[edge.start].position;
  }
  static const Vec2& EndOf(const SiteLevel& level, const SiteEdge& edge) { return level.vertices[edge.end].position; }

  // False, with a warning, for an edge from a place to itself.
  bool HasLength(const SiteLevel& level, const SiteEdge& edge, const char* what) {
    if ((EndOf(level, edge) - StartOf(level, edge)).norm() > 1e-6) return true;
    Warn(edge.where, "found a " + std::string(what) + " without length, expected two places; it is left out");
    return false;
  }

  void AddLevel(const SiteLevel& level) {
    NodeMaker group = Group(level.name, {0.0, 0.0, level.elevation, 0.0}, level.where);
    std::vector<SiteBlock> walls;
    for (const SiteEdge& wall : level.walls) {
      if (!HasLength(level, wall, "wall")) continue;
      walls.push_back(
          {Bar(StartOf(level, wall), EndOf(level, wall), kWallThickness, 0.5 * kWallThickness), 0.0, kWallHeight});
    }
    std::vector<SiteBlock> floors;
    for (const SiteFloor& floor : level.floors) {
      Polygon outline;
      for (const std::size_t vertex : floor.vertices) outline.push_back(level.vertices[vertex].position);
      const Result<Polygon> normalized = Normalized(std::move(outline));
      if (normalized.ok()) {
        floors.push_back({normalized.value(), -kFloorThickness, 0.0});
      } else {
        Warn(floor.where,
             "found a floor that is no simple polygon: " + normalized.error().message + "; it is left out");
      }
    }
    if (!floors.empty()) group.Child(BlocksModel("floors", floors, "gray90", level.where).node);
    AddRailings(level, group);
    AddLanes(level, group);
    if (!walls.empty()) group.Child(BlocksModel("walls", walls, "gray40", level.where).node);
    AddToWorld(std::move(group.node));
    for (const SiteDoor& door : level.doors) {
      if (!HasLength(level, door.edge, "door")) continue;
      AddDoor(level, door);
    }
  }

  // Beside the edges of floors over a void: bodies stop there, rays pass.
  void AddRailings(const SiteLevel& level, NodeMaker& group) {
    std::vector<SiteBlock> railings;
    double length = 0.0;  // m
    for (const FloorEdge& edge : FindFloorEdges(site_, level)) {
      const Vec2 way = edge.to - edge.from;
      const Vec2 outwards = kRailingThickness / way.norm() * Vec2(way.y(), -way.x());
      railings.push_back({{edge.from + outwards, edge.to + outwards, edge.to, edge.from}, 0.0, kRailingHeight});
      length += way.norm();
    }
    if (railings.empty()) return;
    group.Child(BlocksModel("railings", railings, "gray60", level.where).Number("ranger_return", -1).node);
    Warn(level.where, "found " + NumberText(std::round(10.0 * length) / 10.0) + " m of edges of the floors of level " +
                          Quoted(level.name) + " without a wall; robots and people stop there");
  }

  // Stripes on the floor, which nothing hits.
  void AddLanes(const SiteLevel& level, NodeMaker& group) {
    const char* const kColors[] = {"RoyalBlue", "OrangeRed", "SeaGreen", "DarkViolet", "goldenrod", "DeepPink"};
    std::map<std::uint32_t, std::vector<SiteBlock>> graphs;
    for (const SiteLane& lane : level.lanes) {
      if (!HasLength(level, lane.edge, "lane")) continue;
      graphs[lane.graph].push_back(
          {Bar(StartOf(level, lane.edge), EndOf(level, lane.edge), kLaneWidth, 0.0), 0.0, kLaneHeight});
    }
    for (const auto& [graph, stripes] : graphs) {
      NodeMaker lanes =
          BlocksModel("lanes_" + std::to_string(graph), stripes, kColors[graph % std::size(kColors)], level.where);
      group.Child(lanes.Number("obstacle_return", 0).Number("ranger_return", -1).node);
    }
  }

  // Doors that nothing operates are closed; the others stand open until they are.
  void AddDoor(const SiteLevel& level, const SiteDoor& door) {
    const Vec2& start = StartOf(level, door.edge);
    const Vec2& end = EndOf(level, door.edge);
    const Vec2 middle = 0.5 * (start + end);
    const Pose X_WD{middle.x(), middle.y(), level.elevation, Atan2(start.y() - end.y(), start.x() - end.x())};
    // The direction is that in which the leaf turns about its own hinge, as traffic_editor draws it; a positive swing
    // is clockwise for a right leaf and counter-clockwise for a left one.
    const bool is_left_leaf = door.kind == DoorKind::kHinged && door.hinge_at_end;
    const bool turns = door.kind == DoorKind::kHinged || door.kind == DoorKind::kDoubleHinged;
    const DoorDraft draft{.kind = door.kind,
                          .at_left = door.hinge_at_end,
                          .swing = door.opens_clockwise != is_left_leaf ? door.swing : -door.swing,
                          .ratio = door.right_left_ratio,
                          .opening = door.is_operated ? 1.0 : 0.0,
                          .is_operated = door.is_operated,
                          .speed = turns ? kTurningSpeed : kSlidingSpeed};
    AddToWorld(DoorNode(DoorName(level, door), X_WD, (end - start).norm(), kDoorHeight, draft, door.edge.where));
  }

  // A side of the cabin: its doors' intervals leave parts of the wall.
  struct CabinSide {
    bool along_x = true;
    double outside = 0.0;                         // of the other coordinate, m, frame C
    std::vector<std::pair<double, double>> gaps;  // m, along the side
  };

  void AddLift(const SiteLift& lift) {
    const double w = 0.5 * lift.width;
    const double d = 0.5 * lift.depth;
    CabinSide sides[] = {{true, d, {}}, {true, -d, {}}, {false, -w, {}}, {false, w, {}}};
    for (std::size_t i = 0; i < lift.doors.size(); ++i) AddLiftDoor(lift, i, sides);
    std::vector<SiteBlock> blocks{{Box(-w, -d, w, d), -kCabinThickness, 0.0}};
    for (CabinSide& side : sides) {
      std::sort(side.gaps.begin(), side.gaps.end());
      const double half = side.along_x ? w : d - kCabinThickness;
      // A gap of width 0 at the end of the side, which closes the last piece of wall.
      side.gaps.push_back({half, half});
      const double inside = side.outside - std::copysign(kCabinThickness, side.outside);
      const double low = std::min(side.outside, inside);
      const double high = std::max(side.outside, inside);
      double from = -half;
      for (const auto& [begin, end] : side.gaps) {
        const double to = std::min(begin, half);
        if (to - from > 1e-3) {
          blocks.push_back({side.along_x ? Box(from, low, to, high) : Box(low, from, high, to), 0.0, kCabinHeight});
        }
        from = std::max(from, end);
      }
    }
    NodeMaker cabin = BlocksModel(lift.name, blocks, "LightSteelBlue", lift.where, "lift");
    cabin.At(lift.X_WC);
    // One that nothing operates has only the floor at which it stands.
    LiftDraft draft;
    draft.speed = kCabinSpeed;
    for (const SiteLiftDoor& door : lift.doors) draft.cabin_doors.push_back(CabinDoorName(lift, door));
    for (std::size_t i = 0; i < site_.levels.size(); ++i) {
      if (i != lift.initial_level && (lift.doors_at[i].empty() || !lift.is_operated)) continue;
      LiftDraft::Floor& floor = draft.floors.emplace_back();
      floor.name = site_.levels[i].name;
      floor.z = site_.levels[i].elevation;
      if (!lift.is_operated) continue;
      for (const std::size_t door : lift.doors_at[i]) {
        floor.doors.push_back(CabinDoorName(lift, lift.doors[door]));
        floor.doors.push_back(ShaftDoorName(lift, site_.levels[i], lift.doors[door]));
      }
    }
    cabin.node.draft = std::make_shared<const PartDraft>(std::move(draft));
    AddToWorld(std::move(cabin.node));
  }

  static std::string CabinDoorName(const SiteLift& lift, const SiteLiftDoor& door) {
    return "CabinDoor_" + lift.name + "_" + door.name;
  }
  static std::string ShaftDoorName(const SiteLift& lift, const SiteLevel& level, const SiteLiftDoor& door) {
    return "ShaftDoor_" + lift.name + "_" + level.name + "_" + door.name;
  }

  // The doors of the cabin and of the shaft, and the gap in the cabin's wall.
  void AddLiftDoor(const SiteLift& lift, std::size_t number, CabinSide (&sides)[4]) {
    const SiteLiftDoor& door = lift.doors[number];
    const double w = 0.5 * lift.width;
    const double d = 0.5 * lift.depth;
    const bool at_end_of_x = std::fabs(std::fabs(door.position.x()) - w) <= std::fabs(std::fabs(door.position.y()) - d);
    const double across = at_end_of_x ? door.position.x() : door.position.y();
    const double along = at_end_of_x ? door.position.y() : door.position.x();
    sides[at_end_of_x ? (across > 0.0 ? 3 : 2) : (across > 0.0 ? 0 : 1)].gaps.push_back(
        {along - 0.5 * door.width, along + 0.5 * door.width});
    // `outwards`: m from the cabin's wall
    const auto add = [&](const std::string& name, double outwards, const Pose& X_WC, bool is_open) {
      const double distance = std::copysign((at_end_of_x ? w : d) + outwards, across);
      const Pose X_CD{at_end_of_x ? distance : along, at_end_of_x ? along : distance, 0.0, WrapAngle(door.heading)};
      const Pose X_WD = X_WC * X_CD;
      const DoorDraft draft{.kind = DoorKind::kDoubleSliding,
                            .opening = is_open ? 1.0 : 0.0,
                            .is_operated = false,
                            .speed = kSlidingSpeed};
      AddToWorld(DoorNode(name, X_WD, door.width, kCabinHeight, draft, lift.where));
    };
    const auto opens_at = [&](std::size_t level) {
      return std::count(lift.doors_at[level].begin(), lift.doors_at[level].end(), number) > 0;
    };
    const bool is_open = lift.is_operated && opens_at(lift.initial_level);
    add(CabinDoorName(lift, door), -kCabinDoorInset, lift.X_WC, is_open);
    for (std::size_t i = 0; i < site_.levels.size(); ++i) {
      if (!opens_at(i)) continue;
      Pose X_WC = lift.X_WC;
      X_WC.z = site_.levels[i].elevation;
      add(ShaftDoorName(lift, site_.levels[i], door), kShaftGap, X_WC, is_open && i == lift.initial_level);
    }
  }

  // The define that the file's name of a robot model stands for: "TinyRobot" for "Open-RMF/TinyRobot".
  std::optional<std::string> DefineOf(const std::string& type) const {
    const auto lower = [](std::string text) {
      for (char& c : text) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
      return text;
    };
    const std::string wanted = lower(type.substr(type.rfind('/') + 1));
    for (const auto& [name, define] : tree_.defines) {
      if (define.base == "position" && lower(name) == wanted) return name;
    }
    return std::nullopt;
  }

  Status AddRobots(const SiteLevel& level) {
    const std::vector<double> headings = LaneHeadings(level);
    for (std::size_t i = 0; i < level.vertices.size(); ++i) {
      const SiteVertex& vertex = level.vertices[i];
      if (vertex.robot_type.empty()) continue;
      const std::optional<std::string> define = DefineOf(vertex.robot_type);
      if (!define && !unknown_robots_[vertex.robot_type]) {
        unknown_robots_[vertex.robot_type] = true;
        Warn(vertex.where, "found the robot model " + Quoted(vertex.robot_type) +
                               ", which is not known; a box of 0.6 m, 'SiteRobot', is used");
      }
      Result<WorldNode> robot = Instantiate(tree_, define.value_or("SiteRobot"), vertex.where);
      if (!robot.ok()) return robot.error();
      NodeMaker maker("position", vertex.where);
      maker.node = std::move(robot).value();
      maker.Text("name", vertex.robot_name.empty() ? vertex.robot_type : vertex.robot_name);
      maker.At({vertex.position.x(), vertex.position.y(), level.elevation, headings[i]});
      AddToWorld(std::move(maker.node));
    }
    return Status();
  }

  // By vertex, rad: along its first lane; 0 without one.
  static std::vector<double> LaneHeadings(const SiteLevel& level) {
    std::vector<double> headings(level.vertices.size(), 0.0);
    // Backwards, so that the first lane of a vertex is the one that stays.
    for (auto lane = level.lanes.rbegin(); lane != level.lanes.rend(); ++lane) {
      const Vec2 along = EndOf(level, lane->edge) - StartOf(level, lane->edge);
      const double heading = WrapAngle(Atan2(along.y(), along.x()) + (lane->orientation == "backward" ? kPi : 0.0));
      headings[lane->edge.start] = headings[lane->edge.end] = heading;
    }
    return headings;
  }

  const Site& site_;
  WorldTree& tree_;
  std::map<std::string, bool> unknown_robots_;  // the models that a warning has named
};

// What a vertex is for.
std::vector<std::string> RolesOf(const SiteVertex& vertex) {
  std::vector<std::string> roles;
  const auto add = [&](bool is, const std::string& role) {
    if (is) roles.push_back(role);
  };
  add(vertex.is_charger, "charger");
  add(vertex.is_parking_spot, "parking_spot");
  add(vertex.is_holding_point, "holding_point");
  add(vertex.is_cleaning_zone, "cleaning_zone");
  add(vertex.is_passthrough_point, "passthrough_point");
  add(!vertex.dock.empty(), "dock:" + vertex.dock);
  add(!vertex.lift_cabin.empty(), "lift:" + vertex.lift_cabin);
  add(!vertex.pickup_dispenser.empty(), "dispenser:" + vertex.pickup_dispenser);
  add(!vertex.dropoff_ingestor.empty(), "ingestor:" + vertex.dropoff_ingestor);
  add(!vertex.human_goal_set.empty(), "people:" + vertex.human_goal_set);
  add(!vertex.robot_name.empty(), "robot:" + vertex.robot_name);
  add(!vertex.robot_name.empty(), "fleet:" + vertex.robot_type.substr(vertex.robot_type.rfind('/') + 1));
  return roles;
}

}  // namespace

Result<WorldTree> SiteTree(std::shared_ptr<const Site> site) {
  WorldTree made;
  made.world.type = "world";
  made.world.where = {site->file, 1, 1};
  made.defines = SiteRobots(made.world.where);
  made.files = {site->file};
  made.directory = DirectoryOf(site->file);
  made.warnings = site->warnings;
  made.world.Set({"name", {site->name, made.world.where}, made.world.where});
  if (Status error = TreeMaker(*site, made).Make(); !error.ok()) return error.error();
  made.site = std::move(site);
  return made;
}

Result<WorldTree> ReadSiteTree(const std::string& path, const AllowedPaths& allowed) {
  Result<Site> site = IsBuildingPath(path)     ? ReadBuilding(path, allowed)
                      : IsRouteGraphPath(path) ? ReadRouteGraph(path, allowed)
                                               : ReadLayout(path, allowed);
  if (!site.ok()) return site.error();
  return SiteTree(std::make_shared<const Site>(std::move(site).value()));
}

std::string DoorName(const SiteLevel& level, const SiteDoor& door) {
  return door.name.empty() ? level.name + "_door" : door.name;
}

std::vector<std::vector<std::string>> PlaceNames(const Site& site) {
  std::vector<std::vector<std::string>> names;
  FreeNames free_names;
  for (const SiteLevel& level : site.levels) {
    std::vector<std::string>& of_level = names.emplace_back(level.vertices.size());
    for (std::size_t i = 0; i < level.vertices.size(); ++i) {
      const SiteVertex& vertex = level.vertices[i];
      if (vertex.name.empty() && RolesOf(vertex).empty()) continue;
      of_level[i] = free_names.Add(vertex.name.empty() ? level.name + "." + std::to_string(i) : vertex.name);
    }
  }
  return names;
}

std::vector<NamedPlace> PlacesOf(const Site& site) {
  std::vector<NamedPlace> places;
  const std::vector<std::vector<std::string>> names = PlaceNames(site);
  FreeNames free_names;
  for (std::size_t l = 0; l < site.levels.size(); ++l) {
    const SiteLevel& level = site.levels[l];
    for (std::size_t i = 0; i < level.vertices.size(); ++i) {
      if (names[l][i].empty()) continue;
      const SiteVertex& vertex = level.vertices[i];
      NamedPlace place;
      place.tags = RolesOf(vertex);
      place.name = names[l][i];
      place.tags.insert(place.tags.begin(), level.name);
      place.X_WN = {vertex.position.x(), vertex.position.y(), level.elevation, 0.0};
      places.push_back(std::move(place));
      free_names.Add(names[l][i]);
    }
  }
  for (const SiteLevel& level : site.levels) {
    for (const SiteWorkcell& workcell : level.workcells) {
      NamedPlace place;
      place.name = free_names.Add(workcell.name);
      place.tags = {level.name, (workcell.dispenses ? "dispenser:" : "ingestor:") + workcell.name};
      place.X_WN = {workcell.position.x(), workcell.position.y(), level.elevation + workcell.height, 0.0};
      places.push_back(std::move(place));
    }
  }
  return places;
}

}  // namespace troupe
