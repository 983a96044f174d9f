#include "viewer/gateway/viewer_gateway.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "common/sensing/sensor_suite.h"
#include "recording/timeline/timeline.h"
#include "tests/support/small_world.h"
#include "tests/support/values.h"
#include "tests/unit/viewer/gateway/page_reader.h"
#include "tests/unit/viewer/gateway/web_client.h"
#include "viewer/gateway/page_messages.h"

namespace troupe {
namespace {

using test::PageReader;
using test::WebClient;

// A run that the test makes up.
class ScriptedLink : public RunLink {
 public:
  Result<std::unique_ptr<RunObservation>> Observe(ObserverHandler& handler) override {
    const std::lock_guard lock(mutex);
    observer = &handler;
    ++observed;
    changed.notify_all();
    return std::unique_ptr<RunObservation>(std::make_unique<End>(*this));
  }
  Result<ControlReply> Ask(const control::Request& request) override {
    const std::lock_guard lock(mutex);
    asked.push_back(request);
    ControlReply reply;
    reply.done = !control::Is<control::SetPose>(request);
    reply.problem = reply.done ? "" : "in a wall";
    reply.entities = entities;
    return reply;
  }
  Result<nlohmann::json> Edit(const EditOperation& operation) override {
    return nlohmann::json{{"is_text", std::holds_alternative<edit::Text>(operation)}};
  }

  bool follows_always() const override { return always; }
  std::shared_ptr<RecordedTimeline> ReadJournal(WorldCache&) override { return journal ? journal() : nullptr; }

  ObserverHandler& AwaitObserver() {
    std::unique_lock lock(mutex);
    EXPECT_TRUE(
        changed.wait_for(lock, std::chrono::milliseconds(test::kWebDeadline), [&] { return observer != nullptr; }));
    return *observer;
  }
  void AwaitNoObserver() {
    std::unique_lock lock(mutex);
    EXPECT_TRUE(
        changed.wait_for(lock, std::chrono::milliseconds(test::kWebDeadline), [&] { return observer == nullptr; }));
  }

  std::mutex mutex;
  std::condition_variable changed;
  ObserverHandler* observer = nullptr;
  int observed = 0;
  std::vector<control::Request> asked;
  std::vector<EntityReport> entities;  // of each reply
  bool always = false;
  std::atomic<bool> outdated = false;
  std::function<std::shared_ptr<RecordedTimeline>()> journal;

 private:
  struct End : RunObservation {
    explicit End(ScriptedLink& of) : link(of) {}
    bool IsOutdated() override { return link.outdated.exchange(false); }
    ~End() override {
      const std::lock_guard lock(link.mutex);
      link.observer = nullptr;
      link.changed.notify_all();
    }
    ScriptedLink& link;
  };
};

SessionMessage LaserWorld(Edition edition = 0) {
  SmallWorld world;
  world.AddBox("box", 2.0, 0.0, 1.0, 1.0, {0.0, 1.0});
  for (const char* name : {"r0", "r1"}) {
    const RobotId robot = world.AddRobot(name, {name[1] == '1' ? -1.0 : 0.0, 0.3, 0.0, 0.1});
    RaySensorDescription fan = Fan(2.0, 30);
    fan.noise_variance = 0.01;
    world.AddRanger(robot, {0.0, 0.0, 0.2, 0.0}, {fan});
  }
  return {.run = 1, .world = world.world(), .world_edition = edition};
}

SharedFrame FrameAt(const SessionMessage& session, Tick tick) {
  FrameMessage frame;
  frame.run = session.run;
  frame.edition = frame.world_edition = session.world_edition;
  frame.state = PlacedState(session.world);
  frame.state.tick = tick;
  frame.state.robots[0].X_WR.x = 0.001 * static_cast<double>(tick);
  frame.state_hash = 1000 + tick;
  return std::make_shared<const FrameMessage>(std::move(frame));
}

// Robot r0 with a camera.
SessionMessage CameraWorld() {
  SessionMessage session = LaserWorld();
  RobotDescription& robot = session.world.Change().robots[0];
  CameraParameters camera;
  camera.X_MS.z = 0.3;
  camera.width = 8;
  camera.height = 6;
  robot.sensors.push_back({.name = "eye", .model = robot.root, .parameters = camera});
  return session;
}

// With one ranger of one scan, perhaps a camera, and no joints, grippers, objects, events or status.
struct ParsedUpdate {
  explicit ParsedUpdate(const std::string& bytes) {
    PageReader reader(bytes);
    EXPECT_EQ(reader.ReadByte(), 2);
    world = reader.ReadCount();
    flags = reader.ReadByte();
    tick = reader.Read<std::uint64_t>();
    hash = reader.Read<std::uint64_t>();
    reader.ReadCount();  // edition
    position = reader.Read<std::uint64_t>();
    first = reader.Read<std::uint64_t>();
    last = reader.Read<std::uint64_t>();
    rows = reader.ReadRows(robots);
    // Joints, grippers, objects, stores, lights.
    for (int kind = 0; kind < 5; ++kind) EXPECT_EQ(reader.ReadCount(), 0u);
    std::vector<CameraState> cameras;
    reader.ReadRows(cameras);
    EXPECT_EQ(reader.ReadCount(), 0u);  // doors
    EXPECT_EQ(reader.ReadCount(), 0u);  // lifts
    EXPECT_EQ(reader.ReadCount(), 0u);  // people
    EXPECT_EQ(reader.ReadCount(), 0u);  // events
    EXPECT_EQ(flags & 4, 0);
    if ((flags & 8) == 0) return;
    const std::uint32_t measured = reader.ReadCount();
    for (std::uint32_t i = 0; i < measured; ++i) {
      readings.push_back(reader.ReadCount());
      reading_tick = reader.Read<std::uint64_t>();
      const std::uint32_t sensors = reader.ReadCount();
      EXPECT_EQ(reader.ReadText(), "ranger:0");
      EXPECT_EQ(reader.ReadByte(), 1);
      std::vector<double>& ranges = scans.emplace_back(reader.ReadCount());
      for (double& range : ranges) range = reader.ReadDouble();
      EXPECT_EQ(reader.ReadCount(), 1u);
      reader.ReadDouble();  // of view
      EXPECT_EQ(reader.Read<std::uint64_t>(), ranges.size());
      EXPECT_EQ(reader.ReadCount(), 0u);  // elevations
      reader.ReadPose();
      for (int k = 0; k < 3; ++k) reader.ReadDouble();  // limits and variance
      if (sensors == 1) continue;
      EXPECT_EQ(reader.ReadText(), "eye");
      camera = reader.ReadByte();
      if (*camera != kCamera) continue;
      reader.ReadPose();
      width = reader.ReadCount();
      height = reader.ReadCount();
      for (int k = 0; k < 6; ++k) reader.ReadDouble();  // lens and limits
      picture = reader.ReadText();
    }
    EXPECT_TRUE(reader.at_end());
  }

