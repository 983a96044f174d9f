#include "viewer/gateway/past_answers.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "common/base/json.h"

namespace troupe {
namespace {

// At least between two readings of the journal.
constexpr auto kJournalPeriod = std::chrono::seconds(2);

using Clock = std::chrono::steady_clock;
using Json = nlohmann::json;

constexpr std::size_t kMaxSamples = 2000;
constexpr std::size_t kWaitPlaces = 3;  // of each kind

PageReply Reply(std::uint64_t id, Json text, const std::string& problem = "") {
  text["type"] = "reply";
  text["id"] = id;
  text["done"] = problem.empty();
  text["problem"] = problem;
  return {id, problem.empty(), problem, JsonText(text)};
}

}  // namespace

// A JournalRequest is the one question without an answer.
PastAnswer PastAnswers::Answer(const PastQuestion& question) {
  if (const auto* series = std::get_if<SeriesRequest>(&question)) return Series(*series);
  if (const auto* totals = std::get_if<TotalsRequest>(&question)) return Totals(*totals);
  if (const auto* expectations = std::get_if<ExpectationsRequest>(&question)) return rows_.Answer(*expectations);
  if (const auto* vehicle = std::get_if<VehicleRequest>(&question)) return VehicleState(*vehicle);
  if (const auto* position = std::get_if<std::uint64_t>(&question)) return Find(*position);
  if (link_ != nullptr) ReadJournal();
  reads_journal_ = false;
  return std::monostate();
}

FoundState PastAnswers::Find(std::uint64_t position) {
  FoundState found = past_.At(position);
  // A state that is not kept any more may be in the journal by now.
  if (link_ != nullptr && found.ok() && found.value()->position != position) {
    ReadJournal();
    found = past_.At(position);
  }
  return found;
}

// Rarely: the whole journal is read, on and on.
void PastAnswers::ReadJournal() {
  const auto start = Clock::now();
  if (start < journal_at_) return;
  feed_.SetRecorded(link_->ReadJournal(feed_.worlds()));
  const auto end = Clock::now();
  journal_at_ = end + std::max<Clock::duration>(kJournalPeriod, kJournalShare * (end - start));
}

// A bounded number of samples for a bounded time, and the position to go on with.
PageReply PastAnswers::Series(const SeriesRequest& request) {
  const std::shared_ptr<const TimeSpans> spans = past_.Spans();
  if (spans->empty()) return Reply(request.id, Json::object(), "there is no past state");
  if (request.signals.empty()) {
    const Result<SharedState> found = past_.At(spans->last());
    if (!found.ok()) return Reply(request.id, Json::object(), found.error().ToString());
    signals_.SetState(found.value());
    return Reply(request.id, {{"tables", signals_.Describe()}});
  }
  Json ticks = Json::array();
  Json positions = Json::array();
  std::vector<Json> values(request.signals.size(), Json::array());
  std::uint64_t at = request.from;
  // On the grid of the request, so that a plot whose oldest states were dropped meanwhile keeps its sample times.
  if (at < spans->first()) at += (spans->first() - at + request.every - 1) / request.every * request.every;
  const std::uint64_t to = std::min(request.to, spans->last());
  const auto start = Clock::now();
  for (; at <= to && ticks.size() < kMaxSamples && Clock::now() - start < kMaxPastAnswer; at += request.every) {
    Result<SharedState> found = past_.At(at);
    if (!found.ok()) return Reply(request.id, Json::object(), found.error().ToString());
    const SharedState& state = found.value();
    if (state->position != at) continue;
    signals_.SetState(state);
    positions.push_back(at);
    ticks.push_back(state->state->tick);
    for (std::size_t i = 0; i < values.size(); ++i)
      values[i].push_back(NumberOrNull(signals_.Value(request.signals[i])));
  }
  Json text = {{"positions", std::move(positions)}, {"ticks", std::move(ticks)}, {"values", std::move(values)}};
  text["next"] = at <= to ? Json(at) : Json();
  return Reply(request.id, std::move(text));
}

// As in ExpectationRows::Continues.
bool PastAnswers::TotalsContinue(const TimeSpans& spans) {
  if (first_ == nullptr) return false;
  if (spans.first() < first_->position || spans.last() + 1 < next_) return false;
  const Result<SharedState> last = past_.At(spans.last());
  return last.ok() && last.value()->world->run == first_->world->run;
}

// Continues where the call before ended.
PageReply PastAnswers::Totals(const TotalsRequest& request) {
  const std::shared_ptr<const TimeSpans> spans = past_.Spans();
  if (spans->empty()) return Reply(request.id, Json::object(), "there is no past state");
  if (!TotalsContinue(*spans)) {
    totals_.clear();
    traffic_.Clear();
    first_ = last_ = nullptr;
    next_ = spans->first();
  }
  const auto start = Clock::now();
  for (; next_ <= spans->last() && Clock::now() - start < kMaxPastAnswer; ++next_) {
    const Result<SharedState> found = past_.At(next_);
    if (!found.ok()) return Reply(request.id, Json::object(), found.error().ToString());
    if (found.value()->position == next_) AddToTotals(found.value());
  }
  if (first_ == nullptr) return Reply(request.id, {{"complete", false}});
  const double interval = last_->world->description().interval_seconds();
  Json robots = Json::array();
  for (const auto& [name, robot] : totals_) {
    Json& row = robots.emplace_back(Json{{"name", name}, {"distance", robot.distance}});
    if (robot.has_store) row["energy"] = robot.energy;
  }
  Json waits = Json::array();
  for (const PlaceWaits& place : traffic_.FindWaits(last_->world->description(), kWaitPlaces)) {
    waits.push_back(FieldsToJson<Json>(place));
  }
  PageReply reply = Reply(request.id, {{"complete", next_ > spans->last()},
                                       {"first_tick", first_->state->tick},
                                       {"last_tick", last_->state->tick},
                                       {"seconds", static_cast<double>(last_->state->tick) * interval},
                                       {"robots", std::move(robots)},
                                       {"traffic", FieldsToJson<Json>(traffic_.total())},
                                       {"waits", std::move(waits)}});
  reply.has_totals = next_ > spans->last();
  return reply;
}

// Of a live run by its journal, which is read again if it ends before the position.
PageReply PastAnswers::VehicleState(const VehicleRequest& request) {
  Result<std::string> state = past_.VehicleStateAt(request.robot, request.position);
  if (link_ != nullptr && feed_.RecordedUpTo() < request.position) {
    ReadJournal();
    state = past_.VehicleStateAt(request.robot, request.position);
  }
  if (!state.ok()) return Reply(request.id, Json::object(), state.error().ToString());
  return Reply(request.id, {{"state", state.value()}});
}

// Between two states of which an edit made the second, nothing was driven or used.
void PastAnswers::AddToTotals(const SharedState& state) {
  const WorldDescription& world = state->world->description();
  const bool is_same_world = last_ != nullptr && last_->world == state->world;
  if (!is_same_world) things_.emplace(world);
  const bool is_step = is_same_world && last_->edition == state->edition && last_->state->tick < state->state->tick;
  const double seconds =
      is_step ? static_cast<double>(state->state->tick - last_->state->tick) * world.interval_seconds() : 0.0;
  for (std::size_t i = 0; i < world.robots.size(); ++i) {
    if (!RobotExists(world, RobotId(i))) continue;
    RobotTotals& robot = totals_[world.robots[i].name];
    const std::vector<std::size_t>& stores = things_->stores_of(RobotId(i));
    robot.has_store = !stores.empty();
    if (!is_step) continue;
    const Pose& now = state->state->robots[i].X_WR;
    const Pose& before = last_->state->robots[i].X_WR;
    robot.distance += std::hypot(now.x - before.x, now.y - before.y);
    for (const std::size_t store : stores) {
      const StoreState& after = state->state->stores[store];
      robot.energy += last_->state->stores[store].joules - after.joules + after.charge_watts * seconds;
    }
  }
  traffic_.Add(world, *state->state);
  if (first_ == nullptr) first_ = state;
  last_ = state;
}

}  // namespace troupe
