// Runs a loaded world in one process, tick by tick, with its real controllers.
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/spatial/overlap.h"
#include "common/spatial/body_index.h"
#include "common/spatial/scene.h"
#include "common/spatial/sweep.h"
#include "robot-agent/agent/robot.h"
#include "world-service/core/step.h"

namespace troupe {

class ScenarioRun {
 public:
  explicit ScenarioRun(WorldDescription world)
      : scene_(std::move(world)), index_(scene_), state_(InitialState(scene_.world())) {
    for (std::size_t i = 0; i < scene_.world().robots.size(); ++i) {
      Result<std::unique_ptr<Robot>> robot = Robot::Create(scene_, RobotId(i), nullptr);
      EXPECT_TRUE(robot.ok()) << robot.error().ToString();
      if (robot.ok()) robots_.push_back(std::move(robot).value());
    }
    ever_stalled_.resize(robots_.size(), false);
  }

  void Run(int ticks) {
    for (int i = 0; i < ticks; ++i) {
      index_.Assign(state_);
      std::vector<Proposal> proposals;
      for (const auto& robot : robots_) proposals.push_back(robot->Decide(state_, index_));
      StepResult result = Step(scene_, state_, proposals);
      state_ = std::move(result.state);
      events_.insert(events_.end(), result.events.begin(), result.events.end());
      for (std::size_t r = 0; r < robots_.size(); ++r) {
        if (state_.robots[r].stalled) ever_stalled_[r] = true;
      }
    }
  }

  const Scene& scene() const { return scene_; }
  const WorldState& state() const { return state_; }
  const std::vector<Event>& events() const { return events_; }  // of all ticks
  RobotId Find(const std::string& name) const {
    const std::optional<RobotId> robot = FindRobot(scene_.world(), name);
    EXPECT_TRUE(robot.has_value()) << name;
    return robot.value_or(RobotId());
  }
  const RobotState& operator[](const std::string& name) const { return state_.robots[Find(name).index()]; }
  bool EverStalled(const std::string& name) const { return ever_stalled_[Find(name).index()]; }

  // The name of what the robot meets when it moves 1 mm ahead from where it stands; "" if nothing.
  std::string MetWithinOneMillimetre(const std::string& name) {
    index_.Assign(state_);
    const RobotId robot = Find(name);
    const BodyId body = scene_.body_of(robot);
    const Motion motion{state_.robots[robot.index()].X_WR, {0.001, 0.0, 0.0}, 0.0, 1.0};
    const std::optional<Contact> contact = FirstContact(scene_, index_, MoverOf(scene_, body), motion);
    return contact && contact->other ? scene_.world().model(*contact->other).name : "";
  }

  // True if the robot's body overlaps anything solid where it stands.
  bool InsideSomething(const std::string& name) {
    index_.Assign(state_);
    const RobotId robot = Find(name);
    const std::vector<ConvexPiece>& own = index_.pieces_in_world(BodyId(robot.index()));
    for (std::size_t i = 0; i < robots_.size(); ++i) {
      if (RobotId(i) != robot && AnyOverlap(own, index_.pieces_in_world(BodyId(i)))) return true;
    }
    return AnyOverlap(own, scene_.static_index().pieces());
  }

 private:
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

  Scene scene_;
  BodyIndex index_;
  WorldState state_;
  std::vector<Event> events_;
  std::vector<std::unique_ptr<Robot>> robots_;
  std::vector<bool> ever_stalled_;
};

}  // namespace troupe