  // The kinds of a camera's reading.
  static constexpr std::uint8_t kNone = 0;
  static constexpr std::uint8_t kCamera = 7;
  static constexpr std::uint8_t kKept = 255;

  bool is_past() const { return (flags & 16) != 0; }

  std::uint32_t world = 0;
  std::uint8_t flags = 0;
  Tick tick = 0;
  std::uint64_t hash = 0;
  std::uint64_t position = 0;
  std::uint64_t first = 0;
  std::uint64_t last = 0;
  std::vector<std::uint32_t> rows;
  std::vector<RobotState> robots;
  std::vector<std::uint32_t> readings;  // robots
  Tick reading_tick = 0;
  std::vector<std::vector<double>> scans;
  std::optional<std::uint8_t> camera;  // the kind of its reading
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  std::string picture;
};

class ViewerGatewayTest : public testing::Test {
 protected:
  void Start(bool view_only = false, const std::string& token = "", bool editor = false) {
    ViewerGatewayOptions options{.session = "s",
                                 .port = 0,
                                 .view_only = view_only,
                                 .editor = editor,
                                 .expectations = expectations_,
                                 .token = token};
    gateway_ = test::ValueOf(ViewerGateway::Start(options, link_));
  }
  std::uint16_t port() const {
    const std::string address = gateway_->Address();
    return static_cast<std::uint16_t>(std::stoi(address.substr(address.find(':', 6) + 1)));
  }
  std::unique_ptr<WebClient> Connect() {
    auto client = std::make_unique<WebClient>(port());
    client->Upgrade();
    return client;
  }
  // Starts the gateway with a page, and a run of a world, whose frames OnFrame(tick) sends.
  void StartRun(const SessionMessage& world = LaserWorld()) {
    Start();
    client_ = Connect();
    run_ = &link_.AwaitObserver();
    world_ = world;
    run_->OnSession(world_);
  }
  void OnFrame(Tick tick) { run_->OnFrame(FrameAt(world_, tick)); }
  static nlohmann::json ReadText(WebClient& client) {
    return nlohmann::json::parse(ReadMessage(client, 1), nullptr, false);
  }
  static std::string ReadBinary(WebClient& client) { return ReadMessage(client, 2); }
  // The next text of this type.
  static nlohmann::json ReadText(WebClient& client, const std::string& type) {
    for (;;) {
      nlohmann::json text = ReadText(client);
      if (text.is_discarded() || text["type"] == type) return text;
    }
  }
  // The first update that `wanted` accepts.
  template <typename Wanted>
  static ParsedUpdate AwaitUpdate(WebClient& client, Wanted wanted) {
    for (;;) {
      const std::string bytes = ReadBinary(client);
      if (bytes.empty() || bytes[0] != 2) continue;
      ParsedUpdate update(bytes);
      if (wanted(update)) return update;
    }
  }

  ShownExpectations expectations_;
  ScriptedLink link_;
  std::unique_ptr<ViewerGateway> gateway_;
  std::unique_ptr<WebClient> client_;
  ObserverHandler* run_ = nullptr;
  SessionMessage world_;

