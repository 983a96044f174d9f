#include "viewer/gateway/page_viewer.h"

#include <algorithm>
#include <span>
#include <utility>
#include <variant>

#include "common/spatial/robot_ways.h"
#include "common/spatial/scene.h"
#include "viewer/gateway/page_values.h"

namespace troupe {
namespace {

// The share of the time that the gateway may spend on measuring, for the readings of all robots.
constexpr int kMeasuringShare = 4;  // 1 / (1 + 4)
// Between two camera images to a viewer, whatever they cost.
constexpr std::chrono::milliseconds kPicturePeriod{100};

// With readings of all robots, as many ways are searched at most; of more goals none is, because none is selected.
constexpr std::size_t kMaxWaysOfAll = 16;

// Of each robot on lanes: as far ahead as its way is shown.
constexpr std::size_t kShownMoves = 8;

// The flags of an update message.
constexpr std::uint8_t kPausedFlag = 1;
constexpr std::uint8_t kLastFlag = 2;
constexpr std::uint8_t kReadingsFlag = 8;
constexpr std::uint8_t kPastFlag = 16;
constexpr std::uint8_t kAllEventsFlag = 32;  // the events are all that there are, in place of those sent before

std::uint8_t Flag(bool is_set, std::uint8_t flag) {
  return is_set ? flag : 0;
}

static_assert(kMemberCount<Event> == 6, "a new field of an event belongs into the next function, and into protocol.ts");

void Write(PageWriter& writer, const NumberedEvent& numbered) {
  const Event& event = numbered.event;
  writer.Write(numbered.position);
  writer.Write(event.tick);
  writer.Write(static_cast<std::uint8_t>(event.type));
  for (const std::string& name : {numbered.names.robot, numbered.names.other, numbered.names.object}) {
    writer.WriteText(name);
  }
  writer.WriteText(event.detail);
}

// In place of the number of a kind of reading (PageValue<ReadingContent>): the reading that the page has still counts.
constexpr std::uint8_t kKept = 255;

bool IsCamera(const Sensor& sensor) {
  return std::holds_alternative<CameraParameters>(sensor.description().parameters);
}

}  // namespace

// A selection concerns this viewer alone; all else is a request for the gateway.
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
  // A viewer that asks and does not read must not grow the memory; its requests were executed all the same.
  if (waiting_.size() >= kMaxReplies) return;
  waiting_.push_back({std::make_shared<const std::string>(std::move(reply.text)), true});
}

void PageViewer::ReturnToLive() {
  Viewer::ReturnToLive();
  update_ = 0;  // its rows belong to the past
}

bool PageViewer::NeedsMessage() const {
  return session_ != run_.session || timeline_ != run_.timeline || !waiting_.empty() || NeedsStatus() || NeedsUpdate();
}

// The status of the live run is needed once its world is known.
bool PageViewer::NeedsStatus() const {
  return !in_past_ && run_.status != nullptr && status_ != run_.status && shown() != nullptr &&
         world_ == shown()->world->number;
}

bool PageViewer::NeedsUpdate() const {
  if (shown() == nullptr) return false;
  const bool is_shown = in_past_ ? !past_is_new_ : world_ == shown()->world->number && update_ == run_.update;
  // In a run that is paused, the readings that its last update left out follow by themselves.
  const bool may_follow = readings_.measures_all || !selected_.all;
  return !is_shown || selection_is_new_ || (readings_missing_ && may_follow && Clock::now() >= next_pictures_);
}

// In the order in which the page needs them: the session decides what the page is, replies are awaited, a status needs
// its world.
std::optional<WebMessage> PageViewer::Next() {
  if (session_ != run_.session) {
    session_ = run_.session;
    return WebMessage{session_, true};
  }
  if (auto waiting = NextWaiting()) return waiting;
  if (timeline_ != run_.timeline) {
    timeline_ = run_.timeline;
    return WebMessage{timeline_, true};
  }
  if (NeedsStatus()) {
    status_ = run_.status;
    return WebMessage{status_, true};
  }
  if (!NeedsUpdate()) return std::nullopt;
  const TimelineWorld& world = *shown()->world;
  if (world_ == world.number) return WebMessage{std::make_shared<const std::string>(MakeUpdate()), false};
  // Rows of an update have ids of a world, so the world comes first, and then all rows.
  world_ = world.number;
  update_ = 0;
  status_.reset();
  return WebMessage{world.message, false};
}

