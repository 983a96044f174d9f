// Worlds with people for tests.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "tests/support/test_world.h"
#include "troupe/polygon.h"

namespace troupe::test {

class PeopleWorld : public TestWorld {
 public:
  // Goals that are visited again and again; the number of the set.
  std::uint32_t AddGoals(std::vector<Vec2> points, const Interval& wait = {0.0, 0.0}) {
    const auto number = static_cast<std::uint32_t>(world.goal_sets.size());
    const bool goes_on = points.size() > 1;
    GoalSet& set = world.goal_sets.emplace_back();
    set.name = "goals" + std::to_string(number);
    set.points = std::move(points);
    set.wait = wait;
    if (goes_on) world.goal_sets.back().next = {{number, 1.0}};
    return number;
  }
  PersonId AddPerson(const Vec2& start, std::uint32_t goals, PersonReaction reaction = PersonReaction::kRegular,
                     double radius = 0.25) {
    const ModelId root = AddModel(RegularPolygon(12, radius), {0.0, 1.75}, {start.x(), start.y(), 0.0, 0.0});
    world.models.back().type = "person";
    world.people.push_back({.root = root, .radius = radius, .reaction = reaction, .goals = goals});
    return PersonId(world.people.size() - 1);
  }
};

}  // namespace troupe::test
