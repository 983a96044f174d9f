// PastAnswers: the answers to questions of viewers about the past of a run or a recording: states to show, data for
// plots, totals and verdicts. The journal of a run is read when the past lacks states.
//
// All questions are answered on one thread, because a timeline steps one state at a time; no answer takes longer than
// kMaxPastAnswer beyond the state it needs, so that seeks remain quick while a long series is computed.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <memory>
#include <variant>

#include "recording/timeline/timeline.h"
#include "viewer/gateway/expectation_rows.h"
#include "viewer/gateway/page_request.h"
#include "viewer/gateway/past_reader.h"
#include "viewer/gateway/run_feed.h"
#include "viewer/gateway/viewer_gateway.h"

namespace troupe {

struct JournalRequest {};  // to read it
// A number is a position to seek to.
using PastQuestion = std::variant<std::uint64_t, SeriesRequest, TotalsRequest, ExpectationsRequest, JournalRequest>;
using FoundState = Result<SharedState>;
using PastAnswer = std::variant<std::monostate, FoundState, PageReply>;

class PastAnswers {
 public:
  // `link`: null: the past is that of a recording. All outlive this.
  PastAnswers(Timeline& past, RunLink* link, RunFeed& feed, const ShownExpectations& expectations)
      : past_(past), link_(link), feed_(feed), reader_(past), rows_(past, expectations) {}

  // On one thread.
  PastAnswer Answer(const PastQuestion& question);
  // Whether a JournalRequest is to be asked: none waits. On any thread.
  bool WantsJournal() { return !reads_journal_.exchange(true); }

 private:
  FoundState Find(std::uint64_t position);
  void ReadJournal();

  Timeline& past_;
  RunLink* const link_;
  RunFeed& feed_;
  PastReader reader_;
  ExpectationRows rows_;
  std::chrono::steady_clock::time_point journal_at_;  // it is not read again earlier
  std::atomic<bool> reads_journal_ = false;
};

}  // namespace troupe
