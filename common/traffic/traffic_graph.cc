#include "common/traffic/traffic_graph.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string>
#include <utility>

#include "troupe/check.h"

namespace troupe {
namespace {

constexpr double kRideSeconds = 20.0;  // of a ride, beside 1 s for each m of height
constexpr double kDoorSeconds = 3.0;
constexpr double kLeaveMargin = 1e-3;  // m, beyond the distance at which a lane is clear of its start

struct Segment {
  Vec2 a{0.0, 0.0};
  Vec2 b{0.0, 0.0};
  double z = 0.0;
  double radius = 0.0;  // m, of the robots on it
};

double SquaredDistance(const Vec2& point, const Segment& segment) {
  const Vec2 way = segment.b - segment.a;
  const double squared = way.squaredNorm();
  const double at = squared > 0.0 ? std::clamp((point - segment.a).dot(way) / squared, 0.0, 1.0) : 0.0;
  return (segment.a + at * way - point).squaredNorm();
}

bool AreCrossing(const Segment& one, const Segment& two) {
  const auto sides = [](const Segment& line, const Segment& ends) {
    const Vec2 way = line.b - line.a;
    return Cross(way, ends.a - line.a) * Cross(way, ends.b - line.a);
  };
  return sides(one, two) < 0.0 && sides(two, one) < 0.0;
}

double SquaredDistance(const Segment& one, const Segment& two) {
  if (AreCrossing(one, two)) return 0.0;
  return std::min(std::min(SquaredDistance(one.a, two), SquaredDistance(one.b, two)),
                  std::min(SquaredDistance(two.a, one), SquaredDistance(two.b, one)));
}

// The cells of a grid that segments pass, so that only near ones are compared.
class Cells {
 public:
  explicit Cells(double size) : size_(size) {}

  void Add(std::uint32_t number, const Segment& segment) {
    ForEachCell(segment, [&](const Cell& cell) {
      std::vector<std::uint32_t>& numbers = numbers_[cell];
      if (numbers.empty() || numbers.back() != number) numbers.push_back(number);
    });
  }

  // Of the segments within half the size of a cell, ascending, with others.
  std::vector<std::uint32_t> Near(const Segment& segment) const {
    std::vector<std::uint32_t> near;
    ForEachCell(segment, [&](const Cell& cell) {
      for (std::int64_t x = -1; x <= 1; ++x) {
        for (std::int64_t y = -1; y <= 1; ++y) {
          const auto found = numbers_.find({cell[0] + x, cell[1] + y});
          if (found != numbers_.end()) near.insert(near.end(), found->second.begin(), found->second.end());
        }
      }
    });
    std::sort(near.begin(), near.end());
    near.erase(std::unique(near.begin(), near.end()), near.end());
    return near;
  }

 private:
  using Cell = std::array<std::int64_t, 2>;

  // Of points half a cell apart: those of two segments within half a cell of each other are in cells side by side.
  template <typename Use>
  void ForEachCell(const Segment& segment, const Use& use) const {
    const Vec2 way = segment.b - segment.a;
    const auto parts = static_cast<std::size_t>(std::ceil(2.0 * way.norm() / size_)) + 1;
    for (std::size_t i = 0; i <= parts; ++i) {
      const Vec2 point = segment.a + (static_cast<double>(i) / static_cast<double>(parts)) * way;
      use({static_cast<std::int64_t>(std::floor(point.x() / size_)),
           static_cast<std::int64_t>(std::floor(point.y() / size_))});
    }
  }