 private:
  static std::string ReadMessage(WebClient& client, int opcode) {
    for (;;) {
      const auto message = client.Read();
      if (!message) {
        ADD_FAILURE() << "the connection ended";
        return "";
      }
      if (message->opcode == opcode) return message->content;
    }
  }
};

TEST_F(ViewerGatewayTest, SendsTheWorldThenItsStateThenDifferences) {
  Start();
  auto client = Connect();
  nlohmann::json session = ReadText(*client);
  EXPECT_EQ(session["session"], "s");
  EXPECT_EQ(session["connected"], false);
  ObserverHandler& run = link_.AwaitObserver();
  const SessionMessage world = LaserWorld();
  run.OnSession(world);
  run.OnFrame(FrameAt(world, 1));
  EXPECT_EQ(ReadText(*client)["connected"], true);
  const std::string description = ReadBinary(*client);
  EXPECT_EQ(description[0], 1);
  EXPECT_NE(description.find("ranger:0"), std::string::npos);
  const ParsedUpdate whole(ReadBinary(*client));
  EXPECT_EQ(whole.tick, 1u);
  EXPECT_EQ(whole.hash, 1001u);
  EXPECT_THAT(whole.rows, testing::ElementsAre(0, 1));
  run.OnFrame(FrameAt(world, 2));
  const ParsedUpdate difference(ReadBinary(*client));
  EXPECT_EQ(difference.tick, 2u);
  EXPECT_THAT(difference.rows, testing::ElementsAre(0));
  EXPECT_EQ(difference.robots[0].X_WR.x, 0.002);

  auto late = Connect();
  EXPECT_EQ(ReadBinary(*late)[0], 1);
  EXPECT_THAT(ParsedUpdate(ReadBinary(*late)).rows, testing::ElementsAre(0, 1));
}

TEST_F(ViewerGatewayTest, TheStatusOfTheRunFollowsItsWorld) {
  StartRun();
  OnFrame(1);
  StatusMessage status{.run = world_.run, .target_ticks = 600, .speed = 2.0};
  status.phases.step = 0.25;
  status.waiting_for.assign(70, "r0");
  run_->OnStatus(status);
  EXPECT_EQ(ReadBinary(*client_)[0], 1);
  nlohmann::json text = ReadText(*client_, "status");
  EXPECT_EQ(text["target_ticks"], 600);
  EXPECT_EQ(text["speed"], 2.0);
  EXPECT_EQ(text["phases"]["step"], 0.25);
  EXPECT_EQ(text["waiting_for"].size(), 50u);
  EXPECT_EQ(text["waiting_count"], 70);
  // A viewer that comes later has it, too.
  auto late = Connect();
  EXPECT_EQ(ReadBinary(*late)[0], 1);
  text = ReadText(*late, "status");
  EXPECT_EQ(text["target_ticks"], 600);
}

TEST_F(ViewerGatewayTest, ManyTicksAreFewUpdates) {
  StartRun();
  const auto start = std::chrono::steady_clock::now();
  constexpr Tick kTicks = 20000;
  for (Tick tick = 1; tick <= kTicks; ++tick) OnFrame(tick);
  int updates = 0;
  AwaitUpdate(*client_, [&](const ParsedUpdate& update) {
    ++updates;
    return update.tick == kTicks;
  });
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
  EXPECT_LE(updates, kUpdatesPerSecond * seconds.count() + 3.0);
}

TEST_F(ViewerGatewayTest, ReadingsAreThoseOfTheRobotsThemselves) {
  StartRun();
  OnFrame(7);
  EXPECT_TRUE(AwaitUpdate(*client_, [](const ParsedUpdate&) { return true; }).readings.empty());
  client_->SendText(R"({"type": "select", "robots": ["r1", "unknown"]})");
  const ParsedUpdate one = AwaitUpdate(*client_, [](const ParsedUpdate& update) { return !update.readings.empty(); });
  EXPECT_THAT(one.readings, testing::ElementsAre(1));
  client_->SendText(R"({"type": "select", "robots": "all"})");
  const ParsedUpdate all =
      AwaitUpdate(*client_, [](const ParsedUpdate& update) { return update.readings.size() == 2; });
  EXPECT_EQ(all.reading_tick, 7u);

  const Scene scene(world_.world);
  BodyIndex bodies(scene);
  bodies.Assign(FrameAt(world_, 7)->state);
  for (std::size_t robot = 0; robot < 2; ++robot) {
    SensorSuite suite(scene, RobotId(robot));
    const RangerReading expected = *suite.Measure(0, {scene, bodies}, 7).ranger();
    EXPECT_EQ(all.scans[robot], expected.ranges);
  }
}

std::string PictureAt(const SessionMessage& world, Tick tick) {
  const Scene scene(world.world);
  BodyIndex bodies(scene);
  const WorldState state = FrameAt(world, tick)->state;
  bodies.Assign(state);
  SensorSuite suite(scene, RobotId(0));
  const auto& colors = suite.Measure(1, {scene, bodies, &state}, tick).As<CameraReading>()->colors;
  return {colors.begin(), colors.end()};
}

TEST_F(ViewerGatewayTest, CameraImagesAreThoseOfTheRobotWhosePanelIsOpen) {
  StartRun(CameraWorld());
  OnFrame(1);
  client_->SendText(R"({"type": "select", "robots": ["r0"]})");
  const auto has_camera = [](const ParsedUpdate& update) { return update.camera.has_value(); };
  EXPECT_EQ(*AwaitUpdate(*client_, has_camera).camera, ParsedUpdate::kNone);
  client_->SendText(R"({"type": "select", "robots": "all", "pictures": "r0"})");
  const auto has_picture = [](const ParsedUpdate& update) { return update.camera == ParsedUpdate::kCamera; };
  const ParsedUpdate shown = AwaitUpdate(*client_, has_picture);
  EXPECT_EQ(shown.width, 8u);
  EXPECT_EQ(shown.height, 6u);
  EXPECT_EQ(shown.picture, PictureAt(world_, 1));
}

TEST_F(ViewerGatewayTest, CameraImagesAreFewAndThatOfTheLastStateFollows) {
  StartRun(CameraWorld());
  OnFrame(1);
  client_->SendText(R"({"type": "select", "robots": ["r0"], "pictures": "r0"})");
  const auto has_picture = [](const ParsedUpdate& update) { return update.camera == ParsedUpdate::kCamera; };
  AwaitUpdate(*client_, has_picture);
  // Until a state comes so soon after an image that it has none.
  Tick tick = 1;
  for (bool was_kept = false; !was_kept;) {
    OnFrame(++tick);
    was_kept = AwaitUpdate(*client_, [&](const ParsedUpdate& update) { return update.tick == tick; }).camera ==
               ParsedUpdate::kKept;
  }
  const ParsedUpdate late = AwaitUpdate(*client_, has_picture);
  EXPECT_EQ(late.tick, tick);
  EXPECT_EQ(late.picture, PictureAt(world_, tick));
}

TEST_F(ViewerGatewayTest, RequestsReachTheRunAndTheirRepliesTheViewer) {
  Start();
  auto client = Connect();
  client->SendText(R"({"type": "control", "id": 5, "command": "pause"})");
  client->SendText(R"({"type": "control", "id": 6, "command": "set_pose", "name": "r0", "pose": [2, 0, 0, 0]})");
  nlohmann::json reply = ReadText(*client, "reply");
  EXPECT_EQ(reply["id"], 5);
  EXPECT_EQ(reply["done"], true);
  reply = ReadText(*client, "reply");
  EXPECT_EQ(reply["id"], 6);
  EXPECT_EQ(reply["problem"], "in a wall");
}

TEST_F(ViewerGatewayTest, AViewerGoesBackToAPastStateAndReturns) {
  StartRun();
  auto other = Connect();
  for (Tick tick = 1; tick <= 20; ++tick) OnFrame(tick);
  OnFrame(20);  // resent
  const ParsedUpdate newest = AwaitUpdate(*client_, [](const ParsedUpdate& update) { return update.tick == 20; });
  EXPECT_EQ(newest.position, 19u);
  EXPECT_EQ(newest.last, 19u);
  EXPECT_FALSE(newest.is_past());
  client_->SendText(R"({"type": "select", "robots": ["r0"]})");
  client_->SendText(R"({"type": "seek", "position": 4})");
  const ParsedUpdate past = AwaitUpdate(*client_, [](const ParsedUpdate& update) { return update.is_past(); });
  EXPECT_EQ(past.tick, 5u);
  EXPECT_EQ(past.hash, 1005u);
  EXPECT_EQ(past.position, 4u);
  EXPECT_THAT(past.rows, testing::ElementsAre(0, 1));
  EXPECT_EQ(past.robots[0].X_WR.x, 0.005);
  EXPECT_EQ(past.reading_tick, 5u);
  OnFrame(21);
  AwaitUpdate(*other, [](const ParsedUpdate& update) { return update.tick == 21; });
  client_->SendText(R"({"type": "seek", "tick": 7})");
  const ParsedUpdate next = AwaitUpdate(*client_, [](const ParsedUpdate&) { return true; });
  EXPECT_EQ(next.tick, 7u) << "a viewer in the past receives no live state";
  EXPECT_EQ(next.last, 20u);
  client_->SendText(R"({"type": "live"})");
  const ParsedUpdate live = AwaitUpdate(*client_, [](const ParsedUpdate& update) { return !update.is_past(); });
  EXPECT_EQ(live.tick, 21u);
  EXPECT_THAT(live.rows, testing::ElementsAre(0, 1));
}

// A recording of ten states of one world.
class ScriptedRecording : public RecordedTimeline {
 public:
  std::shared_ptr<const TimeSpans> Spans() const override { return spans; }
  Result<SharedState> At(std::uint64_t position) override {
    if (position == damaged) return Failure("the chunk is damaged");
    const SharedFrame frame = FrameAt(session, position);
    return std::make_shared<const TimelineState>(
        TimelineState{position, world, {frame, &frame->state}, frame->state_hash, 0});
  }
  const std::deque<NumberedEvent>& Events() const override { return events; }
  RunId run() const override { return session.run; }
  bool is_whole() const override { return whole; }

