#include "viewer/gateway/viewer_gateway.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>
#include <vector>

#include "common/base/host_name.h"
#include "viewer/gateway/control_queue.h"
#include "viewer/gateway/follower.h"
#include "viewer/gateway/foxglove_client.h"
#include "viewer/gateway/robot_readings.h"
#include "viewer/gateway/run_feed.h"
#include "viewer/gateway/seek_queue.h"
#include "viewer/gateway/state_rows.h"
#include "viewer/gateway/viewer_state.h"
#include "viewer/gateway/web_server.h"
#include "viewer/gateway/world_message.h"

namespace troupe {
namespace {

using Clock = std::chrono::steady_clock;

// Of all robots' readings, the part of the time that the gateway may spend on measuring.
constexpr int kMeasuringShare = 4;  // 1 / (1 + 4)
// Between two camera images to a viewer, whatever they cost.
constexpr std::chrono::milliseconds kPicturePeriod{100};

// The flags of an update message.
constexpr std::uint8_t kPausedFlag = 1;
constexpr std::uint8_t kLastFlag = 2;
constexpr std::uint8_t kStatusFlag = 4;
constexpr std::uint8_t kReadingsFlag = 8;
constexpr std::uint8_t kPastFlag = 16;

constexpr std::size_t kMostAwaited = 50;  // names in an update

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

void Write(ByteWriter& writer, const StatusMessage& status) {
  writer.Write(status.target_ticks);
  writer.Write(status.wall_seconds);
  writer.Write(status.real_time_factor);
  writer.WriteCount(status.robots);
  writer.WriteCount(status.agents);
  writer.Write(status.waiting_seconds);
  writer.WriteCount(status.waiting_for.size());
  const std::size_t named = std::min(status.waiting_for.size(), kMostAwaited);
  writer.WriteCount(named);
  for (std::size_t i = 0; i < named; ++i) writer.WriteText(status.waiting_for[i]);
  writer.Write(status.speed.value_or(0.0));
  const PhaseSeconds& phases = status.phases;
  for (const double seconds : {phases.wait, phases.step, phases.record, phases.publish}) writer.Write(seconds);
}

class RunGateway final : public ViewerGateway, private WebHandler {
 public:
  // One of the two is not null.
  RunGateway(ViewerGatewayOptions options, RunLink* link, Recorded* recording)
      : options_(std::move(options)),
        token_(options_.token.empty() && !IsLoopback(options_.address) ? MakeToken() : options_.token),
        recording_(recording),
        past_(recording != nullptr ? static_cast<PastStates&>(*recording) : feed_.history()),
        seeks_(past_, [this] { server_->Wake(); }) {
    if (recording != nullptr) {
      for (const NumberedEvent& event : recording->Events()) content_.events.push_back(event);
    }
    if (link == nullptr) return;
    follower_.emplace(*link, feed_);
    controls_.emplace(*link, [this] { server_->Wake(); });
  }

  ~RunGateway() override {
    if (server_) server_->Stop();
  }

  Status Listen() {
    WebServer::Options web;
    web.address = options_.address;
    web.port = options_.port;
    web.any_port = options_.any_port;
    web.access.loopback_only = IsLoopback(options_.address);
    web.access.token = token_;
    if (!web.access.loopback_only) web.access.names = {HostName()};
    web.longest_text = LongestRequest();
    web.files = options_.files;
    Result<std::unique_ptr<WebServer>> server = WebServer::Create(web, *this);
    if (!server.ok()) return server.error();
    server_ = std::move(server).value();
    server_->Serve();
    return Status();
  }

  std::string Address() const override {
    const std::string host = options_.address == "0.0.0.0" ? HostName() : options_.address;
    const std::string page = "http://" + host + ":" + std::to_string(server_->port()) + "/";
    return token_.empty() ? page : page + "?token=" + token_;
  }

  bool HasShownEnd() const override { return shown_end_; }

 private:
  void OnPage() override {
    if (follower_) follower_->Expect();
  }

  void OnOpened(Viewer viewer, std::string_view protocol) override {
    if (viewers_.empty()) server_->SetPeriod(1.0 / kUpdatesPerSecond);
    ViewerState& state = viewers_[viewer];
    if (protocol != WebServer::kProtocols[0]) {
      const std::optional<PastStates::Range> range = recording_ != nullptr ? past_.range() : std::nullopt;
      state.foxglove = std::make_unique<FoxgloveClient>("Troupe " + options_.session, range);
    }
    shown_end_ = false;
    if (follower_) follower_->SetWanted(true);
    if (recording_ != nullptr) Seek(viewer, past_.range().value_or(PastStates::Range()).first);
  }

