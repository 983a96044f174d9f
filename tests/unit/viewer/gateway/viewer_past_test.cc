// A viewer that shows the past of a run, and its signals and expectations.

#include "tests/unit/viewer/gateway/viewer_gateway_fixture.h"

namespace troupe {
namespace {

using test::FrameAt;
using test::LaserWorld;
using test::ParsedUpdate;
using test::ScriptedRecording;
using test::ViewerGatewayTest;
using test::WebClient;

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

}  // namespace
}  // namespace troupe
