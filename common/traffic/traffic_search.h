// TrafficSearch: the moves that bring one robot to a vertex, and those of the robots that have to make room for it.
//
// Find goes along the fastest route and pushes each robot in the way to the nearest free vertex, best off the route.
// That fails where robots have to pass each other beside the route: FindAnyWay then searches over the vertices of the
// robot and the numbers of free vertices in the parts into which it divides the graph there. Within a part robots can
// be arranged in any way, so that the numbers are all that counts; this keeps the search small. It finds ways back to a
// siding, and lets robots pass there.
//
// Cost: Find a search of the graph for each robot that is pushed; FindAnyWay at most kMaxStates of these, and bounded
// by its caller.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "common/traffic/formation.h"
#include "common/traffic/traffic_graph.h"
#include "common/traffic/traffic_routes.h"

namespace troupe {

class TrafficSearch {
 public:
  static constexpr std::size_t kMaxStates = 2000;

  // `closed`: by lane. `routes`: for these lanes, or with fewer closed. `is_fixed`: by row, the robots that stay where
  // they are. All outlive the search.
  TrafficSearch(const TrafficGraph& graph, const std::vector<bool>& closed, TrafficRoutes& routes,
                const std::vector<bool>& is_fixed)
      : graph_(graph), closed_(closed), routes_(routes), is_fixed_(is_fixed) {}

  // Adds the moves to those of the formation. False: there is no such way, and the formation is as before.
  // Find: the first `own_moves` of the robot, or some more up to a vertex at which it may wait, or fewer if the rest is
  // not possible now. `push_seconds`: of the route past a robot that has to make room.
  bool Find(Formation& formation, std::uint32_t row, std::uint32_t goal, std::size_t own_moves,
            double push_seconds) const;
  // FindAnyWay: up to a vertex at which it may wait, and which is nearer to the goal. It ends after `max_visits` of
  // vertices, without a result.
  bool FindAnyWay(Formation& formation, std::uint32_t row, std::uint32_t goal, std::size_t max_visits) const;
  // Of vertices, by the last FindAnyWay.
  std::size_t visits() const { return visits_; }
  // Moves a robot off a lane.
  bool MakeRoom(Formation& formation, std::uint32_t row, std::uint32_t lane) const;

 private:
  // Vertices at which a robot that is pushed may not end.
  using Marks = std::vector<bool>;

  std::vector<TrafficExit> FindRoute(const Formation& formation, std::uint32_t row, std::uint32_t goal,
                                     double push_seconds) const;
  bool Clear(Formation& formation, std::uint32_t row, std::uint32_t lane, std::uint32_t to, const Marks& best,
             const Marks& good) const;
  bool Push(Formation& formation, std::uint32_t pushed, std::uint32_t pinned, const Marks& avoided) const;
  bool MoveChain(Formation& formation, const std::vector<TrafficExit>& way, std::uint32_t first) const;
  bool MayPass(const Formation& formation, std::uint32_t pinned, std::uint32_t moving, const TrafficExit& exit) const;
  Marks Near(std::span<const TrafficExit> lanes) const;
  std::vector<std::uint32_t> KeyOf(const Formation& formation, std::uint32_t row) const;
  std::vector<std::uint32_t> PartsWithout(std::uint32_t one, std::optional<std::uint32_t> two) const;

  const TrafficGraph& graph_;
  const std::vector<bool>& closed_;
  TrafficRoutes& routes_;
  const std::vector<bool>& is_fixed_;
  mutable std::size_t visits_ = 0;  // of vertices
};

}  // namespace troupe