  void OnClosed(Viewer viewer) override {
    viewers_.erase(viewer);
    seeks_.Remove(viewer);
    if (!viewers_.empty()) return;
    shown_end_ = true;
    if (follower_) follower_->SetWanted(false);
    server_->SetPeriod(0.0);
  }

  bool OnText(Viewer viewer, std::string_view text) override;
  bool OnBinary(Viewer viewer, std::string_view bytes) override;
  std::optional<WebMessage> NextMessage(Viewer viewer) override;
  void OnPeriod() override;
  void OnWake() override;

  std::size_t LongestRequest() const { return options_.editor ? kLongestEditRequest : kLongestPageRequest; }
  void Answer(Viewer viewer, std::string text);
  void Edit(Viewer viewer, EditRequest request);
  void Seek(Viewer viewer, std::uint64_t position);
  void ReturnToLive(ViewerState& viewer);
  void Control(Viewer viewer, PageControl control);
  bool OnFoxglove(Viewer viewer, const Result<foxglove::ClientMessage>& message);
  void CallService(Viewer viewer, FoxgloveClient& client, const foxglove::ServiceCall& call);
  ShownState ShownTo(const ViewerState& viewer) const;
  static std::vector<RobotId> SelectedRobots(const ViewerState& viewer, const WorldDescription& world);
  std::string SessionText() const;
  bool NeedsUpdate(const ViewerState& viewer) const;
  bool LateReadingsAreDue(const ViewerState& viewer) const;
  std::optional<WebMessage> NextOfPast(ViewerState& viewer);
  std::shared_ptr<const std::string> MakeUpdate(ViewerState& viewer);
  std::shared_ptr<const std::string> MakePastUpdate(ViewerState& viewer);
  void WriteTimeline(ByteWriter& writer, std::uint64_t position) const;
  void WriteEvents(ByteWriter& writer, ViewerState& viewer) const;
  void WriteReadings(ByteWriter& writer, ViewerState& viewer, const WorldDescription& world, RobotReadings& readings);