// The layout is read by viewer/web/src/protocol.ts; a change of it counts kPageProtocol up.
std::string PageViewer::MakeUpdate() {
  const TimelineState& state = *shown();
  const FeedContent& content = run_.content;
  const bool has_readings = in_past_ || !selected_.all || readings_.measures_all;
  std::string bytes;
  PageWriter writer(bytes);
  writer.Write(static_cast<std::uint8_t>(PageMessage::kUpdate));
  writer.Write(state.world->number);
  writer.Write(static_cast<std::uint8_t>(Flag(in_past_ || content.paused, kPausedFlag) |
                                         Flag(!in_past_ && content.last, kLastFlag) |
                                         Flag(has_readings, kReadingsFlag) | Flag(in_past_, kPastFlag) |
                                         Flag(event_list_ != content.event_list, kAllEventsFlag)));
  writer.Write(state.state->tick);
  writer.Write(state.state_hash);
  writer.Write(state.edition);
  // Positions: of this state, of the oldest and of the newest that the viewer can go to.
  const std::shared_ptr<const TimeSpans> past = history_.Spans();
  const std::uint64_t first = past->empty() ? 0 : past->first();
  const std::uint64_t last = past->empty() ? 0 : past->last();
  for (const std::uint64_t position : {state.position, first, last}) writer.Write(position);
  WriteRows(writer);
  WriteEvents(writer);
  WriteGoals(writer);
  WriteTraffic(writer);
  WriteLaneRules(writer);
  readings_missing_ = !has_readings;
  if (has_readings) WriteReadings(writer);
  if (!in_past_) update_ = run_.update;
  past_is_new_ = selection_is_new_ = false;
  return bytes;
}

void PageViewer::WriteRows(PageWriter& writer) const {
  if (!in_past_) return run_.rows.Write(writer, update_);
  StateRows rows;  // all of them: the state before may be any
  rows.Assign(shown()->state, 1, true);
  rows.Write(writer, 0);
}

// Events are sent once each. A new list of events replaces all that the page has.
void PageViewer::WriteEvents(PageWriter& writer) {
  if (event_list_ != run_.content.event_list) event_ = 0;
  event_list_ = run_.content.event_list;
  const std::size_t place = writer.ReserveCount();
  std::size_t count = 0;
  const auto& events = run_.content.events;
  for (auto numbered = EventsAfter(events, event_); numbered != events.end(); ++numbered) {
    Write(writer, *numbered);
    event_ = numbered->number;
    ++count;
  }
  writer.FillCount(place, count);
}

// The newest ones: the past has none.
void PageViewer::WriteGoals(PageWriter& writer) {
  const std::vector<RobotCommand> none;
  const std::vector<RobotCommand>& goals = in_past_ ? none : run_.content.goals;
  const std::size_t place = writer.ReserveCount();
  std::size_t count = 0;
  for (const RobotCommand& goal : goals) {
    const WorldDescription& world = shown()->world->description();
    // A goal of the newest frame, perhaps of a later world.
    if (goal.robot.index() >= world.robots.size()) continue;
    ++count;
    writer.WriteCount(goal.robot.index());
    const std::string& name = world.robot(goal.robot).name;
    const bool is_listed = std::find(selected_.robots.begin(), selected_.robots.end(), name) != selected_.robots.end();
    const bool is_selected = is_listed || (selected_.all && goals.size() <= kMaxWaysOfAll);
    const std::vector<Vec2> no_way;
    for (const std::vector<Vec2>* points :
         {&goal.goal->waypoints, is_selected ? &readings_.ways.Of(*shown(), goal) : &no_way}) {
      writer.WriteCount(points->size());
      for (const Vec2& point : *points) {
        writer.WriteFloat(point.x());
        writer.WriteFloat(point.y());
      }
    }
  }
  writer.FillCount(place, count);
}

// For a viewer that shows it: the next moves of each robot, as vertices with a flag of the granted ones; all waits; and
// the closed lanes.
void PageViewer::WriteTraffic(PageWriter& writer) const {
  static const WorldState kNothing;
  const WorldState& state = selected_.traffic ? *shown()->state : kNothing;
  std::map<RobotId, std::vector<const TrafficMove*>> moves;
  for (const TrafficMove& move : state.traffic_moves) {
    std::vector<const TrafficMove*>& its = moves[move.robot];
    if (its.size() < kShownMoves) its.push_back(&move);
  }
  writer.WriteCount(moves.size());
  for (const auto& [robot, its] : moves) {
    writer.WriteCount(robot.index());
    writer.WriteCount(its.size());
    for (const TrafficMove* const move : its) {
      writer.WriteCount(move->to);
      writer.WriteFlag(move->granted);
    }
  }
  writer.WriteCount(state.waits.size());
  for (const RobotWait& wait : state.waits) PageValue<RobotWait>::Write(writer, wait);
  const auto is_closed = [&](const LaneClosure& closure) { return closure.until > state.tick; };
  writer.WriteCount(
      static_cast<std::size_t>(std::count_if(state.lane_closures.begin(), state.lane_closures.end(), is_closed)));
  for (const LaneClosure& closure : state.lane_closures) {
    if (is_closed(closure)) writer.WriteCount(closure.lane);
  }
}

