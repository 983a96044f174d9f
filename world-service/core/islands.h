// Islands: groups of robots that cannot affect each other during a tick, because the areas that they and their payloads
// can reach in it do not overlap, and they have no object in common. Robots of an island act one after another, as
// always; robots of different islands may act at the same time, with the same result bit for bit. This is how a step
// uses several processors without giving up its order.
//
// The areas are discs around the origins of robots and objects: larger than necessary, never too small. A wrong split
// would change results; a missed one only costs time. So all bounds are rounded up by a margin far above rounding.
//
// An object without a robot near it belongs to no island: nothing can move it before gravity, which acts after the
// islands. People are in none, because they move after the robots.
//
// Find is called by one thread, before others read the islands. Its time grows about linearly with robots and objects:
// discs are compared within the cells of a grid, as wide as an average disc, and groups are trees of a union-find
// forest with path halving (Tarjan and van Leeuwen 1984).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/model/proposal.h"
#include "common/spatial/scene.h"
#include "troupe/ids.h"
#include "troupe/vec2.h"
#include "troupe/world_state.h"

namespace troupe {

class Islands {
 public:
  // The islands of the tick after `state`. `by_robot`: the proposal of each robot, by id; null: it stands.
  void Find(const Scene& scene, const WorldState& state, std::span<const Proposal* const> by_robot);

  // Large ones first.
  std::size_t count() const { return order_.size(); }
  // In the order in which they act in a step without islands, of which this is a subsequence.
  std::span<const RobotId> robots(std::size_t island) const { return robots_.Of(order_[island]); }     // as they act
  std::span<const ObjectId> objects(std::size_t island) const { return objects_.Of(order_[island]); }  // by id
  std::span<const GripperId> grippers(std::size_t island) const { return grippers_.Of(order_[island]); }

 private:
  // Lists of ids, one for each island.
  template <typename Id>
  class Lists {
   public:
    // Groups `count` ids; island_of(i) is the island of the id that id_of(i) gives, or kNone.
    template <typename IdOf, typename IslandOf>
    void Fill(std::size_t islands, std::size_t count, IdOf id_of, IslandOf island_of);
    std::span<const Id> Of(std::uint32_t island) const {
      return std::span(ids_).subspan(first_[island], first_[island + 1] - first_[island]);
    }

   private:
    std::vector<std::uint32_t> first_;
    std::vector<Id> ids_;
  };

  // An area in the plane around a body that includes everything that it can touch.
  // A disc, because a body that turns about its origin stays in it.
  struct Reach {
    Vec2 center;
    double radius = 0.0;
  };

  std::uint32_t Root(std::uint32_t body);
  void Join(std::uint32_t a, std::uint32_t b);
  void JoinAttached(const Scene& scene, const WorldState& state);
  void MeasureReaches(const Scene& scene, const WorldState& state, std::span<const Proposal* const> by_robot);
  void JoinOverlapping();
  void Number(const Scene& scene, const WorldState& state);

  static constexpr std::uint32_t kNone = ~std::uint32_t{0};

  // Members for their memory only.
  std::vector<std::uint32_t> parent_;  // by body: a forest, whose trees are the groups
  std::vector<Reach> reaches_;         // by body
  std::vector<std::uint32_t> island_;  // by body; kNone: of an object that no robot can affect
  std::vector<std::uint32_t> cell_first_;
  std::vector<std::uint32_t> cell_bodies_;
  std::vector<std::uint32_t> order_;
  Lists<RobotId> robots_;
  Lists<ObjectId> objects_;
  Lists<GripperId> grippers_;
};

}  // namespace troupe
