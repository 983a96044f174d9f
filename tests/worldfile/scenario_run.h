// Runs a loaded world in one process, tick by tick, with its real controllers.
#pragma once

#include <gtest/gtest.h>

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/spatial/body_index.h"
#include "common/spatial/convex_piece.h"
#include "common/spatial/scene.h"
#include "common/spatial/sweep.h"
#include "troupe/simulation.h"

namespace troupe {

class ScenarioRun {
 public:
  explicit ScenarioRun(WorldDescription world)
      : simulation_(Make(std::move(world))), scene_(simulation_.world()), index_(scene_) {
    ever_stalled_.resize(scene_.world().robots.size(), false);
  }

  void Run(int ticks) {
    for (int i = 0; i < ticks; ++i) {
      simulation_.Step();
      events_.insert(events_.end(), simulation_.events().begin(), simulation_.events().end());
      for (std::size_t r = 0; r < ever_stalled_.size(); ++r) {
        if (state().robots[r].stalled) ever_stalled_[r] = true;
      }
    }
  }

  const Scene& scene() const { return scene_; }
  const WorldState& state() const { return simulation_.state(); }
  const std::vector<Event>& events() const { return events_; }  // of all ticks
  RobotId Find(const std::string& name) const {
    const std::optional<RobotId> robot = FindRobot(scene_.world(), name);
    EXPECT_TRUE(robot.has_value()) << name;
    return robot.value_or(RobotId(0));
  }
  const RobotState& operator[](const std::string& name) const { return state().robots[Find(name).index()]; }
  bool EverStalled(const std::string& name) const { return ever_stalled_[Find(name).index()]; }

  // The name of the obstacle within 1 mm ahead of the robot; "" without one.
  std::string MetWithinOneMillimetre(const std::string& name) {
    index_.Assign(state());
    const RobotId robot = Find(name);
    const BodyId body = scene_.body_of(robot);
    const Motion motion{state().robots[robot.index()].X_WR, {0.001, 0.0, 0.0}, 0.0, 1.0};
    const std::optional<Contact> contact = FirstContact(scene_, index_, MoverOf(scene_, body), motion);
    return contact && contact->other ? scene_.world().model(*contact->other).name : "";
  }

  // True if the robot's body overlaps anything solid.
  bool InsideSomething(const std::string& name) {
    index_.Assign(state());
    const RobotId robot = Find(name);
    const std::vector<ConvexPiece>& own = index_.pieces_in_world(BodyId(robot.index()));
    for (std::size_t i = 0; i < scene_.world().robots.size(); ++i) {
      if (RobotId(i) != robot && AnyOverlap(own, index_.pieces_in_world(BodyId(i)))) return true;
    }
    return AnyOverlap(own, scene_.static_index().kept_pieces());
  }

 private:
  static Simulation Make(WorldDescription world) {
    Result<Simulation> simulation = Simulation::Create(std::move(world));
    if (!simulation.ok()) ADD_FAILURE() << simulation.error().ToString();
    return std::move(simulation).value();
  }
  static bool AnyOverlap(const std::vector<ConvexPiece>& a, const std::vector<ConvexPiece>& b) {
    for (const ConvexPiece& p : a) {
      for (const ConvexPiece& q : b) {
        if (p.obstacle && q.obstacle && p.z.Overlaps(q.z) &&
            PenetrationDepth(p.vertices, q.vertices) > kTouchTolerance) {
          return true;
        }
      }
    }
    return false;
  }

  Simulation simulation_;
  Scene scene_;      // of the same world, for queries about contacts
  BodyIndex index_;  // at a state only during such a query
  std::vector<Event> events_;
  std::vector<bool> ever_stalled_;
};

}  // namespace troupe
