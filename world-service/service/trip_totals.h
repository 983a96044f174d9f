// TripTotals: the outcome of a problem of multi-agent paths, for the summary: an observer of the traffic's robots.
//
// A robot visits its goals in their order, by the vertices that the traffic knows it at, and arrives when it is at the
// last one; a robot that makes room for another one there arrives again when it is back. Times count from the newest
// fresh start, or from the tick at which a service continues a run. Cost: a look at each robot of the traffic a tick.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "common/spatial/scene.h"
#include "troupe/fields.h"
#include "world-service/service/run_observer.h"

namespace troupe {

// The figures of papers about multi-agent paths, in seconds.
struct TripSummary {
  std::uint64_t robots = 0;   // with a trip
  std::uint64_t arrived = 0;  // of them, at their last goals
  std::uint64_t goals = 0;    // that have been visited, by all
  double makespan = 0.0;      // s, until the last one of these arrived
  double flow_time = 0.0;     // s, the sum of the times until each of these arrived
  double throughput = 0.0;    // goals a s, from the start to the last tick
  bool operator==(const TripSummary&) const = default;
  static constexpr auto Fields() {
    return std::tuple{
        Field{"robots", &TripSummary::robots},       Field{"arrived", &TripSummary::arrived},
        Field{"goals", &TripSummary::goals},         Field{"makespan", &TripSummary::makespan},
        Field{"flow_time", &TripSummary::flow_time}, Field{"throughput", &TripSummary::throughput},
    };
  }
};

class TripTotals : public RunObserver {
 public:
  Status OnBegin(const RunStart& start) override;
  void OnWorldChange(const std::shared_ptr<const Scene>& scene, Edition edition) override;
  Status OnTick(const CommittedTick& tick) override;

  // After the run; nothing for a world without trips.
  std::optional<TripSummary> Collect() const;

 private:
  struct Progress {
    std::size_t visited = 0;  // goals
    std::optional<Tick> arrived_at = {};
  };

  std::shared_ptr<const Scene> scene_;
  std::optional<Tick> since_;
  Tick now_ = 0;
  std::vector<Progress> trips_;  // by trip of the world
};

}  // namespace troupe
