#include "ros/messages/convert_world.h"

#include <algorithm>
#include <map>

#include "ros/messages/convert.h"
#include "ros/messages/names.h"

namespace troupe::ros {
namespace {

constexpr std::int32_t kTriangleList = 11;
constexpr std::int32_t kDeleteAll = 3;  // as a marker's action
constexpr std::int8_t kOccupied = 100;
constexpr std::int8_t kFree = 0;

using PointMessage = geometry_msgs_msg_dds__Point_;

// The corners of the triangles that bound a prism, counter-clockwise as seen from outside.
void AddPrism(const ConvexPiece& piece, std::vector<PointMessage>& points) {
  const std::vector<Vec2>& v = piece.vertices;
  const auto at = [&](std::size_t i, double z) { return PointMessage{v[i].x(), v[i].y(), z}; };
  const auto triangle = [&points](const PointMessage& a, const PointMessage& b, const PointMessage& c) {
    points.push_back(a);
    points.push_back(b);
    points.push_back(c);
  };
  const double low = piece.z.min;
  const double high = piece.z.max;
  for (std::size_t i = 1; i + 1 < v.size(); ++i) {
    triangle(at(0, high), at(i, high), at(i + 1, high));
    triangle(at(0, low), at(i + 1, low), at(i, low));
  }
  for (std::size_t i = 0; i < v.size(); ++i) {
    const std::size_t next = (i + 1) % v.size();
    triangle(at(i, low), at(next, low), at(next, high));
    triangle(at(i, low), at(next, high), at(i, high));
  }
}

// Markers of pieces, one for each model.
class Markers {
 public:
  Markers(const WorldDescription& world, const char* name_space) : world_(world), name_space_(name_space) {}

  // Call before Add: viewers apply markers in order.
  void DeleteOthers(dds::WireArena& arena) {
    Marker marker{};
    marker.header = MakeHeader({}, kMapFrame, arena);
    marker.ns = arena.Copy(name_space_);
    marker.action = kDeleteAll;
    markers_.push_back(marker);
  }

  // `pose`: of the pieces' own frame in `frame`. `follows`: the marker moves with the frame.
  void Add(const std::map<ModelId, std::vector<const ConvexPiece*>>& pieces_by_model, const std::string& frame,
           const Pose& pose, bool follows, dds::WireArena& arena) {
    for (const auto& [model, pieces] : pieces_by_model) {
      if (pieces.size() > kMaxMarkerPieces) continue;
      const Color& color = world_.model(model).color;
      Marker marker{};
      marker.header = MakeHeader({}, frame, arena);
      marker.ns = arena.Copy(name_space_);
      marker.id = static_cast<std::int32_t>(model.index());
      marker.type = kTriangleList;
      marker.pose = ToMessage(pose);
      marker.scale = {1.0, 1.0, 1.0};
      marker.color = {static_cast<float>(color.r), static_cast<float>(color.g), static_cast<float>(color.b),
                      static_cast<float>(color.a)};
      marker.frame_locked = follows;
      std::vector<PointMessage> points;
      for (const ConvexPiece* piece : pieces) AddPrism(*piece, points);
      std::copy(points.begin(), points.end(), arena.Fill(marker.points, points.size()));
      markers_.push_back(marker);
    }
  }

  MarkerArray Message(dds::WireArena& arena) const {
    MarkerArray message{};
    std::copy(markers_.begin(), markers_.end(), arena.Fill(message.markers, markers_.size()));
    return message;
  }

 private:
  const WorldDescription& world_;
  const char* name_space_;
  std::vector<Marker> markers_;
};

std::map<ModelId, std::vector<const ConvexPiece*>> ByModel(const std::vector<ConvexPiece>& pieces) {
  std::map<ModelId, std::vector<const ConvexPiece*>> by_model;
  for (const ConvexPiece& piece : pieces) by_model[piece.model].push_back(&piece);
  return by_model;
}

}  // namespace

OccupancyGridMessage MakeMap(const OccupancyGrid& grid, dds::WireArena& arena) {
  OccupancyGridMessage message{};
  message.header = MakeHeader({}, kMapFrame, arena);
  message.info.resolution = static_cast<float>(grid.resolution);
  message.info.width = grid.width;
  message.info.height = grid.height;
  message.info.origin = ToMessage(Pose{grid.origin_x, grid.origin_y, 0.0, 0.0});
  std::int8_t* cell = arena.Fill(message.data, grid.occupied.size());
  for (const bool occupied : grid.occupied) *cell++ = occupied ? kOccupied : kFree;
  return message;
}

MarkerArray MakeBlockMarkers(const Scene& scene, const std::vector<std::vector<std::string>>& robot_frames,
                             dds::WireArena& arena, bool replaces) {
  Markers markers(scene.world(), "blocks");
  if (replaces) markers.DeleteOthers(arena);
  markers.Add(ByModel(scene.static_index().kept_pieces()), kMapFrame, {}, false, arena);
  for (std::size_t i = 0; i < robot_frames.size(); ++i) {
    if (robot_frames[i].empty()) continue;
    const Body& body = scene.body(scene.body_of(RobotId(i)));
    std::vector<std::vector<ConvexPiece>> pieces(body.links.size());
    for (std::size_t k = 0; k < body.pieces.size(); ++k) pieces[body.piece_links[k]].push_back(body.pieces[k]);
    for (std::size_t k = 0; k < pieces.size(); ++k)
      markers.Add(ByModel(pieces[k]), robot_frames[i][k], {}, true, arena);
  }
  return markers.Message(arena);
}

MarkerArray MakeObjectMarkers(const Scene& scene, const WorldState& state, dds::WireArena& arena, bool replaces) {
  Markers markers(scene.world(), "objects");
  if (replaces) markers.DeleteOthers(arena);
  for (std::size_t i = 0; i < state.objects.size(); ++i) {
    markers.Add(ByModel(scene.body(scene.body_of(ObjectId(i))).pieces), kMapFrame, state.objects[i].X_WO, false, arena);
  }
  return markers.Message(arena);
}

}  // namespace troupe::ros
