#include "world-service/observers/ros/building_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <system_error>
#include <vector>

#include "common/base/file.h"
#include "common/base/text.h"
#include "common/image/image_file.h"
#include "troupe/pose.h"

namespace troupe::ros {
namespace {

using AffineImage = rmf_building_map_msgs_msg_dds__AffineImage_;
using DoorMessage = rmf_building_map_msgs_msg_dds__Door_;
using GraphMessage = rmf_building_map_msgs_msg_dds__Graph_;
using LevelMessage = rmf_building_map_msgs_msg_dds__Level_;
using LiftMessage = rmf_building_map_msgs_msg_dds__Lift_;
using ParamMessage = rmf_building_map_msgs_msg_dds__Param_;

constexpr std::size_t kMaxShown = 200;  // bytes of a name or a reason in a line
constexpr std::size_t kGraphs = 9;      // as many as Open-RMF's own map server has

enum class ParamType : std::uint32_t { kString = 1, kDouble = 3, kBool = 4 };
enum class EdgeType : std::uint8_t { kBothWays = 0, kOneWay = 1 };

std::uint8_t TypeOf(DoorKind kind) {
  switch (kind) {
    case DoorKind::kSliding:
      return 1;
    case DoorKind::kDoubleSliding:
      return 2;
    case DoorKind::kHinged:
      return 5;
    case DoorKind::kDoubleHinged:
      break;
  }
  return 6;
}
constexpr std::uint8_t kDoubleSliding = 2;
constexpr float kRangeOfLiftDoors = 1.571F;  // as Open-RMF's own map server has it

std::filesystem::path FolderOf(const Site& site) {
  return std::filesystem::absolute(site.file).parent_path();
}

class Maker {
 public:
  Maker(const Site& site, const AllowedPaths& files, dds::WireArena& arena, std::vector<std::string>& left_out)
      : site_(site), files_(files), arena_(arena), left_out_(left_out) {}

  LevelMessage MakeLevel(const SiteLevel& level) {
    LevelMessage message{};
    message.name = arena_.Copy(level.name);
    message.elevation = static_cast<float>(level.elevation);
    AddImage(level, message);
    AddPlaces(level, message);
    auto* door = arena_.Fill(message.doors, level.doors.size());
    for (const SiteDoor& each : level.doors) *door++ = MakeDoor(level, each);
    std::map<std::uint32_t, std::vector<const SiteLane*>> graphs;
    for (const SiteLane& lane : level.lanes) {
      if (lane.graph < kGraphs) graphs[lane.graph].push_back(&lane);
    }
    auto* graph = arena_.Fill(message.nav_graphs, graphs.size());
    for (const auto& [number, lanes] : graphs) *graph++ = MakeLanes(level, std::to_string(number), lanes);
    message.wall_graph = MakeWalls(level);
    return message;
  }

  LiftMessage MakeLift(const SiteLift& lift) {
    LiftMessage message{};
    message.name = arena_.Copy(lift.name);
    std::vector<std::string> levels;
    for (std::size_t i = 0; i < site_.levels.size(); ++i) {
      if (!lift.doors_at[i].empty()) levels.push_back(site_.levels[i].name);
    }
    arena_.FillStrings(message.levels, levels);
    auto* door = arena_.Fill(message.doors, lift.doors.size());
    for (const SiteLiftDoor& each : lift.doors) {
      const Pose X_WD = lift.X_WC * Pose{each.position.x(), each.position.y(), 0.0, each.heading};
      const Vec2 half = Transform2(X_WD).Rotate({0.5 * each.width, 0.0});
      *door = DoorBetween(each.name, X_WD.translation() - half, X_WD.translation() + half);
      door->door_type = kDoubleSliding;
      door->motion_range = kRangeOfLiftDoors;
      door->motion_direction = -1;
      ++door;
    }
    message.wall_graph.name = arena_.Copy("");
    message.ref_x = static_cast<float>(lift.X_WC.x);
    message.ref_y = static_cast<float>(lift.X_WC.y);
    message.ref_yaw = static_cast<float>(lift.X_WC.heading);
    message.width = static_cast<float>(lift.width);
    message.depth = static_cast<float>(lift.depth);
    return message;
  }