  bool whole = true;
  std::uint64_t damaged = 8;
  SessionMessage session = LaserWorld();
  WorldCache worlds{EncodeWorld};
  std::shared_ptr<const TimelineWorld> world = worlds.Of(session);
  std::shared_ptr<const TimeSpans> spans = std::make_shared<const TimeSpans>(std::vector<TimeSpan>{{0, 9, 0, 0}});
  std::deque<NumberedEvent> events;
};

TEST_F(ViewerGatewayTest, ShowsARecordingFromItsStartAndRefusesToChangeIt) {
  ScriptedRecording recording;
  ViewerGatewayOptions options;
  options.port = 0;
  gateway_ = test::ValueOf(ViewerGateway::Start(options, recording));
  auto client = Connect();
  const nlohmann::json session = ReadText(*client);
  EXPECT_EQ(session["recording"], true);
  EXPECT_EQ(session["connected"], true);
  EXPECT_EQ(ReadBinary(*client)[0], 1);
  const ParsedUpdate begin(ReadBinary(*client));
  EXPECT_EQ(begin.position, 0u);
  EXPECT_EQ(begin.last, 9u);
  client->SendText(R"({"type": "seek", "tick": 5})");
  EXPECT_EQ(ParsedUpdate(ReadBinary(*client)).hash, 1005u);
  client->SendText(R"({"type": "live"})");
  client->SendText(R"({"type": "control", "id": 3, "command": "pause"})");
  EXPECT_THAT(std::string(ReadText(*client)["problem"]), testing::HasSubstr("recording"));
  client->SendText(R"({"type": "seek", "position": 8})");
  EXPECT_THAT(std::string(ReadText(*client)["problem"]), testing::HasSubstr("damaged"));
  client->SendText(R"({"type": "seek", "position": 9})");
  EXPECT_EQ(ParsedUpdate(ReadBinary(*client)).hash, 1009u);
}

nlohmann::json Series(const std::string& signals, int from, int to, int every = 1) {
  return {{"type", "series"}, {"id", 4},  {"signals", nlohmann::json::parse(signals)},
          {"from", from},     {"to", to}, {"every", every}};
}

TEST_F(ViewerGatewayTest, SignalsAreThoseOfTheStates) {
  StartRun();
  for (const Tick tick : {1u, 2u, 3u, 6u, 7u}) OnFrame(tick);
  AwaitUpdate(*client_, [](const ParsedUpdate& update) { return update.tick == 7; });
  client_->SendText(Series(R"([["r0", "x"], ["r1", "stalled"], ["r0", "energy"], ["nobody", "x"],
                               ["r0", "range/ranger:0"], ["r0", "range/ranger:0/3"]])",
                           1, 100)
                        .dump());
  nlohmann::json reply = ReadText(*client_, "reply");
  EXPECT_EQ(reply["done"], true) << reply;
  EXPECT_EQ(reply["ticks"], (std::vector<Tick>{2, 3, 6, 7}));
  EXPECT_EQ(reply["positions"], (std::vector<std::uint64_t>{1, 2, 5, 6}));
  EXPECT_EQ(reply["next"], nullptr);
  EXPECT_EQ(reply["values"][0], (std::vector<double>{0.002, 0.003, 0.006, 0.007}));
  EXPECT_EQ(reply["values"][1][0], 0.0);
  EXPECT_EQ(reply["values"][2][0], nullptr) << "it has no store";
  EXPECT_EQ(reply["values"][3][0], nullptr);
  const Scene scene(world_.world);
  BodyIndex bodies(scene);
  bodies.Assign(FrameAt(world_, 7)->state);
  SensorSuite suite(scene, RobotId(0));
  const std::vector<double> ranges = suite.Measure(0, {scene, bodies}, 7).ranger()->ranges;
  EXPECT_EQ(reply["values"][4][3], *std::min_element(ranges.begin(), ranges.end()));
  EXPECT_EQ(reply["values"][5][3], ranges[3]);

