#include "viewer/gateway/page_viewer.h"

#include <algorithm>
#include <utility>

#include "viewer/gateway/world_message.h"

namespace troupe {
namespace {

// Of all robots' readings, the part of the time that the gateway may spend on measuring.
constexpr int kMeasuringShare = 4;  // 1 / (1 + 4)
// Between two camera images to a viewer, whatever they cost.
constexpr std::chrono::milliseconds kPicturePeriod{100};

// The flags of an update message.
constexpr std::uint8_t kPausedFlag = 1;
constexpr std::uint8_t kLastFlag = 2;
constexpr std::uint8_t kReadingsFlag = 8;
constexpr std::uint8_t kPastFlag = 16;

std::uint8_t Flag(bool is_set, std::uint8_t flag) {
  return is_set ? flag : 0;
}

static_assert(kMemberCount<Event> == 6, "a new field of an event belongs into the next function, and into protocol.ts");

void Write(ByteWriter& writer, const NumberedEvent& numbered) {
  const Event& event = numbered.event;
  writer.Write(numbered.position);
  writer.Write(event.tick);
  writer.Write(static_cast<std::uint8_t>(event.type));
  for (const std::string& name : {numbered.names.robot, numbered.names.other, numbered.names.object}) {
    writer.WriteText(name);
  }
  writer.WriteText(event.detail);
}

}  // namespace

Result<std::optional<PageRequest>> PageViewer::Receive(std::string_view message, bool) {
  Result<PageRequest> request = ParsePageRequest(message, longest_);
  if (!request.ok()) return request.error();
  if (auto* const select = std::get_if<SelectRequest>(&request.value())) {
    selected_ = std::move(*select);
    selection_is_new_ = true;
    next_pictures_ = {};
    return std::optional<PageRequest>();
  }
  return std::optional<PageRequest>(std::move(request).value());
}

void PageViewer::Answer(PageReply reply) {
  if (waiting_.size() >= kMostReplies) return;
  waiting_.push_back({std::make_shared<const std::string>(std::move(reply.text)), true});
}

void PageViewer::ReturnToLive() {
  Viewer::ReturnToLive();
  update_ = 0;  // its rows are those of the past
}

bool PageViewer::NeedsMessage() const {
  return session_ != run_.session || !waiting_.empty() || NeedsStatus() || NeedsUpdate();
}

// Of the live run, once its world is known.
bool PageViewer::NeedsStatus() const {
  return !in_past_ && run_.status != nullptr && status_ != run_.status && shown() != nullptr &&
         world_ == shown()->world->number;
}

bool PageViewer::NeedsUpdate() const {
  if (shown() == nullptr) return false;
  const bool is_shown = in_past_ ? !past_is_new_ : world_ == shown()->world->number && update_ == run_.update;
  // Of a run that is paused, the readings that its last update left out follow by themselves.
  const bool may_follow = readings_.measures_all || !selected_.all;
  return !is_shown || selection_is_new_ || (readings_missing_ && may_follow && Clock::now() >= next_pictures_);
}

std::optional<WebMessage> PageViewer::Next() {
  if (session_ != run_.session) {
    session_ = run_.session;
    return WebMessage{session_, true};
  }
  if (auto waiting = NextWaiting()) return waiting;
  if (NeedsStatus()) {
    status_ = run_.status;
    return WebMessage{status_, true};
  }
  if (!NeedsUpdate()) return std::nullopt;
  const ViewedWorld& world = *shown()->world;
  if (world_ == world.number) return WebMessage{std::make_shared<const std::string>(MakeUpdate()), false};
  world_ = world.number;
  update_ = 0;
  status_.reset();
  return WebMessage{world.message, false};
}

std::string PageViewer::MakeUpdate() {
  const ViewedState& state = *shown();
  const FeedContent& content = run_.content;
  const bool has_readings = in_past_ || !selected_.all || readings_.measures_all;
  ByteWriter writer;
  writer.Write(static_cast<std::uint8_t>(PageMessage::kUpdate));
  writer.Write(state.world->number);
  writer.Write(static_cast<std::uint8_t>(Flag(in_past_ || content.paused, kPausedFlag) |
                                         Flag(!in_past_ && content.last, kLastFlag) |
                                         Flag(has_readings, kReadingsFlag) | Flag(in_past_, kPastFlag)));
  writer.Write(state.state->tick);
  writer.Write(state.state_hash);
  writer.Write(state.edition);
  // Positions: of this state, of the oldest and of the newest that the viewer can go to.
  const PastStates::Range range = history_.range().value_or(PastStates::Range());
  for (const std::uint64_t position : {state.position, range.first, range.last}) writer.Write(position);
  WriteRows(writer);
  WriteEvents(writer);
  readings_missing_ = !has_readings;
  if (has_readings) WriteReadings(writer);
  if (!in_past_) update_ = run_.update;
  past_is_new_ = selection_is_new_ = false;
  return writer.TakeBytes();
}

void PageViewer::WriteRows(ByteWriter& writer) const {
  if (!in_past_) return run_.rows.Write(writer, update_);
  StateRows rows;  // all of them: the state before may be any
  rows.Assign(shown()->state, 1, true);
  rows.Write(writer, 0);
}

void PageViewer::WriteEvents(ByteWriter& writer) {
  const std::size_t place = writer.ReserveCount();
  std::size_t count = 0;
  for (const NumberedEvent& numbered : run_.content.events) {
    if (numbered.number <= event_) continue;
    Write(writer, numbered);
    event_ = numbered.number;
    ++count;
  }
  writer.FillCount(place, count);
}

std::vector<RobotId> PageViewer::SelectedRobots() const {
  const WorldDescription& world = shown()->world->description();
  std::vector<RobotId> robots;
  if (selected_.all) {
    for (std::size_t i = 0; i < world.robots.size(); ++i) {
      if (IsThere(world, RobotId(i))) robots.emplace_back(i);
    }
    return robots;
  }
  for (const std::string& name : selected_.robots) {
    if (const std::optional<RobotId> robot = FindRobot(world, name)) robots.push_back(*robot);
  }
  return robots;
}

void PageViewer::WriteReadings(ByteWriter& writer) {
  const auto start = Clock::now();
  const WorldDescription& world = shown()->world->description();
  RobotReadings& readings = in_past_ ? readings_.past : readings_.live;
  readings.SetState(shown());
  const std::vector<RobotId> robots = SelectedRobots();
  const bool has_pictures = start >= next_pictures_;
  writer.WriteCount(robots.size());
  for (const RobotId robot : robots) {
    if (world.robot(robot).name != selected_.pictures) {
      readings.Write(writer, robot, Pictures::kNone);
    } else {
      readings_missing_ = readings.Write(writer, robot, has_pictures ? Pictures::kMeasured : Pictures::kKept);
    }
  }
  const auto end = Clock::now();
  if (has_pictures) {
    next_pictures_ = end + std::max<Clock::duration>(kPicturePeriod, kMeasuringShare * (end - start));
  }
  if (selected_.all) readings_.next_all = end + kMeasuringShare * (end - start);
}

}  // namespace troupe
