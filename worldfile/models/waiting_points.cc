#include "worldfile/models/waiting_points.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "common/base/json_reader.h"
#include "common/spatial/convex_piece.h"
#include "common/traffic/traffic_graph.h"
#include "worldfile/models/robot_outlines.h"

namespace troupe {
namespace {

constexpr double kSpare = 0.05;      // m, beside the distance that two robots keep
constexpr double kDoorHeight = 2.0;  // m above a lane: leaves that begin higher are in no way
constexpr int kOpenings = 4;         // between those at which a leaf is looked at

// The parts of all leaves at some of their openings, in W.
std::vector<ConvexPiece> PiecesOfDoors(const WorldDescription& world) {
  std::vector<ConvexPiece> pieces;
  for (const DoorDescription& door : world.doors) {
    for (const DoorLeaf& leaf : door.leaves) {
      const ModelId model = world.objects[leaf.object.index()];
      for (int i = 0; i <= kOpenings; ++i) {
        for (ConvexPiece& piece : MakePieces(world, model, leaf.X_WH_at(static_cast<double>(i) / kOpenings))) {
          if (piece.obstacle) pieces.push_back(std::move(piece));
        }
      }
    }
  }
  return pieces;
}

// m, by graph: of the largest robot that takes part on it; 0 without one.
std::vector<double> RadiiOnGraphs(const WorldDescription& world) {
  std::vector<double> radii(world.lane_graphs.size(), 0.0);
  std::vector<RobotOutline> outlines;
  for (std::size_t i = 0; i < world.robots.size(); ++i) {
    const ControllerDescription& controller = world.robots[i].controller;
    if (controller.name != "lanes") continue;
    bool is_planned = true;
    std::optional<std::uint32_t> number;
    const JsonReader parameters = JsonReader::OfText(controller.parameters);
    parameters.Read("planned", is_planned);
    parameters.Read("graph", number);
    if (!is_planned || !parameters.ok()) continue;
    const LaneGraph* const graph = number ? FindGraph(world.lane_graphs, *number)
                                          : GraphAt(world.lane_graphs, world.model(world.robots[i].root).X_PM);
    if (graph == nullptr) continue;
    if (outlines.empty()) outlines = OutlinesOfRobots(world);
    double& radius = radii[static_cast<std::size_t>(graph - world.lane_graphs.data())];
    radius = std::max(radius, outlines[i].radius);
  }
  return radii;
}

class LaneCutter {
 public:
  // `apart`: m, that the vertices of a graph are from each other; half of it, from leaves.
  LaneCutter(LaneGraph& graph, double apart, std::vector<ConvexPiece> leaves)
      : graph_(graph), apart_(apart), leaves_(std::move(leaves)), count_(graph.vertices.size()) {}

  void CutAll() {
    const std::size_t lanes = graph_.lanes.size();
    for (std::size_t i = 0; i < lanes; ++i) Cut(i);
  }

 private:
  // The first part remains in the place of the lane; the others follow all lanes.
  void Cut(std::size_t number) {
    const Lane whole = graph_.lanes[number];
    const LaneVertex start = graph_.vertices[whole.start];
    const LaneVertex end = graph_.vertices[whole.end];
    if (!whole.mutex.empty() || start.lift || end.lift || start.z != end.z) return;
    const Vec2 way = end.position - start.position;
    const double length = way.norm();
    const auto parts = static_cast<std::size_t>(std::floor(length / apart_));
    Part last{whole.start, 0.0, number};
    for (std::size_t i = 1; i < parts; ++i) {
      const double share = static_cast<double>(i) / static_cast<double>(parts);
      const Vec2 point = start.position + share * way;
      if (!IsFree(point, start.z, whole)) continue;
      const auto vertex = static_cast<std::uint32_t>(graph_.vertices.size());
      graph_.vertices.push_back(
          {.name = "", .position = point, .z = start.z, .dock = "", .mutex = "", .is_between = true});
      End(last, vertex, share * length, whole);
      last = {vertex, share * length, graph_.lanes.size()};
      graph_.lanes.push_back(whole);
    }
    End(last, whole.end, length + 1.0, whole);
  }

  struct Part {
    std::uint32_t start = 0;
    double at = 0.0;  // m along the whole lane
    std::size_t lane = 0;
  };

  void End(const Part& part, std::uint32_t vertex, double at, const Lane& whole) {
    Lane& lane = graph_.lanes[part.lane];
    lane.start = part.start;
    lane.end = vertex;
    lane.doors.clear();
    for (const LaneDoor& door : whole.doors) {
      if (door.at >= part.at && door.at < at) lane.doors.push_back({door.door, door.at - part.at});
    }
  }

  bool IsFree(const Vec2& point, double z, const Lane& lane) const {
    for (std::size_t i = 0; i < count_; ++i) {
      const LaneVertex& vertex = graph_.vertices[i];
      if (i == lane.start || i == lane.end || std::fabs(vertex.z - z) >= kLevelGap) continue;
      if ((vertex.position - point).norm() < apart_) return false;
    }
    const ZRange height{z, z + kDoorHeight};
    return std::none_of(leaves_.begin(), leaves_.end(), [&](const ConvexPiece& leaf) {
      return leaf.z.Overlaps(height) && FindNearestPoints(std::span(&point, 1), leaf.vertices).distance < 0.5 * apart_;
    });
  }

  LaneGraph& graph_;
  const double apart_;
  const std::vector<ConvexPiece> leaves_;
  const std::size_t count_;  // of vertices of the site
};

}  // namespace

void AddWaitingPoints(WorldDescription& world) {
  if (world.lane_graphs.empty() || !world.lane_trips.empty()) return;
  const std::vector<double> radii = RadiiOnGraphs(world);
  for (std::size_t i = 0; i < radii.size(); ++i) {
    if (radii[i] > 0.0) AddWaitingPoints(world, i, radii[i]);
  }
}

void AddWaitingPoints(WorldDescription& world, std::size_t graph, double radius) {
  LaneCutter(world.lane_graphs[graph], 2.0 * (radius + kTrafficMargin) + kSpare, PiecesOfDoors(world)).CutAll();
}

}  // namespace troupe
