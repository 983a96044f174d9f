#include "viewer/gateway/viewer_gateway.h"

#include "common/sensing/sensor_suite.h"
#include "tests/unit/viewer/gateway/viewer_gateway_fixture.h"

namespace troupe {
namespace {

using test::CameraWorld;
using test::FrameAt;
using test::LaserWorld;
using test::ParsedUpdate;
using test::ScriptedRecording;
using test::ViewerGatewayTest;
using test::WebClient;

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

// Of a selected robot with the way around the box; not of one whose controller goes its own ways.
TEST_F(ViewerGatewayTest, GoalsInForceAreShownWithTheWaysOfSelectedRobots) {
  SessionMessage world = LaserWorld();
  world.world.Change().robots[0].controller.name = "go_to";
  StartRun(world);
  client_->SendText(R"({"type": "select", "robots": ["r0", "r1"]})");
  FrameMessage frame = *FrameAt(world_, 1);
  const Goal goal{.number = 1, .waypoints = {{1.0, 0.3}, {5.0, 0.3}}};
  frame.commands = {{.robot = RobotId(0), .goal = goal}, {.robot = RobotId(1), .goal = goal}};
  run_->OnFrame(std::make_shared<const FrameMessage>(frame));
  EXPECT_EQ(ReadBinary(*client_)[0], 1);
  ParsedUpdate update(ReadBinary(*client_));
  // The selection may be received behind the first update.
  if (update.goals.empty() || update.goals[0].way.empty()) update = ParsedUpdate(ReadBinary(*client_));
  ASSERT_EQ(update.goals.size(), 2u);
  EXPECT_EQ(update.goals[0].waypoints.size(), 2u);
  EXPECT_GT(update.goals[0].way.size(), 1u) << "not straight through the box";
  EXPECT_LT((update.goals[0].way.back() - Vec2(5.0, 0.3)).norm(), 1e-6);
  EXPECT_EQ(update.goals[1].robot, 1u);
  EXPECT_TRUE(update.goals[1].way.empty());
  // A paused frame has no commands, and changes nothing; a goal that was cancelled is gone.
  frame.paused = true;
  frame.commands.clear();
  run_->OnFrame(std::make_shared<const FrameMessage>(frame));
  EXPECT_EQ(ParsedUpdate(ReadBinary(*client_)).goals.size(), 2u);
  frame.paused = false;
  frame.state.tick = 2;
  frame.commands = {{.robot = RobotId(1), .goal = Goal{}}};
  run_->OnFrame(std::make_shared<const FrameMessage>(frame));
  EXPECT_TRUE(ParsedUpdate(ReadBinary(*client_)).goals.empty());
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
                                            : "found no 'pose', expected a list of 4 numbers");
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
