// PastAnswers: the answers to questions of viewers about the past of a run or a recording: states to show, series of
// signals for plots, totals of robots, and verdicts. They are computed from its states, a bounded part in each call:
// the page asks for the rest. The journal of a run is read when the past lacks states.
//
// Totals continue from call to call as long as the past is the same run; after a rewind or another run they begin
// again. Their distances are sums over the states that are known: gaps in the past count as straight lines within an
// edition.
//
// All questions are answered on one thread, that of Timeline::At, because a timeline steps one state at a time; no
// answer takes longer than kMaxPastAnswer beyond the state it needs, so that seeks remain quick while a long series is
// computed.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <variant>

#include "common/signals/traffic_totals.h"
#include "recording/timeline/timeline.h"
#include "viewer/gateway/expectation_rows.h"
#include "viewer/gateway/page_request.h"
#include "viewer/gateway/run_feed.h"
#include "viewer/gateway/signals.h"
#include "viewer/gateway/viewer_gateway.h"

namespace troupe {

struct JournalRequest {};  // to read it
// A number is a position to seek to.
using PastQuestion =
    std::variant<std::uint64_t, SeriesRequest, TotalsRequest, ExpectationsRequest, VehicleRequest, JournalRequest>;
using FoundState = Result<SharedState>;
using PastAnswer = std::variant<std::monostate, FoundState, PageReply>;

class PastAnswers {
 public:
  // `link`: null: the past is that of a recording. All outlive this.
  PastAnswers(Timeline& past, RunLink* link, RunFeed& feed, const ShownExpectations& expectations)
      : past_(past), link_(link), feed_(feed), rows_(past, expectations) {}

  // On one thread.
  PastAnswer Answer(const PastQuestion& question);
  // Whether a JournalRequest is to be asked: none waits. On any thread.
  bool WantsJournal() { return !reads_journal_.exchange(true); }

 private:
  struct RobotTotals {
    double distance = 0.0;  // m
    double energy = 0.0;    // J
    bool has_store = false;
  };

  // The state at a position; the error is for the viewer.
  FoundState Find(std::uint64_t position);
  // Reading costs time in proportion to the run, so it is not repeated earlier than kJournalShare times its duration.
  void ReadJournal();

  // The values of signals at the states from a position to another one, each `every`-th: {"ticks", "positions",
  // "values": [of each signal; null: none]}, and "next": the position with which to go on, null at the end. Positions
  // without a state have no values. Without signals: {"tables"}, the signals that there are (SignalReader::Describe).
  PageReply Series(const SeriesRequest& request);

  // What each robot has done from the first state on: {"complete", "first_tick", "last_tick", "seconds", "robots":
  // [{"name", "distance" m, "energy" J that it has used, if it has a store that can be empty}], "traffic", "waits": as
  // in the summary of a run}. Not complete: ask again.
  PageReply Totals(const TotalsRequest& request);
  // {"state": text}; "": none is known.
  PageReply VehicleState(const VehicleRequest& request);
  void AddToTotals(const SharedState& state);
  // Whether the totals belong to the past as it is now.
  bool TotalsContinue(const TimeSpans& spans);

  Timeline& past_;
  RunLink* const link_;
  RunFeed& feed_;
  ExpectationRows rows_;
  std::chrono::steady_clock::time_point journal_at_;  // it is not read again earlier
  std::atomic<bool> reads_journal_ = false;
  SignalReader signals_;
  std::map<std::string, RobotTotals> totals_;  // by robot
  TrafficTotals traffic_;
  SharedState first_;  // that the totals have; null: none
  SharedState last_;
  std::uint64_t next_ = 0;        // position
  std::optional<Things> things_;  // of the world of last_
};

}  // namespace troupe
