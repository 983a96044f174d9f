// TrafficGraph: all graphs of lanes of a world as one, with the relation that traffic is planned by: which vertices and
// lanes two bodies cannot be on at the same time.
//
// Two vertices or lanes conflict if they are on one level and nearer to each other than the radii of the robots of
// their graphs, or in one group: a mutex, or the cabin of a lift with its vertices on all floors. A body on a lane is
// anywhere on it, ends included; so lanes that share a vertex conflict. A ride of a lift is a lane, too, after those of
// the graphs.
//
// Vertices are numbered through all graphs, in their order, and so are lanes. A pure function of its arguments. Cost:
// linear in the lanes and their conflicts.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "troupe/site_description.h"

namespace troupe {

// m, beside the body of a robot: as a controller stops behind another robot, and not exactly at a vertex.
inline constexpr double kTrafficMargin = 0.2;

// A way out of a vertex.
struct TrafficExit {
  std::uint32_t to = 0;
  std::uint32_t lane = 0;
  double seconds = 0.0;  // of the way, at 1 m/s or the limit of the lane, with a time for doors and rides
};

class TrafficGraph {
 public:
  // `radii`: m, by graph: no part of a robot on it is farther from its origin.
  TrafficGraph(std::span<const LaneGraph> graphs, std::span<const double> radii);

  std::size_t vertices() const { return exits_.size(); }
  std::size_t lanes() const { return lanes_.size(); }
  std::uint32_t VertexOf(std::size_t graph, std::size_t vertex) const {
    return first_vertex_[graph] + static_cast<std::uint32_t>(vertex);
  }
  // The number among the vertices of its graph.
  std::uint32_t NumberOf(std::size_t graph, std::uint32_t vertex) const { return vertex - first_vertex_[graph]; }
  bool IsOf(std::size_t graph, std::uint32_t vertex) const {
    return vertex >= first_vertex_[graph] && vertex < first_vertex_[graph + 1];
  }
  // The number of a lane among those of its graph; kRide for a ride.
  static constexpr std::uint32_t kRide = 0xffffffff;
  std::uint32_t LaneNumberOf(std::size_t graph, std::uint32_t lane) const {
    return lane < first_lane_.back() ? lane - first_lane_[graph] : kRide;
  }

  std::span<const TrafficExit> exits(std::uint32_t vertex) const { return exits_[vertex]; }
  // The ways into a vertex: `to` is the vertex from which each comes.
  std::span<const TrafficExit> entries(std::uint32_t vertex) const { return entries_[vertex]; }
  // The ends of a lane.
  std::uint32_t start(std::uint32_t lane) const { return lanes_[lane].start; }
  std::uint32_t end(std::uint32_t lane) const { return lanes_[lane].end; }
  // s, as that of exits.
  double seconds(std::uint32_t lane) const { return lanes_[lane].seconds; }
  // Those that it conflicts with by their distance; ascending, itself included.
  std::span<const std::uint32_t> VerticesNearVertex(std::uint32_t vertex) const { return vertices_.at(vertex).near; }
  std::span<const std::uint32_t> VerticesNearLane(std::uint32_t lane) const { return lanes_[lane].near_vertices; }
  std::span<const std::uint32_t> LanesNearLane(std::uint32_t lane) const { return lanes_[lane].near_lanes; }
  // The direction of a way along a lane, to one of its ends; 0 to 2 * lanes() - 1.
  std::uint32_t DirectionOf(std::uint32_t lane, std::uint32_t to) const {
    return 2 * lane + (to == lanes_[lane].end ? 0 : 1);
  }
  // All that a move along a lane needs for itself: a robot at rest there keeps another one from it. Ascending. Robots
  // that are near to each other may move apart, on a way that leads straight away.
  struct Need {
    std::vector<std::uint32_t> vertices = {};
    std::vector<std::uint32_t> groups = {};
  };
  const Need& NeedOf(std::uint32_t lane, std::uint32_t to) const { return needs_[DirectionOf(lane, to)]; }
  // The directions of the moves that need a vertex, for itself or as one of a group; ascending.
  std::span<const std::uint32_t> DirectionsNeeding(std::uint32_t vertex) const { return needing_[vertex]; }
  // m along a lane, from which on a robot is clear of all that is near its start alone; infinity for a short lane.
  double leave_distance(std::uint32_t lane) const { return lanes_[lane].leave_distance; }
  // Those that conflict with the rest of a lane on the way `to` one of its ends; as above. REQUIRES: it can be left.
  std::span<const std::uint32_t> LanesNearRest(std::uint32_t lane, std::uint32_t to) const {
    return RestOf(lane, to).near_lanes;
  }
  std::span<const std::uint32_t> GroupsOfRest(std::uint32_t lane, std::uint32_t to) const {
    return RestOf(lane, to).groups;
  }
  // Groups that a body there has for itself; ascending, from 0 on.
  std::size_t groups() const { return group_count_; }
  std::span<const std::uint32_t> GroupsOfVertex(std::uint32_t vertex) const { return vertices_[vertex].groups; }
  std::span<const std::uint32_t> GroupsOfLane(std::uint32_t lane) const { return lanes_[lane].groups; }
  std::span<const std::uint32_t> VerticesOfGroup(std::uint32_t group) const { return vertices_of_groups_[group]; }
  // A vertex at which a body may wait without a group or a lift that others need.
  bool IsOpen(std::uint32_t vertex) const { return vertices_[vertex].groups.empty(); }

 private:
  struct Vertex {
    Vec2 position{0.0, 0.0};
    double z = 0.0;
    double radius = 0.0;
    std::vector<std::uint32_t> near = {};
    std::vector<std::uint32_t> groups = {};
  };
  // Of a lane that a robot has left the start of.
  struct Rest {
    std::vector<std::uint32_t> near_lanes = {};
    std::vector<std::uint32_t> groups = {};
  };
  struct Way {
    std::uint32_t start = 0;
    std::uint32_t end = 0;
    double seconds = 0.0;
    double leave_distance = std::numeric_limits<double>::infinity();
    Rest to_end = {};
    Rest to_start = {};
    std::vector<std::uint32_t> near_vertices = {};
    std::vector<std::uint32_t> near_lanes = {};
    std::vector<std::uint32_t> groups = {};
  };

  void AddRides(std::span<const LaneGraph> graphs);
  void AddWay(std::uint32_t start, std::uint32_t end, double seconds, bool is_bidirectional);
  void FindGroups(std::span<const LaneGraph> graphs);
  void FindConflicts(double radius);
  void FindNeeds();
  Need NeedBetween(std::uint32_t lane, std::uint32_t from, std::uint32_t to) const;
  bool LeadsAway(std::uint32_t from, std::uint32_t to, std::uint32_t vertex) const;
  const Rest& RestOf(std::uint32_t lane, std::uint32_t to) const {
    return to == lanes_[lane].end ? lanes_[lane].to_end : lanes_[lane].to_start;
  }

  std::vector<Vertex> vertices_;
  std::vector<Way> lanes_;
  std::vector<std::vector<TrafficExit>> exits_;    // by vertex
  std::vector<std::vector<TrafficExit>> entries_;  // likewise
  std::vector<std::uint32_t> first_vertex_;        // by graph, and the end
  std::vector<std::uint32_t> first_lane_;          // likewise
  std::size_t group_count_ = 0;
  std::vector<std::vector<std::uint32_t>> vertices_of_groups_;
  std::vector<Need> needs_;                          // by direction
  std::vector<std::vector<std::uint32_t>> needing_;  // by vertex, directions
};

}  // namespace troupe
