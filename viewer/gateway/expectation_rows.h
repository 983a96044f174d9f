// ExpectationRows: the verdicts of expectations over the past of a run, for the rows under the timeline of the page.
// They are computed from its states, a bounded part in each call: the page asks for the rest. So a live run, its
// recording and a viewer that seeks see the same.
//
// States are judged in order and once each, by the monitors of `troupe test` (testing/expectations). A row keeps at
// most 256 marks: when they are full every second one is dropped and the stride doubles, so memory and messages do not
// grow with the length of the run. After an edit later states are not judged: they belong to another run.
//
// Threads: one at a time, that of Timeline::At.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/spatial/body_index.h"
#include "recording/timeline/timeline.h"
#include "troupe/expectation.h"
#include "viewer/gateway/page_request.h"

namespace troupe {

struct ShownExpectations {
  std::vector<NamedExpectation> list;
  std::vector<NamedRegion> regions;  // that they name
};
// For a page that judges them itself.
nlohmann::json ToJson(const ShownExpectations& expectations);
// The inverse.
Result<ShownExpectations> ShownExpectationsFromJson(std::string_view text);

class ExpectationRows {
 public:
  // The past outlives the rows.
  ExpectationRows(Timeline& past, ShownExpectations expectations);

  // {"complete", "from": position and "from_tick": of the first state, "to": position of the last judged one,
  // "problem_at": why later states are not judged, or "", "rows": [{"name", "text", "problem": why it is not judged, or
  // "", "verdict": "true", "false" or "undecided", "at_end": whether it holds if the run ends there, "decided":
  // position after which the verdict was known, or null, "cause": position that decides the robustness, or null,
  // "names": of the robots that do, "robustness": [least, greatest], null: infinite, "spans": [[position, mark],
  // ...]}]}. A mark counts from its position to the next one: 0: not decided, and the awaited event has not happened;
  // 1: it holds if the run ends there; 2: violated. Not complete: ask again.
  PageReply Answer(const ExpectationsRequest& request);

 private:
  struct Row {
    NamedExpectation shown;
    std::optional<Monitor> monitor = {};
    std::string problem = {};
    std::vector<std::uint8_t> marks = {};                // at every stride_-th state, until it is decided
    std::optional<std::uint64_t> decided_position = {};  // nothing: it is open
  };

  // Whether what was judged is a part of the past as it is now.
  bool Continues(const TimeSpans& spans);
  void Begin(const SharedState& state);
  void Add(const SharedState& state);
  void Push(Row& row, const TimelineState& state);
  nlohmann::json Describe(const Row& row) const;

  Timeline& past_;
  std::vector<NamedRegion> regions_;
  std::vector<Row> rows_;
  std::optional<BodyIndex> bodies_;  // of the world of last_
  SharedState first_;                // that is judged; null: none
  SharedState last_;
  std::uint64_t next_ = 0;    // position
  std::uint64_t stride_ = 1;  // states from one mark to the next
  std::string stopped_;       // why the states from next_ on are not judged; empty: they are
};

}  // namespace troupe