  double size_;
  std::map<Cell, std::vector<std::uint32_t>> numbers_;
};

void MakeSet(std::vector<std::uint32_t>& numbers) {
  std::sort(numbers.begin(), numbers.end());
  numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
}

}  // namespace

TrafficGraph::TrafficGraph(std::span<const LaneGraph> graphs, std::span<const double> radii) {
  TROUPE_CHECK(radii.size() == graphs.size());
  for (std::size_t i = 0; i < graphs.size(); ++i) {
    first_vertex_.push_back(static_cast<std::uint32_t>(vertices_.size()));
    for (const LaneVertex& vertex : graphs[i].vertices) {
      vertices_.push_back({.position = vertex.position, .z = vertex.z, .radius = radii[i]});
    }
  }
  first_vertex_.push_back(static_cast<std::uint32_t>(vertices_.size()));
  exits_.resize(vertices_.size());
  entries_.resize(vertices_.size());
  for (std::size_t i = 0; i < graphs.size(); ++i) {
    first_lane_.push_back(static_cast<std::uint32_t>(lanes_.size()));
    for (const Lane& lane : graphs[i].lanes) {
      const double length = graphs[i].Way(lane.start, lane.end).norm();
      const double most = lane.speed_limit > 0.0 ? std::min(1.0, lane.speed_limit) : 1.0;
      const double seconds = length / most + kDoorSeconds * static_cast<double>(lane.doors.size());
      AddWay(VertexOf(i, lane.start), VertexOf(i, lane.end), seconds, lane.is_bidirectional);
    }
  }
  first_lane_.push_back(static_cast<std::uint32_t>(lanes_.size()));
  AddRides(graphs);
  FindGroups(graphs);
  FindConflicts(radii.empty() ? 0.0 : *std::max_element(radii.begin(), radii.end()));
  FindNeeds();
}

void TrafficGraph::AddWay(std::uint32_t start, std::uint32_t end, double seconds, bool is_bidirectional) {
  const auto lane = static_cast<std::uint32_t>(lanes_.size());
  lanes_.push_back({.start = start, .end = end, .seconds = seconds});
  if (start == end) return;
  exits_[start].push_back({end, lane, seconds});
  entries_[end].push_back({start, lane, seconds});
  if (!is_bidirectional) return;
  exits_[end].push_back({start, lane, seconds});
  entries_[start].push_back({end, lane, seconds});
}

void TrafficGraph::AddRides(std::span<const LaneGraph> graphs) {
  for (std::size_t i = 0; i < graphs.size(); ++i) {
    const std::vector<LaneVertex>& vertices = graphs[i].vertices;
    for (std::size_t a = 0; a < vertices.size(); ++a) {
      if (!vertices[a].lift) continue;
      for (std::size_t b = a + 1; b < vertices.size(); ++b) {
        if (vertices[a].lift != vertices[b].lift || vertices[a].floor == vertices[b].floor) continue;
        AddWay(VertexOf(i, a), VertexOf(i, b), kRideSeconds + std::fabs(vertices[a].z - vertices[b].z), true);
      }
    }
  }
}

void TrafficGraph::FindGroups(std::span<const LaneGraph> graphs) {
  std::map<std::string, std::uint32_t> mutexes;
  std::map<std::uint32_t, std::uint32_t> lifts;
  const auto group = [&](auto& groups, const auto& key) {
    const auto [found, is_new] = groups.emplace(key, static_cast<std::uint32_t>(group_count_));
    if (is_new) ++group_count_;
    return found->second;
  };
  for (std::size_t i = 0; i < graphs.size(); ++i) {
    for (std::size_t v = 0; v < graphs[i].vertices.size(); ++v) {
      const LaneVertex& vertex = graphs[i].vertices[v];
      std::vector<std::uint32_t>& its = vertices_[VertexOf(i, v)].groups;
      if (!vertex.mutex.empty()) its.push_back(group(mutexes, vertex.mutex));
      if (vertex.lift) its.push_back(group(lifts, *vertex.lift));
    }
    for (std::size_t l = 0; l < graphs[i].lanes.size(); ++l) {
      const std::string& mutex = graphs[i].lanes[l].mutex;
      if (!mutex.empty()) lanes_[first_lane_[i] + l].groups.push_back(group(mutexes, mutex));
    }
  }
  vertices_of_groups_.resize(group_count_);
  for (std::size_t i = 0; i < vertices_.size(); ++i) {
    MakeSet(vertices_[i].groups);
    for (const std::uint32_t its_group : vertices_[i].groups) {
      vertices_of_groups_[its_group].push_back(static_cast<std::uint32_t>(i));
    }
  }
  const auto add = [this](std::vector<std::uint32_t>& groups, std::uint32_t end) {
    groups.insert(groups.end(), vertices_[end].groups.begin(), vertices_[end].groups.end());
    MakeSet(groups);
  };
  for (Way& lane : lanes_) {
    lane.to_end.groups = lane.to_start.groups = lane.groups;
    add(lane.to_end.groups, lane.end);
    add(lane.to_start.groups, lane.start);
    add(lane.groups, lane.start);
    add(lane.groups, lane.end);
  }
}

// `radius`: the largest one, m.
void TrafficGraph::FindConflicts(double radius) {
  const auto is_near = [&](const Segment& one, const Segment& two) {
    const double clearance = one.radius + two.radius;
    return std::fabs(one.z - two.z) < kLevelGap && SquaredDistance(one, two) < clearance * clearance;
  };
  Cells vertex_cells(std::max(4.0 * radius, 1.0));
  Cells lane_cells(std::max(4.0 * radius, 1.0));
  std::vector<Segment> points;
  std::vector<Segment> ways;
  for (const Vertex& vertex : vertices_) {
    points.push_back({vertex.position, vertex.position, vertex.z, vertex.radius});
    vertex_cells.Add(static_cast<std::uint32_t>(points.size() - 1), points.back());
  }
  for (const Way& lane : lanes_) {
    const Vertex& start = vertices_[lane.start];
    ways.push_back({start.position, vertices_[lane.end].position, start.z, start.radius});
    lane_cells.Add(static_cast<std::uint32_t>(ways.size() - 1), ways.back());
  }
  for (std::size_t i = 0; i < vertices_.size(); ++i) {
    for (const std::uint32_t other : vertex_cells.Near(points[i])) {
      if (other == i || is_near(points[i], points[other])) vertices_[i].near.push_back(other);
    }
  }
  for (std::size_t i = 0; i < lanes_.size(); ++i) {
    Way& lane = lanes_[i];
    for (const std::uint32_t other : vertex_cells.Near(ways[i])) {
      if (is_near(ways[i], points[other])) lane.near_vertices.push_back(other);
    }
    // Also where both ends are on different levels, or the radius is none.
    for (const std::uint32_t end : {lane.start, lane.end}) {
      const std::vector<std::uint32_t>& near = vertices_[end].near;
      lane.near_vertices.insert(lane.near_vertices.end(), near.begin(), near.end());
    }
    MakeSet(lane.near_vertices);
    for (const std::uint32_t other : lane_cells.Near(ways[i])) {
      if (other == i || is_near(ways[i], ways[other])) lane.near_lanes.push_back(other);
    }
  }
  // Lanes that share a vertex, or have ends near to each other.
  std::vector<std::vector<std::uint32_t>> lanes_at(vertices_.size());
  for (std::size_t i = 0; i < lanes_.size(); ++i) {
    for (const std::uint32_t end : {lanes_[i].start, lanes_[i].end}) {
      lanes_at[end].push_back(static_cast<std::uint32_t>(i));
    }
  }
  for (Way& lane : lanes_) {
    for (const std::uint32_t vertex : lane.near_vertices) {
      lane.near_lanes.insert(lane.near_lanes.end(), lanes_at[vertex].begin(), lanes_at[vertex].end());
    }
    MakeSet(lane.near_lanes);
  }
  for (std::size_t i = 0; i < lanes_.size(); ++i) {
    Way& lane = lanes_[i];
    const double leave_distance = ways[i].radius + radius + kLeaveMargin;
    const Vec2 along = ways[i].b - ways[i].a;
    const double length = along.norm();
    if (length <= leave_distance) continue;
    lane.leave_distance = leave_distance;
    const auto find_rest = [&](Rest& rest, Segment left, std::uint32_t end) {
      for (const std::uint32_t other : lane.near_lanes) {
        if (other == i || is_near(left, ways[other])) rest.near_lanes.push_back(other);
      }
      for (const std::uint32_t vertex : vertices_[end].near) {
        rest.near_lanes.insert(rest.near_lanes.end(), lanes_at[vertex].begin(), lanes_at[vertex].end());
      }
      MakeSet(rest.near_lanes);
    };
    const Vec2 step = leave_distance / length * along;
    Segment left = ways[i];
    left.a += step;
    find_rest(lane.to_end, left, lane.end);
    left = ways[i];
    left.b -= step;
    find_rest(lane.to_start, left, lane.start);
  }
}

void TrafficGraph::FindNeeds() {
  needing_.resize(vertices_.size());
  for (std::uint32_t lane = 0; lane < lanes_.size(); ++lane) {
    needs_.push_back(NeedBetween(lane, lanes_[lane].start, lanes_[lane].end));
    needs_.push_back(NeedBetween(lane, lanes_[lane].end, lanes_[lane].start));
  }
  for (std::uint32_t direction = 0; direction < needs_.size(); ++direction) {
    const auto add = [&](std::uint32_t vertex) {
      std::vector<std::uint32_t>& directions = needing_[vertex];
      if (directions.empty() || directions.back() != direction) directions.push_back(direction);
    };
    for (const std::uint32_t vertex : needs_[direction].vertices) add(vertex);
    for (const std::uint32_t group : needs_[direction].groups) {
      for (const std::uint32_t vertex : vertices_of_groups_[group]) add(vertex);
    }
  }
}

TrafficGraph::Need TrafficGraph::NeedBetween(std::uint32_t lane, std::uint32_t from, std::uint32_t to) const {
  const auto contains = [](const std::vector<std::uint32_t>& sorted, std::uint32_t number) {
    return std::binary_search(sorted.begin(), sorted.end(), number);
  };
  Need need;
  for (const std::uint32_t vertex : lanes_[lane].near_vertices) {
    const bool moves_apart =
        contains(vertices_[from].near, vertex) && !contains(vertices_[to].near, vertex) && LeadsAway(from, to, vertex);
    if (!moves_apart) need.vertices.push_back(vertex);
  }
  for (const std::uint32_t group : lanes_[lane].groups) {
    const bool leaves = contains(vertices_[from].groups, group) && !contains(vertices_[to].groups, group);
    if (!leaves) need.groups.push_back(group);
  }
  return need;
}

// The straight way between two vertices comes no nearer to a third one than its start.
bool TrafficGraph::LeadsAway(std::uint32_t from, std::uint32_t to, std::uint32_t vertex) const {
  const Vec2& start = vertices_[from].position;
  return (vertices_[to].position - start).dot(vertices_[vertex].position - start) <= 0.0;
}

}  // namespace troupe
