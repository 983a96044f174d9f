// TrafficTotals: what the traffic of robots on lanes has come to in a part of a run: arrivals, the share of time in
// which robots move, and the waits at each lane, door and lift. It adds up the states of the ticks, one after another,
// so that a live run, its past and a recording have the same totals.
//
// Arrivals and motion are of robots that take part in the planned traffic, waits of all that wait (RobotWait). Costs
// one pass over these rows for each state.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/model/states.h"
#include "troupe/fields.h"
#include "troupe/world_state.h"

namespace troupe {

struct TrafficTotal {
  std::uint64_t robots = 0;    // that took part in the planned traffic
  double seconds = 0.0;        // of the part of the run
  std::uint64_t arrivals = 0;  // at goals
  double arrivals_per_hour = 0.0;
  double utilisation = 0.0;  // the share of robots' time in which they moved with a goal
  double waiting = 0.0;      // the share in which they waited on their ways
  bool operator==(const TrafficTotal&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"robots", &TrafficTotal::robots},           Field{"seconds", &TrafficTotal::seconds},
        Field{"arrivals", &TrafficTotal::arrivals},       Field{"arrivals_per_hour", &TrafficTotal::arrivals_per_hour},
        Field{"utilisation", &TrafficTotal::utilisation}, Field{"waiting", &TrafficTotal::waiting},
    };
  }
};

// The waits of robots at one place.
struct PlaceWaits {
  std::string kind;         // "lane", "door" or "lift"
  std::string place;        // its name
  double seconds = 0.0;     // of all robots together
  double longest = 0.0;     // s: the longest wait of a robot of which a part was there
  std::uint64_t waits = 0;  // number
  bool operator==(const PlaceWaits&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"kind", &PlaceWaits::kind},       Field{"place", &PlaceWaits::place},
        Field{"seconds", &PlaceWaits::seconds}, Field{"longest", &PlaceWaits::longest},
        Field{"waits", &PlaceWaits::waits},
    };
  }
};

class TrafficTotals {
 public:
  // The state after the one before; ticks between them that are not known count as those of `state`. One of the
  // same tick does not count, and one of an earlier tick begins anew. REQUIRES: the state is of the world
  void Add(const WorldDescription& world, const WorldState& state);
  void Clear() { *this = {}; }

  TrafficTotal total() const;
  // The places of each kind with the most waiting, at most so many of each: lanes, then doors, then lifts.
  std::vector<PlaceWaits> FindWaits(const WorldDescription& world, std::size_t most_of_kind) const;

 private:
  struct Place {
    int kind = 0;  // in the order of FindWaits
    std::size_t number = 0;
    auto operator<=>(const Place&) const = default;
  };
  struct Waits {
    std::uint64_t ticks = 0;
    Tick longest = 0;
    std::uint64_t count = 0;
  };
  // A wait of the newest state, and its places.
  struct Known {
    RobotId robot;
    Tick since = 0;
    std::optional<Place> lane = {};
    std::optional<Place> thing = {};
  };

  void CountRobots(const WorldState& state, std::uint64_t ticks);
  void CountWaits(const WorldDescription& world, const WorldState& state, std::uint64_t ticks);
  void Count(const Place& place, Tick duration, std::uint64_t ticks, bool is_new);

  std::optional<Tick> tick_;  // of the newest state
  double interval_ = 0.0;     // s
  std::uint64_t ticks_ = 0;
  std::map<RobotId, std::uint32_t> arrivals_at_;  // of each robot at the newest state
  std::uint64_t arrivals_ = 0;
  std::uint64_t robot_ticks_ = 0;
  std::uint64_t moving_ticks_ = 0;
  std::uint64_t waiting_ticks_ = 0;
  std::vector<Known> known_;  // ascending by robot
  std::map<Place, Waits> waits_;
};

}  // namespace troupe
