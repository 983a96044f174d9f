// The people of a WorldDescription: bodies that the step moves from goal to goal. PersonState (world_state.h) has their
// motion and the goals that they have chosen.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "troupe/enum_names.h"
#include "troupe/fields.h"
#include "troupe/ids.h"
#include "troupe/interval.h"
#include "troupe/vec2.h"

namespace troupe {

// The reaction of a person to a robot.
enum class PersonReaction : std::uint8_t {
  kRegular = 0,   // avoids it like a walker who does not avoid in turn
  kCurious = 1,   // walks up to it and watches it for a while
  kScared = 2,    // keeps away from it
  kCareless = 3,  // ignores it, and only stops at a contact
};
constexpr auto NamesOf(PersonReaction) {
  return std::array{"regular", "curious", "scared", "careless"};
}

// A goal set that may follow another one.
struct NextGoals {
  std::uint32_t goals = 0;
  double weight = 1.0;
  bool operator==(const NextGoals&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"goals", &NextGoals::goals, "in WorldDescription::goal_sets"},
        Field{"weight", &NextGoals::weight, "of the choice, relative to the others"}.Above(0),
    };
  }
};

// Goals of people: a person chooses one of the points, walks there, waits, and chooses among the next sets.
struct GoalSet {
  std::string name;
  std::vector<Vec2> points;
  double reach = 0.5;
  Interval wait;
  std::vector<NextGoals> next;
  std::vector<double> heights = {};
  bool operator==(const GoalSet&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"name", &GoalSet::name},
        Field{"points", &GoalSet::points, "in W; none: the person stays where it is"}.In("m"),
        Field{"reach", &GoalSet::reach, "distance at which the person has arrived"}.In("m").Above(0),
        Field{"wait", &GoalSet::wait, "at the goal, drawn between these"}.In("s").AtLeast(0),
        Field{"next", &GoalSet::next, "none: the person stays at its goal"},
        Field{"heights", &GoalSet::heights, "of the points; none: on the level on which the person starts"}.In("m"),
    };
  }
};

inline constexpr double kMaxPersonRadius = 10.0;  // m
inline constexpr double kMaxPersonSpeed = 100.0;  // m/s

// A walker of the world: it is moved by the step, and is a body like all others.
struct PersonDescription {
  ModelId root;
  double radius = 0.25;
  double speed = 1.3;
  double max_speed = 1.8;
  PersonReaction reaction = PersonReaction::kRegular;
  std::uint32_t goals = 0;
  std::optional<PersonId> leader = {};
  bool operator==(const PersonDescription&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"root", &PersonDescription::root, "the body, without joints; its name is the person's"},
        Field{"radius", &PersonDescription::radius, "no part of the body is farther from its axis"}
            .In("m")
            .Above(0)
            .AtMost(kMaxPersonRadius),
        Field{"speed", &PersonDescription::speed, "without an obstacle"}.In("m/s").Within(0, kMaxPersonSpeed),
        Field{"max_speed", &PersonDescription::max_speed}.In("m/s").Within(0, kMaxPersonSpeed),
        Field{"reaction", &PersonDescription::reaction, "to robots"},
        Field{"goals", &PersonDescription::goals, "its first goal set"},
        Field{"leader", &PersonDescription::leader, "with whom it walks, to the leader's goals"},
    };
  }
};

// People that come at a rate, each with the next free body among the visitors of the flow.
struct VisitorFlow {
  std::string name;
  std::vector<double> times;
  std::vector<double> per_hour;
  bool is_random = true;
  bool operator==(const VisitorFlow&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"name", &VisitorFlow::name},
        Field{"times", &VisitorFlow::times, "of the time table, ascending from 0"}.In("s"),
        Field{"per_hour", &VisitorFlow::per_hour, "groups or single people that come, from each of these times on"},
        Field{"random", &VisitorFlow::is_random, "they come at random times, drawn by the seed; else evenly"},
    };
  }
};
inline constexpr double kMaxVisitorsPerHour = 36'000.0;

// A person that is not in the world all the time: it enters at the pose of its model at load, and leaves at an exit
// (WorldDescription::exits). While it is away, its body is far below the world (IsAway).
struct VisitorDescription {
  PersonId person;
  std::optional<std::uint32_t> flow = {};
  double enters_at = 0.0;
  std::vector<Vec2> track = {};
  std::vector<double> track_times = {};
  bool operator==(const VisitorDescription&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"person", &VisitorDescription::person},
        Field{"flow", &VisitorDescription::flow,
              "with which it comes, in WorldDescription::visitor_flows; none: once, at a time"},
        Field{"enters_at", &VisitorDescription::enters_at, "simulated, of one without a flow"}.In("s").AtLeast(0),
        Field{"track", &VisitorDescription::track, "recorded positions in W, which it follows; none: it has goals"}.In(
            "m"),
        Field{"track_times", &VisitorDescription::track_times, "of these, ascending; it leaves after the last"}.In("s"),
    };
  }
};

// The position at a time on a track, m in W: straight between its points, at rest before and after them. REQUIRES: the
// visitor has a track.
Vec2 TrackAt(const VisitorDescription& visitor, double seconds);

}  // namespace troupe
