#include "viewer/gateway/expectation_rows.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <nlohmann/json.hpp>
#include <span>
#include <utility>

#include "common/base/json_reader.h"
#include "testing/expectations/tick_view.h"

namespace troupe {
namespace {

using Clock = std::chrono::steady_clock;
using Json = nlohmann::json;

// Of a row; there are at least half as many, because then the stride is doubled.
constexpr std::size_t kMaxMarks = 256;

enum RowMark : std::uint8_t { kOpen = 0, kHolds = 1, kViolated = 2 };

// By value: the monitor itself goes on.
bool HoldsAtEnd(Monitor monitor) {
  monitor.Finish();
  return monitor.verdict() == Verdict::kTrue;
}

// An undecided expectation is shown by the outcome that it would have if the run ended now.
RowMark MarkOf(const Monitor& monitor) {
  if (monitor.verdict() == Verdict::kUndecided) return HoldsAtEnd(monitor) ? kHolds : kOpen;
  return monitor.verdict() == Verdict::kTrue ? kHolds : kViolated;
}

}  // namespace

// Short lists in place of objects: the static page has them in its text.
Json ToJson(const ShownExpectations& expectations) {
  Json list = Json::array();
  for (const NamedExpectation& each : expectations.list) list.push_back({each.name, each.text});
  Json regions = Json::array();
  for (const NamedRegion& region : expectations.regions) {
    Json outline = Json::array();
    for (const Vec2& vertex : region.outline) outline.push_back({vertex.x(), vertex.y()});
    regions.push_back({region.name, std::move(outline), region.z ? Json(*region.z) : Json(nullptr)});
  }
  return {{"list", std::move(list)}, {"regions", std::move(regions)}};
}

Result<ShownExpectations> ShownExpectationsFromJson(std::string_view text) {
  const JsonReader json = JsonReader::OfText(text);
  ShownExpectations expectations;
  for (const JsonReader& each : json.ItemsOf("list")) {
    std::vector<std::string> pair;
    if (each.To(pair) && pair.size() == 2) expectations.list.push_back({pair[0], pair[1]});
  }
  for (const JsonReader& each : json.ItemsOf("regions")) {
    const std::vector<JsonReader> parts = each.Items();
    if (parts.size() != 3) each.Fail("a name, an outline and a height or null");
    if (!json.ok()) break;
    NamedRegion& region = expectations.regions.emplace_back();
    parts[0].To(region.name);
    parts[1].To(region.outline);
    parts[2].To(region.z);
  }
  if (!json.ok()) return json.status().error();
  return expectations;
}

ExpectationRows::ExpectationRows(Timeline& past, ShownExpectations expectations)
    : past_(past), regions_(std::move(expectations.regions)) {
  for (NamedExpectation& shown : expectations.list) rows_.push_back({std::move(shown)});
}

// A rewind shortens the past, and another run replaces it: both begin again.
bool ExpectationRows::Continues(const TimeSpans& spans) {
  if (first_ == nullptr || spans.first() > next_ || spans.last() < last_->position) return false;
  const Result<SharedState> last = past_.At(spans.last());
  return last.ok() && last.value()->world->run == first_->world->run;
}

// An expectation that cannot be parsed for this world, for instance of a robot that it has not, is a row with a
// problem.
void ExpectationRows::Begin(const SharedState& state) {
  const WorldDescription& world = state->world->description();
  bodies_.emplace(*state->world->scene);
  stride_ = 1;
  stopped_.clear();
  first_ = state;
  for (Row& row : rows_) {
    row = {std::move(row.shown)};
    const Result<Expectation> expectation = Expectation::Parse(row.shown.text, {world, regions_});
    if (expectation.ok()) {
      row.monitor.emplace(expectation.value());
    } else {
      row.problem = expectation.error().message;
    }
  }
}

// An edit makes another run of it, which only a return to the start makes comparable again.
void ExpectationRows::Add(const SharedState& state) {
  const bool follows = last_ != nullptr && state->edition == last_->edition && state->world == last_->world &&
                       state->state->tick == last_->state->tick + 1;
  if (last_ == nullptr || (!follows && state->state->tick == 0)) {
    Begin(state);
  } else if (!follows && stopped_.empty()) {
    stopped_ = "the world was changed at tick " + std::to_string(state->state->tick);
  }
  if (stopped_.empty()) {
    const std::uint64_t count = state->position - first_->position;
    if (count / stride_ >= kMaxMarks) {
      // Positions of marks are multiples of the stride from the first state, so the even ones remain.
      stride_ *= 2;
      for (Row& row : rows_) {
        std::size_t kept = 0;
        for (std::size_t i = 0; i < row.marks.size(); i += 2) row.marks[kept++] = row.marks[i];
        row.marks.resize(kept);
      }
    }
    bodies_->Assign(*state->state);
    for (Row& row : rows_) Push(row, *state);
  }
  last_ = state;
}

void ExpectationRows::Push(Row& row, const TimelineState& state) {
  if (!row.monitor) return;
  // The events of the first state are of no step.
  const bool has_events = state.events != nullptr && state.position != first_->position;
  const TickView view{*state.world->scene, *bodies_, *state.state,
                      has_events ? std::span<const Event>(*state.events) : std::span<const Event>()};
  if (Status failure = row.monitor->Push(view); !failure.ok()) {
    row.problem = failure.error().message;
    row.monitor.reset();
    return;
  }
  if (row.decided_position) return;
  if (row.monitor->verdict() != Verdict::kUndecided) row.decided_position = state.position;
  if ((state.position - first_->position) % stride_ == 0) row.marks.push_back(MarkOf(*row.monitor));
}

// At most kMaxPastAnswer for the states; the page shows the rows so far and asks again.
PageReply ExpectationRows::Answer(const ExpectationsRequest& request) {
  const std::shared_ptr<const TimeSpans> spans = past_.Spans();
  if (spans->empty()) return ReplyToEdit(request.id, Failure("there is no past state"));
  if (!Continues(*spans)) {
    first_ = last_ = nullptr;
    next_ = spans->first();
  }
  const auto start = Clock::now();
  bool is_missing = false;  // the next state was not received yet
  for (; next_ <= spans->last() && Clock::now() - start < kMaxPastAnswer; ++next_) {
    const Result<SharedState> found = past_.At(next_);
    if (!found.ok()) return ReplyToEdit(request.id, found.error());
    is_missing = found.value()->position != next_;
    if (is_missing) break;
    Add(found.value());
  }
  if (first_ == nullptr) return ReplyToEdit(request.id, Failure("there is no past state"));
  Json rows = Json::array();
  for (const Row& row : rows_) rows.push_back(Describe(row));
  return ReplyToEdit(request.id, Json{{"complete", is_missing || next_ > spans->last()},
                                      {"from", first_->position},
                                      {"from_tick", first_->state->tick},
                                      {"to", last_->position},
                                      {"problem_at", stopped_},
                                      {"rows", std::move(rows)}});
}

// Of an open row the cause is that of its end now.
Json ExpectationRows::Describe(const Row& row) const {
  Json json = {{"name", row.shown.name}, {"text", row.shown.text}, {"problem", row.problem}};
  if (!row.monitor) return json;
  const bool is_open = row.monitor->verdict() == Verdict::kUndecided;
  Monitor end = *row.monitor;
  end.Finish();
  const Monitor::Cause cause = (is_open ? end : *row.monitor).cause();
  const Interval bounds = row.monitor->robustness_bounds();
  Json spans = Json::array();
  const auto add = [&](std::uint64_t position, RowMark mark) {
    if (spans.empty() || spans.back()[1] != mark) spans.push_back({position, mark});
  };
  for (std::size_t i = 0; i < row.marks.size(); ++i) {
    const std::uint64_t position = first_->position + i * stride_;
    if (row.decided_position && position >= *row.decided_position) break;
    add(position, static_cast<RowMark>(row.marks[i]));
  }
  if (row.decided_position) add(*row.decided_position, MarkOf(*row.monitor));
  json["verdict"] = NameOf(row.monitor->verdict());
  json["at_end"] = end.verdict() == Verdict::kTrue;
  json["decided"] = row.decided_position ? Json(*row.decided_position) : Json();
  json["cause"] = cause.tick ? Json(first_->position + (*cause.tick - first_->state->tick)) : Json();
  json["names"] = cause.names;
  json["robustness"] = {NumberOrNull(bounds.min), NumberOrNull(bounds.max)};
  json["spans"] = std::move(spans);
  return json;
}

}  // namespace troupe