  client_->SendText(Series(R"([["r0", "x"]])", 0, 6, 2).dump());
  EXPECT_EQ(ReadText(*client_, "reply")["ticks"], (std::vector<Tick>{1, 3, 7}));
  client_->SendText(R"({"type": "totals", "id": 5})");
  reply = ReadText(*client_, "reply");
  EXPECT_EQ(reply["complete"], true);
  EXPECT_EQ(reply["last_tick"], 7);
  EXPECT_EQ(reply["robots"][0]["name"], "r0");
  EXPECT_NEAR(reply["robots"][0]["distance"].get<double>(), 0.006, 1e-12);
  EXPECT_EQ(reply["robots"][1]["distance"], 0.0);
}

// Robot r0 is at x = tick mm.
TEST_F(ViewerGatewayTest, ExpectationsHaveTheSameRowsInARunAndInItsRecording) {
  expectations_.list = {{"slow", "always x(r0) < 4.5 mm"},
                        {"arrives", "eventually x(r0) > 2.5 mm"},
                        {"near", "always x(r0) < 1 m"},
                        {"far", "eventually x(r0) > 1 m"},
                        {"wrong", "always x(r7) < 1 m"}};
  StartRun();
  EXPECT_EQ(ReadText(*client_, "session")["expectations"], 5);
  const auto ask = [](WebClient& client) {
    client.SendText(R"({"type": "expectations", "id": 5})");
    return ReadText(client, "reply");
  };
  for (Tick tick = 0; tick <= 3; ++tick) OnFrame(tick);
  AwaitUpdate(*client_, [](const ParsedUpdate& update) { return update.tick == 3; });
  const nlohmann::json early = ask(*client_);
  EXPECT_EQ(early["to"], 3);
  EXPECT_EQ(early["rows"][0]["verdict"], "undecided");
  EXPECT_EQ(early["rows"][0]["at_end"], true);
  EXPECT_EQ(early["rows"][1]["decided"], 3);
  for (Tick tick = 4; tick <= 9; ++tick) OnFrame(tick);
  AwaitUpdate(*client_, [](const ParsedUpdate& update) { return update.tick == 9; });
  const nlohmann::json reply = ask(*client_);
  EXPECT_EQ(reply["complete"], true) << reply;
  EXPECT_EQ(reply["problem_at"], "");
  const nlohmann::json& rows = reply["rows"];
  ASSERT_EQ(rows.size(), 5u);
  EXPECT_EQ(rows[0]["verdict"], "false");
  EXPECT_EQ(rows[0]["decided"], 5);
  EXPECT_EQ(rows[0]["spans"], nlohmann::json::parse("[[0, 1], [5, 2]]"));
  EXPECT_EQ(rows[0]["names"].size(), 0u) << "no quantifier";
  EXPECT_EQ(rows[1]["verdict"], "true");
  EXPECT_EQ(rows[1]["spans"], nlohmann::json::parse("[[0, 0], [3, 1]]"));
  EXPECT_EQ(rows[2]["verdict"], "undecided");
  EXPECT_EQ(rows[2]["at_end"], true);
  EXPECT_EQ(rows[2]["cause"], 9);
  EXPECT_EQ(rows[2]["robustness"][0], nullptr);
  EXPECT_NEAR(rows[2]["robustness"][1].get<double>(), 0.991, 1e-12);
  EXPECT_EQ(rows[3]["at_end"], false);
  EXPECT_EQ(rows[3]["spans"], nlohmann::json::parse("[[0, 0]]"));
  EXPECT_THAT(rows[4]["problem"].get<std::string>(), testing::HasSubstr("r7"));

  ScriptedRecording recording;
  recording.damaged = 100;
  const std::unique_ptr<ViewerGateway> of_run = std::move(gateway_);
  ViewerGatewayOptions options;
  options.port = 0;
  options.expectations = expectations_;
  gateway_ = test::ValueOf(ViewerGateway::Start(options, recording));
  const auto client = Connect();
  EXPECT_EQ(ask(*client), reply);
}