  const ViewerGatewayOptions options_;
  const std::string token_;
  RunFeed feed_;
  Recorded* const recording_;  // null: a live run
  PastStates& past_;
  // Of the server's thread, with everything below but the threads themselves.
  std::map<Viewer, ViewerState> viewers_;
  FeedContent content_;
  StateRows rows_;
  std::uint64_t update_ = 0;  // counts the versions of the content that viewers may see
  std::uint32_t world_ = 0;   // of rows_
  RobotReadings readings_;
  RobotReadings past_readings_;
  Clock::time_point next_readings_;
  bool measure_all_ = true;  // now; all robots are measured less often if that takes long
  std::string problem_;
  std::atomic<bool> shown_end_ = true;  // for any thread
  std::unique_ptr<WebServer> server_;   // stopped first, but the queue may wake it still
  SeekQueue seeks_;
  std::optional<Follower> follower_;  // of a live run, as the next
  std::optional<ControlQueue> controls_;
};

void RunGateway::Answer(Viewer viewer, std::string text) {
  const auto known = viewers_.find(viewer);
  if (known == viewers_.end() || known->second.texts.size() >= ViewerState::kMostTexts) return;
  if (FoxgloveClient* const client = known->second.foxglove.get()) {
    const nlohmann::json reply = nlohmann::json::parse(text, nullptr, false);
    client->Reply(reply.value("id", std::uint64_t{0}), reply.value("done", false), reply.value("problem", ""), text);
    server_->RequestMessage(viewer);
    return;
  }
  known->second.texts.push_back(std::move(text));
  server_->RequestMessage(viewer);
}

// A client of a recording has the time of its timeline, which never goes back.
ShownState RunGateway::ShownTo(const ViewerState& viewer) const {
  const auto time = [](std::uint64_t count, const ViewedWorld& world) {
    return static_cast<foxglove::Time>(count) * static_cast<foxglove::Time>(world.scene->world().interval_ns);
  };
  if (viewer.in_past) {
    if (!viewer.past) return {};
    const ViewedWorld& world = *viewer.past->world;
    return {&world, viewer.past->state.get(), viewer.past->position + 1, time(viewer.past->position, world)};
  }
  if (world_ == 0) return {};
  return {content_.world.get(), content_.state.get(), update_, time(content_.state->tick, *content_.world)};
}

bool RunGateway::OnFoxglove(Viewer viewer, const Result<foxglove::ClientMessage>& message) {
  if (!message.ok()) return false;
  ViewerState& state = viewers_[viewer];
  if (const auto* call = std::get_if<foxglove::ServiceCall>(&message.value())) {
    CallService(viewer, *state.foxglove, *call);
  } else {
    state.foxglove->Apply(message.value(), ShownTo(state));
  }
  server_->RequestMessage(viewer);
  return true;
}

// A service is a request of the page.
void RunGateway::CallService(Viewer viewer, FoxgloveClient& client, const foxglove::ServiceCall& call) {
  nlohmann::json object = nlohmann::json::parse(call.json, nullptr, false);
  if (!object.is_object()) object = nlohmann::json::object();
  object["type"] = "control";
  object["id"] = call.call;
  object["command"] = call.command;
  client.Expect(call.call, call);
  Result<PageRequest> request = ParsePageRequest(object.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace));
  if (!request.ok()) return Answer(viewer, PageReplyText(call.call, request.error()));
  Control(viewer, std::move(std::get<PageControl>(request.value())));
}

bool RunGateway::OnBinary(Viewer viewer, std::string_view bytes) {
  return OnFoxglove(viewer, foxglove::ParseBinary(bytes));
}

bool RunGateway::OnText(Viewer viewer, std::string_view text) {
  if (viewers_[viewer].foxglove) return OnFoxglove(viewer, foxglove::ParseText(text));
  Result<PageRequest> request = ParsePageRequest(text, LongestRequest());
  if (!request.ok()) return false;
  if (auto* const select = std::get_if<SelectRequest>(&request.value())) {
    ViewerState& state = viewers_[viewer];
    state.selected = std::move(*select);
    state.selection_new = true;
    state.next_pictures = {};
    return true;
  }
  if (auto* const seek = std::get_if<SeekRequest>(&request.value())) {
    const std::optional<std::uint64_t> position = seek->position ? seek->position : past_.PositionOf(*seek->tick);
    if (position) Seek(viewer, *position);
  } else if (std::holds_alternative<LiveRequest>(request.value())) {
    ReturnToLive(viewers_[viewer]);
  } else if (auto* const edit = std::get_if<EditRequest>(&request.value())) {
    Edit(viewer, std::move(*edit));
  } else {
    Control(viewer, std::move(std::get<PageControl>(request.value())));
  }
  return true;
}

void RunGateway::Control(Viewer viewer, PageControl control) {
  const std::uint64_t id = control.id;
  if (!controls_) {
    Answer(viewer, PageReplyText(id, Failure("a recording cannot be changed")));
  } else if (options_.view_only && !IsQuestion(control.request.command)) {
    Answer(viewer, PageReplyText(id, Failure("this viewer only shows the run (--view-only)")));
  } else if (!controls_->Add(viewer, std::move(control))) {
    Answer(viewer, PageReplyText(id, Failure("too many requests wait for the run")));
  }
}

void RunGateway::Edit(Viewer viewer, EditRequest request) {
  const std::uint64_t id = request.id;
  if (!controls_ || !options_.editor) {
    Answer(viewer, EditReplyText(id, Failure("this page shows a run; troupe edit FILE edits a file")));
  } else if (options_.view_only && !IsQuestion(request)) {
    Answer(viewer, EditReplyText(id, Failure("this page only shows the file (--view-only)")));
  } else if (!controls_->Add(viewer, std::move(request))) {
    Answer(viewer, EditReplyText(id, Failure("too many requests wait")));
  }
}

void RunGateway::Seek(Viewer viewer, std::uint64_t position) {
  viewers_[viewer].in_past = true;
  seeks_.Add(viewer, position);
}

void RunGateway::ReturnToLive(ViewerState& viewer) {
  if (recording_ != nullptr) return;
  viewer.in_past = viewer.past_new = false;
  viewer.past.reset();
  viewer.update = 0;  // its rows are those of the past
}

void RunGateway::OnWake() {
  if (controls_) {
    for (ControlQueue::Answer& answer : controls_->TakeAnswers()) Answer(answer.viewer, std::move(answer.text));
  }
  for (SeekQueue::Found& found : seeks_.TakeFound()) {
    const auto known = viewers_.find(found.viewer);
    if (known == viewers_.end() || !known->second.in_past) continue;
    if (found.state.ok()) {
      known->second.past = std::move(found.state).value();
      known->second.past_new = true;
      server_->RequestMessage(found.viewer);
    } else {
      Answer(found.viewer, PageReplyText(0, found.state.error()));
    }
  }
}

void RunGateway::OnPeriod() {
  const std::uint64_t before = content_.version;
  feed_.Read(content_);
  std::string problem = follower_ ? follower_->problem() : std::string();
  const bool has_world = content_.world != nullptr;
  const bool session_changed = problem != problem_ || has_world != (world_ != 0);
  problem_ = std::move(problem);
  if (content_.version != before) {
    ++update_;
    const std::uint32_t world = has_world ? content_.world->number : 0;
    if (world != 0) {
      rows_.Assign(content_.state, update_, world != world_);
      readings_.SetState(content_.world->scene, *content_.state);
    }
    world_ = world;
  }
  measure_all_ = Clock::now() >= next_readings_;
  bool all_know = true;
  for (auto& [viewer, state] : viewers_) {
    if (state.foxglove) {
      const ShownState shown = ShownTo(state);
      if (const auto position = state.foxglove->PositionToShow(Clock::now(), shown)) Seek(viewer, *position);
      if (state.foxglove->NeedsMessage(shown)) server_->RequestMessage(viewer);
      continue;
    }
    if (session_changed) state.knows_session = false;
    const bool is_behind = !state.knows_session || NeedsUpdate(state);
    if (is_behind) server_->RequestMessage(viewer);
    all_know = all_know && !is_behind;
  }
  shown_end_ = all_know && (world_ == 0 || content_.last);  // of a recording: there is none
}

bool RunGateway::NeedsUpdate(const ViewerState& viewer) const {
  const bool is_new = viewer.selection_new || LateReadingsAreDue(viewer);
  if (viewer.in_past) return viewer.past && (viewer.past_new || is_new);
  return world_ != 0 && (viewer.world != world_ || viewer.update != update_ || is_new);
}

// Of a run that is paused, the readings that its last update left out follow by themselves.
bool RunGateway::LateReadingsAreDue(const ViewerState& viewer) const {
  return viewer.readings_missing && (measure_all_ || !viewer.selected.all) && Clock::now() >= viewer.next_pictures;
}

std::string RunGateway::SessionText() const {
  const nlohmann::json text = {{"type", "session"},
                               {"session", options_.session},
                               {"view_only", options_.view_only},
                               {"connected", world_ != 0 || recording_ != nullptr},
                               {"recording", recording_ != nullptr},
                               {"editor", options_.editor},
                               {"problem", problem_}};
  return text.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

std::optional<WebMessage> RunGateway::NextMessage(Viewer id) {
  ViewerState& viewer = viewers_[id];
  if (viewer.foxglove) return viewer.foxglove->Next(ShownTo(viewer), content_.events);
  if (!viewer.knows_session) {
    viewer.knows_session = true;
    return WebMessage{std::make_shared<const std::string>(SessionText()), true};
  }
  if (!viewer.texts.empty()) {
    auto text = std::make_shared<const std::string>(std::move(viewer.texts.front()));
    viewer.texts.pop_front();
    return WebMessage{std::move(text), true};
  }
  if (!NeedsUpdate(viewer)) return std::nullopt;
  if (viewer.in_past) return NextOfPast(viewer);
  if (viewer.world != world_) {
    viewer.world = world_;
    viewer.update = 0;
    return WebMessage{content_.world->message, false};
  }
  return WebMessage{MakeUpdate(viewer), false};
}

std::optional<WebMessage> RunGateway::NextOfPast(ViewerState& viewer) {
  const ViewedWorld& world = *viewer.past->world;
  if (viewer.world != world.number) {
    viewer.world = world.number;
    viewer.update = 0;
    return WebMessage{world.message, false};
  }
  return WebMessage{MakePastUpdate(viewer), false};
}

// Positions: of this state, of the oldest and of the newest that the viewer can go to.
void RunGateway::WriteTimeline(ByteWriter& writer, std::uint64_t position) const {
  const PastStates::Range range = past_.range().value_or(PastStates::Range());
  writer.Write(position);
  writer.Write(range.first);
  writer.Write(range.last);
}

// All rows: the state before may be any.
std::shared_ptr<const std::string> RunGateway::MakePastUpdate(ViewerState& viewer) {
  const PastState& past = *viewer.past;
  ByteWriter writer;
  writer.Write(static_cast<std::uint8_t>(PageMessage::kUpdate));
  writer.Write(past.world->number);
  writer.Write(static_cast<std::uint8_t>(kPausedFlag | kReadingsFlag | kPastFlag));
  writer.Write(past.state->tick);
  writer.Write(past.state_hash);
  writer.Write(past.edition);
  WriteTimeline(writer, past.position);
  StateRows rows;
  rows.Assign(past.state, 1, true);
  rows.Write(writer, 0);
  WriteEvents(writer, viewer);
  past_readings_.SetState(past.world->scene, *past.state);
  WriteReadings(writer, viewer, past.world->scene->world(), past_readings_);
  viewer.past_new = viewer.selection_new = false;
  return std::make_shared<const std::string>(writer.TakeBytes());
}

std::shared_ptr<const std::string> RunGateway::MakeUpdate(ViewerState& viewer) {
  ByteWriter writer;
  writer.Write(static_cast<std::uint8_t>(PageMessage::kUpdate));
  writer.Write(world_);
  const bool has_readings = !viewer.selected.all || measure_all_;
  writer.Write(static_cast<std::uint8_t>((content_.paused ? kPausedFlag : 0) | (content_.last ? kLastFlag : 0) |
                                         (content_.status ? kStatusFlag : 0) | (has_readings ? kReadingsFlag : 0)));
  writer.Write(content_.state->tick);
  writer.Write(content_.state_hash);
  writer.Write(content_.edition);
  WriteTimeline(writer, content_.position);
  rows_.Write(writer, viewer.update);
  WriteEvents(writer, viewer);
  if (content_.status) Write(writer, *content_.status);
  viewer.readings_missing = !has_readings;
  if (has_readings) WriteReadings(writer, viewer, content_.world->scene->world(), readings_);
  viewer.update = update_;
  viewer.selection_new = false;
  return std::make_shared<const std::string>(writer.TakeBytes());
}

void RunGateway::WriteEvents(ByteWriter& writer, ViewerState& viewer) const {
  const std::size_t place = writer.ReserveCount();
  std::size_t count = 0;
  for (const NumberedEvent& numbered : content_.events) {
    if (numbered.number <= viewer.event) continue;
    Write(writer, numbered);
    viewer.event = numbered.number;
    ++count;
  }
  writer.FillCount(place, count);
}

std::vector<RobotId> RunGateway::SelectedRobots(const ViewerState& viewer, const WorldDescription& world) {
  std::vector<RobotId> robots;
  if (viewer.selected.all) {
    for (std::size_t i = 0; i < world.robots.size(); ++i) {
      if (IsThere(world, RobotId(i))) robots.emplace_back(i);
    }
    return robots;
  }
  for (const std::string& name : viewer.selected.robots) {
    if (const std::optional<RobotId> robot = FindRobot(world, name)) robots.push_back(*robot);
  }
  return robots;
}

void RunGateway::WriteReadings(ByteWriter& writer, ViewerState& viewer, const WorldDescription& world,
                               RobotReadings& readings) {
  const auto start = Clock::now();
  const std::vector<RobotId> robots = SelectedRobots(viewer, world);
  const bool has_pictures = start >= viewer.next_pictures;
  viewer.readings_missing = false;
  writer.WriteCount(robots.size());
  for (const RobotId robot : robots) {
    if (world.robot(robot).name != viewer.selected.pictures) {
      readings.Write(writer, robot, Pictures::kNone);
    } else {
      viewer.readings_missing = readings.Write(writer, robot, has_pictures ? Pictures::kMeasured : Pictures::kKept);
    }
  }
  const auto end = Clock::now();
  if (has_pictures)
    viewer.next_pictures = end + std::max<Clock::duration>(kPicturePeriod, kMeasuringShare * (end - start));
  if (viewer.selected.all) next_readings_ = end + kMeasuringShare * (end - start);
}

}  // namespace

namespace {

Result<std::unique_ptr<ViewerGateway>> StartGateway(const ViewerGatewayOptions& options, RunLink* link,
                                                    Recorded* recording) {
  auto gateway = std::make_unique<RunGateway>(options, link, recording);
  if (Status failure = gateway->Listen(); !failure.ok()) return failure.error();
  return std::unique_ptr<ViewerGateway>(std::move(gateway));
}

}  // namespace

Result<std::unique_ptr<ViewerGateway>> ViewerGateway::Start(const ViewerGatewayOptions& options, RunLink& link) {
  return StartGateway(options, &link, nullptr);
}

Result<std::unique_ptr<ViewerGateway>> ViewerGateway::Start(const ViewerGatewayOptions& options, Recorded& recording) {
  return StartGateway(options, nullptr, &recording);
}

}  // namespace troupe
