// PastReader: the answers to questions of pages about the past of a run: series of signals, and totals of robots. They
// are computed from its states, a bounded part in each call: the page asks for the rest.
//
// Totals continue from call to call as long as the past is the same run; after a rewind or another run they begin
// again. Their distances are sums over the states that are known: gaps in the past count as straight lines within an
// edition.
//
// Threads: one at a time, that of Timeline::At.
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "recording/timeline/timeline.h"
#include "viewer/gateway/page_request.h"
#include "viewer/gateway/signals.h"

namespace troupe {

// Of the answer to one question about the past: seeks wait for it.
inline constexpr auto kMaxPastAnswer = std::chrono::milliseconds(40);

// JSON has no infinite numbers.
nlohmann::json NumberOrNull(double value);

class PastReader {
 public:
  // The past outlives the reader.
  explicit PastReader(Timeline& past) : past_(past) {}

  // The values of signals at the states from a position to another one, each `every`-th: {"ticks", "positions",
  // "values": [of each signal; null: none]}, and "next": the position with which to go on, null at the end. Positions
  // without a state have no values. Without signals: {"tables"}, the signals that there are (SignalReader::Describe).
  PageReply Series(const SeriesRequest& request);

  // What each robot has done from the first state on: {"complete", "first_tick", "last_tick", "seconds", "robots":
  // [{"name", "distance" m, "energy" J that it has used, if it has a store that can be empty}]}. Not complete: ask
  // again.
  PageReply Totals(const TotalsRequest& request);

 private:
  struct RobotTotals {
    double distance = 0.0;  // m
    double energy = 0.0;    // J
    bool has_store = false;
  };
  void Add(const SharedState& state);
  // Whether the totals belong to the past as it is now.
  bool TotalsContinue(const TimeSpans& spans);

  Timeline& past_;
  SignalReader signals_;
  std::map<std::string, RobotTotals> totals_;  // by robot
  SharedState first_;                          // that the totals have; null: none
  SharedState last_;
  std::uint64_t next_ = 0;        // position
  std::optional<Things> things_;  // of the world of last_
};

}  // namespace troupe