TEST_F(ViewerGatewayTest, ExpectationsOfAnEditedRunAreJudgedUpToTheEdit) {
  expectations_.list = {{"slow", "always x(r0) < 4.5 mm"}};
  StartRun();
  for (Tick tick = 0; tick <= 3; ++tick) OnFrame(tick);
  world_ = LaserWorld(1);
  run_->OnSession(world_);
  for (Tick tick = 3; tick <= 7; ++tick) OnFrame(tick);
  AwaitUpdate(*client_, [](const ParsedUpdate& update) { return update.tick == 7; });
  client_->SendText(R"({"type": "expectations", "id": 5})");
  nlohmann::json reply = ReadText(*client_, "reply");
  EXPECT_EQ(reply["problem_at"], "the world was changed at tick 3");
  EXPECT_EQ(reply["rows"][0]["verdict"], "undecided");
  // A reset begins anew.
  world_ = LaserWorld(2);
  run_->OnSession(world_);
  for (Tick tick = 0; tick <= 6; ++tick) OnFrame(tick);
  AwaitUpdate(*client_, [](const ParsedUpdate& update) { return update.tick == 6; });
  client_->SendText(R"({"type": "expectations", "id": 6})");
  reply = ReadText(*client_, "reply");
  EXPECT_EQ(reply["problem_at"], "");
  EXPECT_EQ(reply["rows"][0]["verdict"], "false");
  EXPECT_EQ(reply["from"], 9);
  EXPECT_EQ(reply["rows"][0]["decided"], 14);
}

TEST_F(ViewerGatewayTest, TheTimelineHasTheGapsOfThePast) {
  StartRun();
  for (const Tick tick : {1u, 2u, 5u}) OnFrame(tick);
  nlohmann::json spans = ReadText(*client_, "timeline")["spans"];
  while (spans.size() < 2) spans = ReadText(*client_, "timeline")["spans"];
  EXPECT_EQ(spans, nlohmann::json::parse("[[0, 1, 1], [4, 4, 5]]"));
}

