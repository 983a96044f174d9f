// A house for tests: halls above each other, each with a wall across it that has a door, and a lift beside them.
// Heights follow from kStorey.
#pragma once

#include <cstddef>
#include <numeric>
#include <string>
#include <vector>

#include "tests/support/people_world.h"

namespace troupe::test {

class HouseWorld : public PeopleWorld {
 public:
  static constexpr double kStorey = 3.2;  // m
  enum class Leaf { kHinged, kHingedBack, kSliding, kDouble };

  explicit HouseWorld(std::size_t levels, Leaf kind = Leaf::kHinged, double door_y = 5.0, double cabin = 2.3) {
    for (std::size_t i = 0; i < levels; ++i) AddHall(LevelZ(i), kind, door_y);
    std::vector<std::size_t> all(levels);
    std::iota(all.begin(), all.end(), 0);
    AddLift(all, cabin, {0.0, 5.0});
  }

  static double LevelZ(std::size_t level) { return kStorey * static_cast<double>(level); }

  // A lift between levels, ascending, whose door is at `at` and opens towards x; its cabin is a square of `size` m,
  // the doorway twice `half_width` wide.
  void AddLift(const std::vector<std::size_t>& levels, double size, const Vec2& at, double half_width = 0.6) {
    constexpr double kCabinDoor = -0.09;  // m, of the door of the cabin from that of the level
    const double half = 0.5 * size;
    const double start = LevelZ(levels.front());
    const ModelId lift_model = AddModel(Box(0.0, 0.0, 0.1, 0.1), {60.0, 60.1});
    const ZRange walls{0.0, 2.5};
    const std::vector<Block> blocks{{Box(-half, -half, half, half), {-0.05, 0.0}},
                                    {Box(-half, -half, half, -half + 0.05), walls},
                                    {Box(-half, half - 0.05, half, half), walls},
                                    {Box(-half, -half + 0.05, -half + 0.05, half - 0.05), walls},
                                    {Box(half - 0.05, -half + 0.05, half, -half_width), walls},
                                    {Box(half - 0.05, half_width, half, half - 0.05), walls}};
    const ModelId cabin = AddModel(blocks, {at.x() + kCabinDoor + 0.025 - half, at.y(), start, 0.0});
    LiftDescription lift{.model = lift_model,
                         .cabin = AddMounted(cabin),
                         .cabin_doors = {world.doors.size()},
                         .floors = {},
                         .speed = 1.5};
    AddLiftDoor({at.x() + kCabinDoor, at.y()}, start, half_width, true);
    for (const std::size_t level : levels) {
      AddLiftDoor(at, LevelZ(level), half_width, level == levels.front());
      lift.floors.push_back(
          {"L" + std::to_string(level), LevelZ(level), {lift.cabin_doors[0], world.doors.size() - 1}});
    }
    world.lifts.push_back(lift);
  }

  // A point of the goals of people, on a level.
  struct Place {
    Vec2 at{0.0, 0.0};
    std::size_t level = 0;
  };
  // Goals that are visited in turn, for ever; the number of the first set.
  std::uint32_t AddTour(const std::vector<Place>& places, const Interval& wait = {0.0, 0.0}) {
    const auto first = static_cast<std::uint32_t>(world.goal_sets.size());
    for (std::size_t i = 0; i < places.size(); ++i) {
      const std::uint32_t number = AddGoals({places[i].at}, wait);
      GoalSet& set = world.goal_sets[number];
      set.heights = {LevelZ(places[i].level)};
      set.next = {{first + static_cast<std::uint32_t>((i + 1) % places.size()), 1.0}};
    }
    return first;
  }
  PersonId AddPersonOn(std::size_t level, const Vec2& start, std::uint32_t goals, double radius = 0.25) {
    const PersonId person = AddPerson(start, goals, PersonReaction::kRegular, radius);
    model(world.person(person).root).X_PM.z = LevelZ(level);
    return person;
  }

 private:
  // Its floor is 14 m long and 10 m wide; the door is in the wall at x = 8 m, the lift behind that at x = 0.
  void AddHall(double z, Leaf kind, double door_y) {
    const ZRange heights{z, z + 2.5};
    AddModel(Box(-0.05, -0.05, 14.05, 0.05), heights);
    AddModel(Box(-0.05, 9.95, 14.05, 10.05), heights);
    AddModel(Box(13.95, 0.0, 14.05, 10.0), heights);
    AddModel(Box(-0.05, 0.0, 0.05, 4.4), heights);
    AddModel(Box(-0.05, 5.6, 0.05, 10.0), heights);
    AddModel(Box(7.95, 0.0, 8.05, door_y - 0.5), heights);
    AddModel(Box(7.95, door_y + 0.5, 8.05, 10.0), heights);
    const Pose south{8.0, door_y - 0.5, z, 0.5 * kPi};
    const Pose north{8.0, door_y + 0.5, z, -0.5 * kPi};
    switch (kind) {
      case Leaf::kHinged:
        return AddDoor(z, {{south, 0.99, 0.5 * kPi, 0.0}});
      case Leaf::kHingedBack:
        return AddDoor(z, {{north, 0.99, 0.5 * kPi, 0.0}});
      case Leaf::kSliding:
        return AddDoor(z, {{south, 0.99, 0.0, 1.0}});
      case Leaf::kDouble:
        return AddDoor(z, {{south, 0.49, 0.5 * kPi, 0.0}, {north, 0.49, -0.5 * kPi, 0.0}});
    }
  }

  struct Panel {
    Pose X_WH;
    double width;
    double turn;
    double shift;
  };
  void AddDoor(double z, const std::vector<Panel>& panels, double height = 2.2) {
    DoorDescription door{.model = AddModel(Box(0.0, 0.0, 0.1, 0.1), {60.0, 60.1}, {0.0, 0.0, z, 0.0}), .leaves = {}};
    for (const Panel& panel : panels) {
      const ModelId leaf = AddModel(Box(0.005, -0.02, panel.width, 0.02), {0.01, height}, panel.X_WH);
      door.leaves.push_back({AddMounted(leaf), panel.X_WH, panel.turn, panel.shift});
    }
    door.seconds = 2.0;
    world.doors.push_back(door);
  }
  ObjectId AddMounted(ModelId model) {
    world.objects.push_back(model);
    return ObjectId(world.objects.size() - 1);
  }

  // A sliding door of two leaves across x.
  void AddLiftDoor(const Vec2& at, double z, double half_width, bool is_open) {
    const Pose south{at.x(), at.y(), z, -0.5 * kPi};
    const Pose north{at.x(), at.y(), z, 0.5 * kPi};
    AddDoor(z, {{south, half_width, 0.0, half_width}, {north, half_width, 0.0, half_width}}, 2.5);
    world.doors.back().is_operated = false;
    world.doors.back().opening = is_open ? 1.0 : 0.0;
    for (const DoorLeaf& leaf : world.doors.back().leaves) {
      model(world.objects[leaf.object.index()]).X_PM = leaf.X_WH_at(world.doors.back().opening);
    }
  }
};

}  // namespace troupe::test
