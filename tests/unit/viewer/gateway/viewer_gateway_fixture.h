// What the tests of a viewer's gateway share: a run that the test makes up, its worlds, and a page that is connected.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "recording/timeline/timeline.h"
#include "tests/support/small_world.h"
#include "tests/support/values.h"
#include "tests/unit/viewer/gateway/page_reader.h"
#include "tests/unit/viewer/gateway/web_client.h"
#include "viewer/gateway/page_messages.h"
#include "viewer/gateway/viewer_gateway.h"

namespace troupe::test {

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
    EXPECT_TRUE(changed.wait_for(lock, std::chrono::milliseconds(kWebDeadline), [&] { return observer != nullptr; }));
    return *observer;
  }
  void AwaitNoObserver() {
    std::unique_lock lock(mutex);
    EXPECT_TRUE(changed.wait_for(lock, std::chrono::milliseconds(kWebDeadline), [&] { return observer == nullptr; }));
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

inline SessionMessage LaserWorld(Edition edition = 0) {
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

inline SharedFrame FrameAt(const SessionMessage& session, Tick tick) {
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
inline SessionMessage CameraWorld() {
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
    // Doors, lifts, people, zones, their coverage, flows of goods, visitors and their flows; and events.
    for (int kind = 0; kind < 9; ++kind) EXPECT_EQ(reader.ReadCount(), 0u);
    goals.resize(reader.ReadCount());
    for (ParsedGoal& goal : goals) {
      goal.robot = reader.ReadCount();
      for (std::vector<Vec2>* points : {&goal.waypoints, &goal.way}) {
        points->resize(reader.ReadCount());
        for (Vec2& point : *points) {
          const double x = reader.ReadFloat();
          point = {x, reader.ReadFloat()};
        }
      }
    }
    for (int kind = 0; kind < 4; ++kind) EXPECT_EQ(reader.ReadCount(), 0u);  // moves, waits, closed lanes, rules
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

  struct ParsedGoal {
    std::uint32_t robot = 0;
    std::vector<Vec2> waypoints = {};
    std::vector<Vec2> way = {};
  };

  std::uint32_t world = 0;
  std::uint8_t flags = 0;
  Tick tick = 0;
  std::uint64_t hash = 0;
  std::uint64_t position = 0;
  std::uint64_t first = 0;
  std::uint64_t last = 0;
  std::vector<std::uint32_t> rows;
  std::vector<RobotState> robots;
  std::vector<ParsedGoal> goals;
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
    gateway_ = ValueOf(ViewerGateway::Start(options, link_));
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

}  // namespace troupe::test