TEST_F(ViewerGatewayTest, AViewerHasThePastOfARunThatWasFollowedBefore) {
  link_.always = true;
  Start();
  run_ = &link_.AwaitObserver();
  world_ = LaserWorld();
  run_->OnSession(world_);
  for (Tick tick = 1; tick <= 3; ++tick) OnFrame(tick);
  client_ = Connect();
  client_->SendText(R"({"type": "seek", "tick": 1})");
  EXPECT_EQ(AwaitUpdate(*client_, [](const ParsedUpdate& update) { return update.is_past(); }).tick, 1u);
}

TEST_F(ViewerGatewayTest, ARunThatEndsBeforeItIsFoundIsShownAtItsEnd) {
  // The journal is finished after it has been read once, and no frame comes.
  link_.journal = [readings = 0]() mutable {
    auto journal = std::make_shared<ScriptedRecording>();
    journal->whole = readings++ > 0;
    return journal;
  };
  Start();
  auto client = Connect();
  ASSERT_EQ(ReadBinary(*client)[0], 1);
  const ParsedUpdate end(ReadBinary(*client));
  EXPECT_EQ(end.tick, 9u);
  EXPECT_NE(end.flags & 2, 0) << "the run has ended";
  EXPECT_EQ(end.first, 0u);
}

TEST_F(ViewerGatewayTest, AViewOnlyGatewayAsksTheRunForNothingButAnswers) {
  Start(true);
  auto client = Connect();
  EXPECT_EQ(ReadText(*client)["view_only"], true);
  for (const char* command : {"pause", "play", "reset"}) {
    client->SendText(std::string(R"({"type": "control", "id": 1, "command": ")") + command + "\"}");
    const nlohmann::json reply = ReadText(*client);
    EXPECT_EQ(reply["done"], false);
    EXPECT_THAT(std::string(reply["problem"]), testing::HasSubstr("--view-only"));
  }
  client->SendText(R"({"type": "control", "id": 2, "command": "spawnables"})");
  EXPECT_EQ(ReadText(*client)["done"], true);
  const std::lock_guard lock(link_.mutex);
  ASSERT_EQ(link_.asked.size(), 1u);
  EXPECT_TRUE(control::Is<control::Spawnables>(link_.asked[0]));
}

TEST_F(ViewerGatewayTest, ATextThatIsNoRequestEndsTheConnection) {
  Start();
  auto client = Connect();
  client->SendText("give me everything");
  std::optional<test::WebFrame> message;
  do {
    message = client->Read();
  } while (message && message->opcode != 8);
  ASSERT_TRUE(message.has_value());
  EXPECT_EQ(message->close_status(), 1008);
}

TEST_F(ViewerGatewayTest, AMalformedEditIsAnsweredAndKeepsTheConnection) {
  for (const bool view_only : {false, true}) {
    Start(view_only, "", true);
    auto client = Connect();
    client->SendText(R"({"type": "edit", "id": 5, "op": "set_pose", "name": "a"})");
    const nlohmann::json refused = ReadText(*client, "reply");
    EXPECT_EQ(refused["id"], 5);
    EXPECT_EQ(refused["done"], false);
    EXPECT_EQ(refused["problem"], view_only ? "this page only shows the file (--view-only)"
                                            : "found no pose, expected four finite numbers");
    client->SendText(R"({"type": "edit", "id": 6, "op": "text"})");
    const nlohmann::json done = ReadText(*client, "reply");
    EXPECT_EQ(done["id"], 6);
    EXPECT_EQ(done["is_text"], true);
  }
}

TEST_F(ViewerGatewayTest, ASleepingViewerSkipsToTheNewestState) {
  StartRun();
  auto watching = Connect();
  constexpr Tick kTicks = 50;
  for (Tick tick = 1; tick <= kTicks; ++tick) {
    OnFrame(tick);
    AwaitUpdate(*watching, [&](const ParsedUpdate& update) { return update.tick == tick; });
  }
  const ParsedUpdate newest = AwaitUpdate(*client_, [&](const ParsedUpdate& update) { return update.tick == kTicks; });
  EXPECT_EQ(newest.robots[0].X_WR.x, 0.001 * static_cast<double>(kTicks));
}

TEST_F(ViewerGatewayTest, ThePageThatIsLoadedStartsTheObservationForItsViewer) {
  Start();
  WebClient(port()).Get("/");
  link_.AwaitObserver();
  link_.AwaitNoObserver();  // the page never connects
  auto client = Connect();
  link_.AwaitObserver();
  const std::lock_guard lock(link_.mutex);
  EXPECT_EQ(link_.observed, 2);
}

TEST_F(ViewerGatewayTest, TheRunIsObservedOnlyWhileThereAreViewers) {
  Start();
  {
    const std::lock_guard lock(link_.mutex);
    EXPECT_EQ(link_.observed, 0);
  }
  auto client = Connect();
  link_.AwaitObserver();
  client.reset();
  link_.AwaitNoObserver();
}

