// People of scenarios and of the crowds of buildings (crowd.h): from rules to the bodies, goals and starts of a
// description.
//
// A person is a body of two prisms (trunk and head), walked by the world service, not by a process of its own:
// thousands of them must fit. All choices (start, speed, colours) are draws with keys of seed, rule and person, so that
// a rule keeps its people when another rule is added behind it, unless they compete for the same floor.
//
// People are added last, when all models have their places; they avoid models and each other at the start. Lengths in
// m, speeds in m/s, frame W.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "troupe/interval.h"
#include "troupe/polygon.h"
#include "troupe/result.h"
#include "worldfile/models/build_world.h"

namespace troupe {

// People that start in one region and have the same goals.
struct PeopleRule {
  std::uint32_t count = 0;
  Polygon region;            // normalized, m, frame W; contains the starts
  double z = 0.0;            // m, of the floor on which they walk
  Interval speed{1.1, 1.5};  // m/s; each person's is drawn between these
  double height = 1.75;      // m
  // What they have in common; max_speed 0: 1.4 times the person's speed.
  PersonDescription person = {.root = {}, .max_speed = 0.0};
  std::uint32_t group = 1;  // people that walk together
  std::string name_prefix = "person";
  // People start where they can walk to this point within the region, as far as a person can stand there.
  std::optional<Vec2> point = {};
  // They are visitors of this flow: away at first, so that the starts of several may overlap.
  std::optional<std::uint32_t> flow = {};
  SourceLocation where;
};

// One whose ways have been recorded.
struct RecordedPerson {
  std::vector<double> times;    // s, ascending
  std::vector<Vec2> positions;  // m, frame W, at these times
};

// People of one recording.
struct RecordedPeople {
  std::vector<RecordedPerson> people;
  double z = 0.0;  // m, of the floor
  double radius = 0.25;
  double height = 1.75;
  bool react = false;  // each walks from its first position to its last one, in place of following its track
  PersonReaction reaction = PersonReaction::kRegular;
  std::string name_prefix = "person";
  SourceLocation where;
};

// The most people of a world.
inline constexpr std::uint32_t kMaxPeople = 20'000;

// The world with the people of the rules, each at a start that is drawn from the region until nothing that can be hit
// is within the person's radius, nor the shaft of a lift without its cabin. The same world, rules and `seed` give the
// same people. The error counts the people that found room. REQUIRES: the goal sets exist.
Result<LoadedWorld> AddPeople(LoadedWorld loaded, const std::vector<PeopleRule>& rules, std::uint64_t seed);

// The world with the people of recordings, who enter and leave at the times of their tracks.
Result<LoadedWorld> AddRecordedPeople(LoadedWorld loaded, const std::vector<RecordedPeople>& recordings,
                                      std::uint64_t seed);

}  // namespace troupe
