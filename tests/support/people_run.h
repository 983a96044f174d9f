// Steps of a world with people.
// The step alone, without a service: people are a part of the state, so that nothing else is needed.
#pragma once

#include <memory>
#include <vector>

#include "common/spatial/body_index.h"
#include "common/spatial/scene.h"
#include "world-service/core/step.h"

namespace troupe::test {

class PeopleRun {
 public:
  explicit PeopleRun(const WorldDescription& world)
      : scene(std::make_shared<const Scene>(world)), state(InitialState(*scene)), bodies_(*scene) {}

  void Step(const std::vector<Proposal>& proposals = {}) {
    state = troupe::Step(*scene, state, proposals, bodies_).state;
  }
  // Steps until done(), for at most `ticks`; whether it is done.
  template <typename Done>
  bool StepUntil(int ticks, Done done) {
    for (int i = 0; i < ticks && !done(); ++i) Step();
    return done();
  }
  Vec2 Place(PersonId person) const { return state.people[person.index()].X_WP.translation(); }

  const std::shared_ptr<const Scene> scene;
  WorldState state;

 private:
  BodyIndex bodies_;
};

}  // namespace troupe::test
