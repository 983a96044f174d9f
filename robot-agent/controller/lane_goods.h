// LaneGoods: the goods that a robot on lanes brings from place to place, as the world gives it jobs
// (world-service/core/goods.cc).
//
// The robot says in each tick whether it may get a job, and when it has loaded and delivered, by a JobOrder. What it
// has to do it reads from the frame.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "troupe/controller.h"
#include "troupe/world_state.h"

namespace troupe {

class LaneGoods {
 public:
  // The graph outlives this.
  explicit LaneGoods(const LaneGraph& graph) : graph_(&graph) {}

  void Watch(const WorldDescription& world, const WorldState& state, RobotId own);

  // Where it goes; nothing: it has no job, or its lanes do not have the place.
  std::optional<std::size_t> target() const { return target_; }
  bool has_job() const { return job_.has_value(); }
  // It has been at the target for `rested` s.
  void Rest(double rested);
  // It cannot get there: if it has not loaded yet, another robot may.
  void GiveUp(double time);
  // Of this tick; nothing: it takes no jobs. `may_take`: it does nothing else.
  std::optional<JobOrder> OrderFor(double time, bool may_take);
  // A text for the log, once for each such job.
  std::optional<std::string> TakeReport();

 private:
  struct Work {
    std::uint32_t flow = 0;
    std::uint32_t number = 0;
    bool is_loaded = false;
    bool operator==(const Work&) const = default;
  };

  const LaneGraph* graph_;
  std::optional<Work> job_;
  std::optional<std::size_t> target_;
  double seconds_ = 0.0;  // at the target, to load or unload
  JobOrder order_;
  double after_ = 0.0;  // s: no job before
  bool leaves_out_ = false;
  std::optional<Work> reported_;
  std::string missing_;  // the place that its lanes do not have
};

}  // namespace troupe
