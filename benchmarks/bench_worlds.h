// A cave of some thousand rectangles, 16 m by 16 m, with robots in its free places: the world of the benchmarks.
// It is made by a fixed seed, so that figures of two builds are about the same work. A cave instead of an empty room,
// because rays and motions are cheap where nothing is near.
#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "troupe/polygon.h"
#include "troupe/random.h"
#include "troupe/world_description.h"
#include "troupe/world_state.h"

namespace troupe::bench {

// Smooth random heights over the plane; rock is where they are high.
inline double RockAt(double x, double y) {
  const auto corner = [](double cx, double cy) {
    return RandomUniform({17, static_cast<std::uint64_t>(cx + 1000.0), static_cast<std::uint64_t>(cy + 1000.0)});
  };
  const double fx = std::floor(x);
  const double fy = std::floor(y);
  const auto blend = [](double a, double b, double t) { return a + (b - a) * t * t * (3.0 - 2.0 * t); };
  return blend(blend(corner(fx, fy), corner(fx + 1, fy), x - fx),
               blend(corner(fx, fy + 1), corner(fx + 1, fy + 1), x - fx), y - fy);
}

inline constexpr double kCaveWidth = 16.0;  // m

inline bool IsRock(double x, double y) {
  const double margin = 0.5 * kCaveWidth - 0.1;
  return std::abs(x) > margin || std::abs(y) > margin || RockAt(x * 0.5, y * 0.5) > 0.62;
}

// A robot of `blocks` small boxes within a radius of 0.25 m.
inline Shape RobotShape(int blocks) {
  Shape shape;
  for (int i = 0; i < blocks; ++i) {
    const double x = 0.15 * ((i % 3) - 1);
    const double y = 0.1 * ((i / 3) % 3 - 1);
    const double z = 0.1 * (i / 9);
    shape.blocks.push_back(
        {{{x - 0.07, y - 0.05}, {x + 0.07, y - 0.05}, {x + 0.07, y + 0.05}, {x - 0.07, y + 0.05}}, {z, z + 0.25}});
  }
  return shape;
}

inline WorldDescription CaveWorld(std::size_t robots, int blocks_per_robot) {
  constexpr int kPixels = 260;
  constexpr double kPixel = kCaveWidth / kPixels;
  WorldDescription world;
  world.name = "cave";
  const auto at = [](int i) { return (i + 0.5) * kPixel - 0.5 * kCaveWidth; };
  Shape rock;
  for (int row = 0; row < kPixels; ++row) {
    for (int column = 0; column < kPixels;) {
      const int start = column;
      while (column < kPixels && IsRock(at(column), at(row))) ++column;
      if (column > start) {
        rock.rectangles.push_back(
            {at(start) - 0.5 * kPixel, at(row) - 0.5 * kPixel, at(column) - 0.5 * kPixel, at(row) + 0.5 * kPixel});
      }
      ++column;
    }
  }
  rock.rectangles_z = {0.0, 1.0};
  world.shapes = {rock, RobotShape(blocks_per_robot)};
  ModelDescription cave;
  cave.name = "cave";
  cave.shape = ShapeId(0);
  world.models.push_back(cave);

  const auto is_free = [&](double x, double y) {
    for (double dx : {-0.3, 0.0, 0.3}) {
      for (double dy : {-0.3, 0.0, 0.3}) {
        if (IsRock(x + dx, y + dy)) return false;
      }
    }
    for (const RobotDescription& robot : world.robots) {
      const Pose& pose = world.model(robot.root).X_PM;
      if (std::hypot(pose.x - x, pose.y - y) < 0.6) return false;
    }
    return true;
  };
  for (std::uint64_t draw = 0; world.robots.size() < robots && draw < 100'000; ++draw) {
    const double x = (RandomUniform({1, draw}) - 0.5) * kCaveWidth;
    const double y = (RandomUniform({2, draw}) - 0.5) * kCaveWidth;
    if (!is_free(x, y)) continue;
    ModelDescription model;
    model.name = "r" + std::to_string(world.robots.size());
    model.X_PM = {x, y, 0.0, kPi * (2.0 * RandomUniform({3, draw}) - 1.0)};
    model.shape = ShapeId(1);
    world.models.push_back(model);
    RobotDescription robot;
    robot.name = model.name;
    robot.root = ModelId(world.models.size() - 1);
    const Interval any{-1e6, 1e6};
    robot.drive.velocity = robot.drive.acceleration = {any, any, any};
    world.robots.push_back(robot);
  }
  return world;
}

// Robots three metres from each other on an empty plane.
inline WorldDescription SparseWorld(std::size_t robots, int blocks_per_robot) {
  WorldDescription world = CaveWorld(1, blocks_per_robot);
  world.shapes[0].rectangles.clear();
  const ModelDescription model = world.models[1];
  const RobotDescription robot = world.robots[0];
  world.models.resize(1);
  world.robots.clear();
  const auto width = static_cast<std::size_t>(std::ceil(std::sqrt(static_cast<double>(robots))));
  for (std::size_t i = 0; i < robots; ++i) {
    world.models.push_back(model);
    world.models.back().name = "r" + std::to_string(i);
    world.models.back().X_PM = {3.0 * static_cast<double>(i % width), 3.0 * static_cast<double>(i / width), 0.0, 0.0};
    world.robots.push_back(robot);
    world.robots.back().name = world.models.back().name;
    world.robots.back().root = ModelId(world.models.size() - 1);
  }
  return world;
}

// People in a hall of 5 m^2 for each, with a column on each 25 m^2, that walk to places all over it.
inline WorldDescription HallWorld(std::size_t people) {
  const int side = static_cast<int>(std::ceil(std::sqrt(static_cast<double>(people) / 5.0)));  // squares of 5 m
  WorldDescription world;
  world.name = "hall";
  Shape columns;
  GoalSet goals;
  goals.wait = {2.0, 10.0};
  goals.next = {{0, 1.0}};
  for (int row = 0; row < side; ++row) {
    for (int column = 0; column < side; ++column) {
      const double x = 5.0 * column;
      const double y = 5.0 * row;
      columns.rectangles.push_back({x, y, x + 0.5, y + 0.5});
      if ((row + side * column) % (1 + side * side / 12) == 0) goals.points.emplace_back(x + 2.5, y + 2.5);
    }
  }
  columns.rectangles_z = {0.0, 2.5};
  Shape body;
  body.blocks.push_back({RegularPolygon(12, 0.25), {0.0, 1.75}});
  world.shapes = {columns, body};
  world.goal_sets = {goals};
  ModelDescription model;
  model.name = "columns";
  world.models.push_back(model);
  world.models.back().shape = ShapeId(0);
  for (std::size_t i = 0; i < people; ++i) {
    // Five in each square, beside its column.
    const auto square = static_cast<int>(i / 5);
    const double x = 5.0 * (square % side) + 1.2 + 0.8 * static_cast<double>(i % 5);
    model.name = "person" + std::to_string(i);
    model.type = "person";
    model.shape = ShapeId(1);
    model.X_PM = {x, 5.0 * (square / side) + 2.5, 0.0, 0.0};
    PersonDescription person;
    person.root = ModelId(world.models.size());
    world.models.push_back(model);
    world.people.push_back(person);
  }
  return world;
}

}  // namespace troupe::bench