 private:
  // Empty if the level has none.
  Result<std::string> ReadDrawing(const SiteLevel& level) const {
    if (level.drawing.empty()) return std::string();
    const std::string named = (FolderOf(site_) / level.drawing).string();
    const std::optional<std::string> path = files_.Resolve(named);
    if (!path) {
      return Error{
          {},
          fmt::format("found {}, expected a file below the folder of the building or one that the owner of the "
                      "run has allowed (--allow-files)",
                      named)};
    }
    std::error_code missing;
    const std::uintmax_t size = std::filesystem::file_size(*path, missing);
    if (missing) return std::string();
    if (size > room_) {
      return Error{{}, fmt::format("{} has no room: all drawings may have {} MiB", named, kMaxDrawingBytes >> 20)};
    }
    if (const Result<Bitmap> picture = ReadBitmap(*path, StagePixelRule()); !picture.ok()) return picture.error();
    return ReadWholeFile(*path, room_);
  }

  void AddImage(const SiteLevel& level, LevelMessage& message) {
    const Result<std::string> bytes = ReadDrawing(level);
    if (!bytes.ok()) {
      left_out_.push_back(fmt::format("the drawing of level '{}': {}", PlainLine(level.name, kMaxShown),
                                      PlainLine(bytes.error().message, kMaxShown)));
    }
    if (!bytes.ok() || bytes.value().empty()) return;
    room_ -= bytes.value().size();
    AffineImage& image = *arena_.Fill(message.images, 1);
    const std::size_t dot = level.drawing.rfind('.');
    image.name = arena_.Copy(level.drawing.substr(0, level.drawing.find('.')));
    image.encoding = arena_.Copy(dot != std::string::npos ? level.drawing.substr(dot + 1) : "");
    image.x_offset = static_cast<float>(level.X_WF.x);
    image.y_offset = static_cast<float>(level.X_WF.y);
    image.yaw = static_cast<float>(level.X_WF.heading);
    image.scale = static_cast<float>(level.scale);
    auto* data = arena_.Fill(image.data, bytes.value().size());
    std::memcpy(data, bytes.value().data(), bytes.value().size());
  }

  void AddPlaces(const SiteLevel& level, LevelMessage& message) {
    const auto has_name = [](const SiteVertex& vertex) { return !vertex.name.empty(); };
    const auto count = std::count_if(level.vertices.begin(), level.vertices.end(), has_name);
    auto* place = arena_.Fill(message.places, static_cast<std::size_t>(count));
    for (const SiteVertex& vertex : level.vertices) {
      if (!has_name(vertex)) continue;
      place->name = arena_.Copy(vertex.name);
      place->x = static_cast<float>(vertex.position.x());
      place->y = static_cast<float>(vertex.position.y());
      ++place;
    }
  }

  DoorMessage DoorBetween(const std::string& name, const Vec2& start, const Vec2& end) {
    DoorMessage message{};
    message.name = arena_.Copy(name);
    message.v1_x = static_cast<float>(start.x());
    message.v1_y = static_cast<float>(start.y());
    message.v2_x = static_cast<float>(end.x());
    message.v2_y = static_cast<float>(end.y());
    return message;
  }

  DoorMessage MakeDoor(const SiteLevel& level, const SiteDoor& door) {
    DoorMessage message =
        DoorBetween(door.name, level.vertices[door.edge.start].position, level.vertices[door.edge.end].position);
    message.door_type = TypeOf(door.kind);
    message.motion_range = static_cast<float>(door.swing);
    message.motion_direction = door.opens_clockwise ? 1 : -1;
    return message;
  }

  ParamMessage Param(const char* name, ParamType type) {
    ParamMessage message{};
    message.name = arena_.Copy(name);
    message.type = static_cast<std::uint32_t>(type);
    message.value_string = arena_.Copy("");
    return message;
  }
  ParamMessage TextParam(const char* name, const std::string& value) {
    ParamMessage message = Param(name, ParamType::kString);
    message.value_string = arena_.Copy(value);
    return message;
  }