// The first request starts the observation; the following ones have the figures.
TEST_F(ViewerGatewayTest, MetricsAreThoseOfTheStatusAndTheEvents) {
  Start();
  const auto scrape = [this] {
    WebClient client(port());
    client.Send("GET /metrics HTTP/1.0\r\nHost: " + client.host() + "\r\n\r\n");
    return client.ReadAll().value_or("");
  };
  const std::string first = scrape();
  EXPECT_THAT(first, testing::HasSubstr("text/plain; version=0.0.4"));
  EXPECT_THAT(first, testing::EndsWith("troupe_up{session=\"s\"} 0\n"));

  run_ = &link_.AwaitObserver();
  world_ = LaserWorld();
  run_->OnSession(world_);
  auto frame = std::make_shared<FrameMessage>(*FrameAt(world_, 41));
  frame->events = {{.tick = 41, .type = EventType::kLeft, .robot = RobotId(0)},
                   {.tick = 41, .type = EventType::kLeft, .robot = RobotId(1)},
                   {.tick = 41, .type = EventType::kJoined, .robot = RobotId(1)}};
  run_->OnFrame(frame);
  EXPECT_THAT(scrape(), testing::EndsWith("troupe_up{session=\"s\"} 0\n")) << "without a status";
  StatusMessage status{.run = world_.run, .tick = 41, .real_time_factor = 2.5, .robots = 2, .agents = 1};
  status.waiting_for = {"r0"};
  status.waiting_seconds = 1.5;
  status.incarnation = 3;
  status.phases.step = 0.25;
  run_->OnStatus(status);
  {
    const std::lock_guard lock(link_.mutex);
    for (const auto& [name, seconds] : {std::pair("r0", 0.0), std::pair("r\"1", 0.125), std::pair("r2", 0.0625)}) {
      link_.entities.push_back({.name = name, .kind = EntityKind::kRobot});
      link_.entities.back().agent = AgentReport{.host = "h", .present = true, .answer_seconds = seconds};
    }
  }
  std::string metrics;
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::milliseconds(test::kWebDeadline);
  while (metrics.find("slowest") == std::string::npos && std::chrono::steady_clock::now() < deadline) {
    metrics = scrape();  // the slowest robot is asked for at the request before
  }
  for (const char* line :
       {"troupe_up{session=\"s\"} 1", "# TYPE troupe_tick gauge\ntroupe_tick{session=\"s\"} 41",
        "troupe_ticks_per_second{session=\"s\"} 25", "troupe_real_time_factor{session=\"s\"} 2.5",
        "troupe_robots{session=\"s\"} 2", "troupe_agents{session=\"s\"} 1", "troupe_awaited_robots{session=\"s\"} 1",
        "troupe_waiting_seconds{session=\"s\"} 1.5", "troupe_phase_seconds{session=\"s\",phase=\"step\"} 0.25",
        R"(troupe_slowest_answer_seconds{session="s",robot="r\"1",host="h"} 0.125)",
        "# TYPE troupe_service_restarts_total counter\ntroupe_service_restarts_total{session=\"s\"} 3",
        "troupe_agents_lost_total{session=\"s\"} 2", "troupe_agents_rejoined_total{session=\"s\"} 1"}) {
    EXPECT_THAT(metrics, testing::HasSubstr(std::string("\n") + line + "\n")) << line;
  }
}

TEST_F(ViewerGatewayTest, ARunThatHasItsKeysLaterIsObservedAgain) {
  Start();
  auto client = Connect();
  link_.AwaitObserver();
  link_.outdated = true;
  std::unique_lock lock(link_.mutex);
  EXPECT_TRUE(link_.changed.wait_for(lock, std::chrono::milliseconds(test::kWebDeadline),
                                     [&] { return link_.observed == 2 && link_.observer != nullptr; }));
}

TEST_F(ViewerGatewayTest, AnEditedWorldIsSentAgain) {
  StartRun();
  OnFrame(1);
  AwaitUpdate(*client_, [](const ParsedUpdate& update) { return update.world == 1; });
  const SessionMessage second = LaserWorld(1);
  run_->OnSession(second);
  run_->OnFrame(FrameAt(second, 1));
  EXPECT_EQ(ReadBinary(*client_)[0], 1);
  const ParsedUpdate update(ReadBinary(*client_));
  EXPECT_EQ(update.world, 2u);
  EXPECT_THAT(update.rows, testing::ElementsAre(0, 1));
}

TEST_F(ViewerGatewayTest, TheAddressHasTheToken) {
  Start(false, "0123abcd");
  const std::string address = gateway_->Address();
  const std::size_t token = address.find("/?token=0123abcd");
  ASSERT_NE(token, std::string::npos) << address;
  WebClient stranger(port());
  EXPECT_THAT(stranger.Get("/socket", WebClient::UpgradeHeaders(stranger.host(), "http://" + stranger.host())),
              testing::HasSubstr(" 403 "));
  WebClient viewer(port());
  viewer.Upgrade("/socket" + address.substr(token + 1));
}

}  // namespace
}  // namespace troupe