// All of them: they are few, and their number changes.
void PageViewer::WriteLaneRules(PageWriter& writer) const {
  const std::vector<LaneRule>& rules = shown()->state->lane_rules;
  writer.WriteCount(rules.size());
  for (const LaneRule& rule : rules) PageValue<LaneRule>::Write(writer, rule);
}

const std::vector<Vec2>& ShownWays::Of(const TimelineState& state, const RobotCommand& goal) {
  constexpr std::chrono::seconds kPeriod{1};
  if (scene_ != state.world->scene) ways_.clear();
  scene_ = state.world->scene;
  const auto now = std::chrono::steady_clock::now();
  const auto [way, is_new] = ways_.try_emplace(goal.robot);
  Known& known = way->second;
  if (!is_new && known.goal == goal.goal->number && now < known.at + kPeriod) return known.points;
  known = {goal.goal->number, now, {}};
  if (!SearchesWays(scene_->world().robot(goal.robot))) return known.points;
  // Points that are reached are not known here: the way to the last one.
  known.points = FindWays(*scene_, *state.state, goal.robot, std::span(&goal.goal->waypoints.back(), 1));
  return known.points;
}

// By name, so that a selection outlives an edit of the world.
std::vector<RobotId> PageViewer::SelectedRobots() const {
  const WorldDescription& world = shown()->world->description();
  std::vector<RobotId> robots;
  if (selected_.all) {
    for (std::size_t i = 0; i < world.robots.size(); ++i) {
      if (RobotExists(world, RobotId(i))) robots.emplace_back(i);
    }
    return robots;
  }
  for (const std::string& name : selected_.robots) {
    if (const std::optional<RobotId> robot = FindRobot(world, name)) robots.push_back(*robot);
  }
  return robots;
}

// The time of the measuring decides when the next one of all robots, or the next image, is due.
void PageViewer::WriteReadings(PageWriter& writer) {
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

// Suites are kept from state to state: making one costs more than a measurement.
void RobotReadings::SetState(const SharedState& state) {
  if (state == state_) return;
  if (state_ == nullptr || state->world->scene != state_->world->scene) {
    robots_.clear();
    bodies_.emplace(*state->world->scene);
  }
  state_ = state;
  bodies_fresh_ = false;
  for (auto& [id, robot] : robots_) robot.encoded.assign(robot.encoded.size(), {});
}

// The bodies are placed once for each state, and only if a reading is needed.
const std::string& RobotReadings::Encoded(Robot& robot, std::size_t sensor) {
  std::string& encoded = robot.encoded[sensor];
  if (!encoded.empty()) return encoded;
  const WorldState& state = *state_->state;
  if (!bodies_fresh_) bodies_->Assign(state);
  bodies_fresh_ = true;
  std::string bytes;
  PageWriter writer(bytes);
  const Scene& scene = *state_->world->scene;
  PageValue<ReadingContent>::Write(writer, robot.suite.Measure(sensor, {scene, *bodies_, &state}, state.tick).content);
  return encoded = std::move(bytes);
}

bool RobotReadings::Write(PageWriter& writer, RobotId id, Pictures pictures) {
  auto known = robots_.find(id);
  if (known == robots_.end()) {
    known = robots_.emplace(id, Robot{SensorSuite(*state_->world->scene, id), {}}).first;
    known->second.encoded.resize(known->second.suite.size());
  }
  Robot& robot = known->second;
  bool is_missing = false;
  writer.WriteCount(id.index());
  writer.Write(state_->state->tick);
  writer.WriteCount(robot.suite.size());
  for (std::size_t i = 0; i < robot.suite.size(); ++i) {
    const Sensor& sensor = robot.suite.sensor(i);
    writer.WriteText(sensor.description().name);
    if (IsCamera(sensor) && pictures != Pictures::kMeasured) {
      if (pictures == Pictures::kKept) {
        writer.Write(kKept);
      } else {
        PageValue<ReadingContent>::Write(writer, {});
      }
      is_missing = true;
    } else {
      writer.WriteBytes(Encoded(robot, i));
    }
  }
  return is_missing;
}

}  // namespace troupe