  std::vector<ParamMessage> ParamsOf(const SiteVertex& vertex) {
    std::vector<ParamMessage> params;
    const auto add_text = [&](const char* name, const std::string& value) {
      if (!value.empty()) params.push_back(TextParam(name, value));
    };
    const auto add_flag = [&](const char* name, bool value) {
      if (!value) return;
      params.push_back(Param(name, ParamType::kBool));
      params.back().value_bool = true;
    };
    add_text("dock_name", vertex.dock);
    add_text("pickup_dispenser", vertex.pickup_dispenser);
    add_text("dropoff_ingestor", vertex.dropoff_ingestor);
    add_flag("is_charger", vertex.is_charger);
    add_flag("is_cleaning_zone", vertex.is_cleaning_zone);
    add_flag("is_holding_point", vertex.is_holding_point);
    add_flag("is_parking_spot", vertex.is_parking_spot);
    return params;
  }

  template <typename Sequence>
  void Fill(Sequence& sequence, const std::vector<ParamMessage>& params) {
    std::copy(params.begin(), params.end(), arena_.Fill(sequence, params.size()));
  }

  // A graph of those vertices that have an edge, in their order, and their new numbers by the old ones.
  GraphMessage MakeGraph(const SiteLevel& level, const std::string& name, const std::vector<SiteEdge>& edges,
                         bool has_params, std::map<std::size_t, std::uint32_t>& numbers) {
    std::set<std::size_t> used;
    for (const SiteEdge& edge : edges) used.insert({edge.start, edge.end});
    GraphMessage message{};
    message.name = arena_.Copy(name);
    auto* node = arena_.Fill(message.vertices, used.size());
    for (const std::size_t vertex : used) {
      const auto number = static_cast<std::uint32_t>(numbers.size());
      numbers[vertex] = number;
      const SiteVertex& from = level.vertices[vertex];
      node->x = static_cast<float>(from.position.x());
      node->y = static_cast<float>(from.position.y());
      node->name = arena_.Copy(from.name);
      if (has_params) Fill(node->params, ParamsOf(from));
      ++node;
    }
    auto* out = arena_.Fill(message.edges, edges.size());
    for (const SiteEdge& edge : edges) {
      out->v1_idx = numbers.at(edge.start);
      out->v2_idx = numbers.at(edge.end);
      out->edge_type = static_cast<std::uint8_t>(EdgeType::kBothWays);
      ++out;
    }
    return message;
  }

  GraphMessage MakeLanes(const SiteLevel& level, const std::string& name, const std::vector<const SiteLane*>& lanes) {
    std::vector<SiteEdge> edges;
    for (const SiteLane* lane : lanes) edges.push_back(lane->edge);
    std::map<std::size_t, std::uint32_t> numbers;
    GraphMessage message = MakeGraph(level, name, edges, true, numbers);
    auto* edge = message.edges._buffer;
    for (const SiteLane* lane : lanes) {
      if (!lane->is_bidirectional) edge->edge_type = static_cast<std::uint8_t>(EdgeType::kOneWay);
      std::vector<ParamMessage> params;
      if (lane->speed_limit > 0.0) {
        params.push_back(Param("speed_limit", ParamType::kDouble));
        params.back().value_float = static_cast<float>(lane->speed_limit);
      }
      Fill(edge->params, params);
      ++edge;
    }
    return message;
  }

  GraphMessage MakeWalls(const SiteLevel& level) {
    std::map<std::size_t, std::uint32_t> numbers;
    return MakeGraph(level, "WallGraph", level.walls, false, numbers);
  }

  const Site& site_;
  const AllowedPaths& files_;
  dds::WireArena& arena_;
  std::vector<std::string>& left_out_;
  std::size_t room_ = kMaxDrawingBytes;
};

}  // namespace

BuildingMapMessage MakeBuildingMap(const Site& site, AllowedPaths files, dds::WireArena& arena,
                                   std::vector<std::string>& left_out) {
  files.Add(FolderOf(site).string());
  Maker maker(site, files, arena, left_out);
  BuildingMapMessage message{};
  message.name = arena.Copy(site.name);
  auto* level = arena.Fill(message.levels, site.levels.size());
  for (const SiteLevel& each : site.levels) *level++ = maker.MakeLevel(each);
  auto* lift = arena.Fill(message.lifts, site.lifts.size());
  for (const SiteLift& each : site.lifts) *lift++ = maker.MakeLift(each);
  return message;
}

}  // namespace troupe::ros
