#include "world-service/replay/stepped_timeline.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace troupe {
namespace {

// The last state of a vehicle in a proposal; null: none.
const FleetMessage* StateIn(const Proposal& proposal) {
  const auto last = std::find_if(proposal.fleet.rbegin(), proposal.fleet.rend(),
                                 [](const FleetMessage& message) { return message.topic == FleetTopic::kState; });
  return last != proposal.fleet.rend() ? &*last : nullptr;
}

}  // namespace

Result<std::unique_ptr<SteppedTimeline>> SteppedTimeline::Create(Recording recording, WorldCache& worlds,
                                                                 std::size_t max_kept_bytes) {
  if (Status other = CheckStepVersion(recording); !other.ok()) return other.error();
  std::unique_ptr<SteppedTimeline> timeline(new SteppedTimeline(std::move(recording), worlds, max_kept_bytes));
  std::optional<std::string>& damage = timeline->damage_;
  damage = timeline->ReadTicks();
  if (!damage && timeline->recording_.damage()) damage = timeline->recording_.damage()->problem;
  if (timeline->spans_->empty()) {
    return Error{{timeline->recording_.name()},
                 fmt::format("found no tick: {}", damage.value_or("the recording is empty"))};
  }
  return timeline;
}

std::optional<std::string> SteppedTimeline::ReadTicks() {
  auto spans = std::make_shared<TimeSpans>();
  spans_ = spans;
  TickReader reader(recording_);
  RecordedTick tick;
  std::optional<ReplayedWorld> edited;  // nothing: the world is that of the start
  std::uint64_t events = 0;
  for (;;) {
    const Result<bool> more = reader.Next(tick);
    if (!more.ok()) return more.error().message;
    if (!more.value()) return std::nullopt;
    if (tick.edit) {
      if (!edited) edited.emplace(std::make_shared<const Scene>(recording_.run().world));
      if (Status problem = edited->ApplyAlone(tick.number, *tick.edit); !problem.ok()) return problem.error().message;
    }
    const WorldDescription& world = edited ? edited->world() : recording_.run().world;
    for (const Event& event : tick.events) {
      events_.push_back({++events, tick.number, event, NamesIn(world, event)});
      if (events_.size() > kEventsKept) events_.pop_front();
    }
    for (const Proposal& proposal : tick.proposals) {
      if (StateIn(proposal) == nullptr || proposal.robot.index() >= world.robots.size()) continue;
      vehicle_states_[world.robot(proposal.robot).name].push_back({tick.number, proposal.robot});
    }
    spans->Add(tick.number, tick.tick, tick.edition);
  }
}

Result<std::string> SteppedTimeline::VehicleStateAt(const std::string& robot, std::uint64_t position) {
  const auto found = vehicle_states_.find(robot);
  if (found == vehicle_states_.end()) return std::string();
  const auto after = std::partition_point(found->second.begin(), found->second.end(),
                                          [&](const SentState& sent) { return sent.number <= position; });
  if (after == found->second.begin()) return std::string();
  const SentState& newest = *std::prev(after);
  TickReader reader(recording_, recording_.KeyframeUpTo(newest.number));
  for (RecordedTick tick;;) {
    const Result<bool> more = reader.Next(tick);
    if (!more.ok()) return more.error();
    if (!more.value()) return std::string();
    if (tick.number != newest.number) continue;
    const auto proposal = std::find_if(tick.proposals.begin(), tick.proposals.end(),
                                       [&](const Proposal& each) { return each.robot == newest.robot; });
    const FleetMessage* const sent = proposal != tick.proposals.end() ? StateIn(*proposal) : nullptr;
    return sent != nullptr ? sent->text : std::string();
  }
}

Result<SharedState> SteppedTimeline::At(std::uint64_t position) {
  position = std::min(position, spans_->last());
  if (SharedState kept = kept_.Find(position)) return kept;
  if (Status failure = Seek(position); !failure.ok()) {
    return Error{{recording_.name()}, failure.error().message + " (troupe replay tells more)", ErrorCode::kFailure};
  }
  return kept_.Find(position);
}

Status SteppedTimeline::Seek(std::uint64_t position) {
  if (!cursor_) cursor_.emplace(recording_);
  if (Status failure = cursor_->Approach(position); !failure.ok()) return failure;
  if (cursor_->has_state()) Keep();  // a dropped one may be asked for again
  while (!cursor_->has_state() || cursor_->position() < position) {
    if (Status failure = cursor_->StepTo(cursor_->has_state() ? cursor_->position() + 1 : 0); !failure.ok()) {
      return failure;
    }
    Keep();
  }
  return {};
}

void SteppedTimeline::Keep() {
  const ReplayedWorld& world = cursor_->world();
  const RecordedTick& tick = cursor_->tick();
  if (kept_.Find(tick.number) != nullptr) return;
  TimelineState state{tick.number,        WorldOf(world), std::make_shared<const WorldState>(world.state()),
                      world.state_hash(), tick.edition,   {}};
  if (!tick.events.empty()) state.events = std::make_shared<const std::vector<Event>>(tick.events);
  kept_.Add(std::make_shared<const TimelineState>(std::move(state)));
}

std::shared_ptr<const TimelineWorld> SteppedTimeline::WorldOf(const ReplayedWorld& replayed) {
  const std::shared_ptr<const Scene>& scene = replayed.scene();
  // States of one world share it by pointer: viewers compare the pointers to see whether to send the world again.
  if (newest_world_ != nullptr && newest_scene_.lock() == scene) return newest_world_;
  SessionMessage session;
  session.run = run();
  session.world = troupe::WorldOf(scene);
  session.world_edition = replayed.world_edition();
  newest_scene_ = scene;
  newest_world_ = worlds_.Of(session, scene);
  if (std::find(were_shown_.begin(), were_shown_.end(), newest_world_) == were_shown_.end()) {
    were_shown_.push_back(newest_world_);
  }
  return newest_world_;
}

}  // namespace troupe
