// The printed texts: status line, summary, table of sessions, description of a world.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <numbers>
#include <span>
#include <string>
#include <vector>

#include "command_line/terminal.h"
#include "common/base/text.h"
#include "launcher/commands/check_command.h"
#include "launcher/commands/commands.h"
#include "launcher/commands/top_command.h"
#include "launcher/driving/robot_remote.h"
#include "launcher/hosts/host.h"
#include "launcher/supervise/reports.h"
#include "launcher/supervise/run_again.h"
#include "tests/support/small_world.h"
#include "tests/support/values.h"
#include "worldfile/sites/site.h"

namespace troupe {
namespace {

using testing::ContainsRegex;
using testing::Eq;
using testing::HasSubstr;
using testing::Not;
using testing::Optional;

StatusMessage WaitingStatus() {
  return {.tick = 312,
          .target_ticks = 600,
          .sim_seconds = 31.2,
          .real_time_factor = 12.34,
          .robots = 100,
          .agents = 99,
          .waiting_for = {"a", "b", "c", "d", "e", "f"},
          .waiting_seconds = 1.25};
}

TEST(RunAgain, HasItsLineItsSeedAndItsPage) {
  EXPECT_THAT(ParseRunAgainLine(RunAgainLine(std::nullopt)), Optional(Eq(std::nullopt)));
  EXPECT_THAT(ParseRunAgainLine(RunAgainLine(7)), Optional(Optional(7U)));
  for (const char* line : {"", "run again soon", "run again with seed ", "run again with seed -1", "a: run again"}) {
    EXPECT_FALSE(ParseRunAgainLine(line)) << line;
  }
  const std::vector<std::string> words = {"troupe", "run", "--seed", "4", "a.json", "--seed=5", "--ticks", "9"};
  EXPECT_EQ(WithSeed(words, 7), (std::vector<std::string>{"troupe", "run", "a.json", "--ticks", "9", "--seed=7"}));
  const std::optional<PageAddress> page = ParsePageAddress("http://127.0.0.1:8471/?token=ab12");
  ASSERT_TRUE(page);
  EXPECT_EQ(page->port, 8471);
  EXPECT_EQ(page->token, "ab12");
  EXPECT_EQ(ParsePageAddress("http://127.0.0.1:8470/")->token, "");
  for (const char* address : {"", "http://", "http://127.0.0.1/", "http://127.0.0.1:99999/", "http://a:b/"}) {
    EXPECT_FALSE(ParsePageAddress(address)) << address;
  }
}

TEST(StatusText, ShowsProgressSpeedAndTheAwaitedRobots) {
  EXPECT_EQ(StatusText(WaitingStatus()),
            "tick 312/600, 31.2 s, 12.3 x real time, 3 s left, 100 robots, waiting for a, b, c, d and 2 more (1.2 s)");
}

TEST(StatusText, OmitsEmptyParts) {
  StatusMessage status;
  status.tick = 5;
  EXPECT_EQ(StatusText(status), "tick 5, 0.0 s, 0.0 x real time, 0 robots");
}

TEST(StatusText, EstimatesTheRestAsPeopleSayIt) {
  StatusMessage status{.tick = 10, .target_ticks = 600, .sim_seconds = 1.0, .real_time_factor = 1.0, .robots = 1};
  EXPECT_EQ(StatusText(status), "tick 10/600, 1.0 s, 1.0 x real time, 59 s left, 1 robot");
  status.target_ticks = 6000;
  EXPECT_THAT(StatusText(status), HasSubstr(", 10 min left"));
  status.target_ticks = 600000;
  EXPECT_THAT(StatusText(status), HasSubstr(", 17 h left"));
  status.real_time_factor = 0.0;  // paused
  EXPECT_THAT(StatusText(status), Not(HasSubstr("left")));
}

TEST(SessionTop, ShowsRobotsThatNeedAttentionFirst) {
  SmallWorld world;
  for (const char* name : {"a", "b", "c", "d"}) {
    world.AddRobot(name, {static_cast<double>(world.world().robots.size()) * 2.0, 0.0, 0.0, 0.0});
  }
  SessionTop top;
  EXPECT_THAT(top.Text(20), HasSubstr("waiting for a run"));
  SessionMessage session{.run = 1, .world = world.world()};
  FrameMessage frame{.run = 1, .state = PlacedState(session.world)};
  frame.state.robots[0].twist.vx = 0.5;
  frame.state.robots[1].stalled = true;
  frame.events = {{0, EventType::kLeft, RobotId(3), {}, {}, {}}};
  top.OnSession(session);
  top.OnFrame(std::make_shared<const FrameMessage>(frame));
  StatusMessage status{.run = 1, .waiting_for = {"c"}};
  top.OnStatus(status);
  EXPECT_THAT(top.Text(20), Not(HasSubstr("phases of a tick")));
  status.phases = {0.0951, 0.002, 0.0015, 0.00042};
  top.OnStatus(status);
  const std::string text = top.Text(20);
  EXPECT_THAT(text, HasSubstr("wait 95.10 ms, step 2.00 ms, record 1.50 ms, publish 0.42 ms\n"));
  const auto place = [&](const std::string& part) {
    const std::size_t found = text.find(part);
    EXPECT_NE(found, std::string::npos) << part << " in\n" << text;
    return found;
  };
  EXPECT_LT(place("\nd "), place("\nc "));
  EXPECT_LT(place("\nc "), place("\nb "));
  EXPECT_LT(place("\nb "), place("\na "));
  place("no agent");
  place("stalled");
  EXPECT_THAT(top.Text(8), HasSubstr("and "));
  frame.events = {{0, EventType::kJoined, RobotId(3), {}, {}, {}}};
  top.OnFrame(std::make_shared<const FrameMessage>(frame));
  EXPECT_THAT(top.Text(20), Not(HasSubstr("no agent")));
  EXPECT_THAT(top.Text(20), HasSubstr("the tick waits for c ("));
  frame.paused = frame.holds = true;
  top.OnFrame(std::make_shared<const FrameMessage>(frame));
  EXPECT_THAT(top.Text(20), HasSubstr(", playing, "));
  frame.holds = false;
  top.OnFrame(std::make_shared<const FrameMessage>(frame));
  EXPECT_THAT(top.Text(20), HasSubstr(", paused, "));
  top.OnServiceGone();
  EXPECT_THAT(top.Text(20), HasSubstr("waiting for a run"));
}

SessionMessage SessionOf(const std::vector<const char*>& robots, Edition edition) {
  SmallWorld world;
  for (const char* name : robots) {
    world.AddRobot(name, {static_cast<double>(world.world().robots.size()) * 2.0, 0.0, 0.0, 0.0});
  }
  return {.run = 1, .world = world.world(), .world_edition = edition};
}

FrameMessage FrameOf(const SessionMessage& session) {
  FrameMessage frame;
  frame.run = session.run;
  frame.edition = frame.world_edition = session.world_edition;
  frame.state = PlacedState(session.world);
  return frame;
}

TEST(SessionTop, ARobotThatHasLostItsAgentIsTheSameRobotAfterALoad) {
  const SessionMessage first = SessionOf({"a", "b"}, 0);
  const SessionMessage second = SessionOf({"b", "c"}, 1);  // b has another id
  SessionTop top;
  top.OnSession(first);
  FrameMessage frame = FrameOf(first);
  frame.events = {{0, EventType::kLeft, RobotId(1), {}, {}, {}}};
  top.OnFrame(std::make_shared<const FrameMessage>(frame));
  EXPECT_THAT(top.Text(20), ContainsRegex("\nb +no agent"));
  // Until a frame of the second world arrives, the state is that of the first one.
  top.OnSession(second);
  EXPECT_THAT(top.Text(20), ContainsRegex("\nb +no agent"));
  EXPECT_THAT(top.Text(20), ContainsRegex("\na +idle"));
  top.OnFrame(std::make_shared<const FrameMessage>(FrameOf(second)));
  StatusMessage status;
  status.run = 1;
  top.OnStatus(status);
  EXPECT_THAT(top.Text(20), ContainsRegex("\nb +no agent"));
  EXPECT_THAT(top.Text(20), ContainsRegex("\nc +idle"));
  EXPECT_THAT(top.Text(20), HasSubstr(" 1 without an agent"));
  const SessionMessage third = SessionOf({"c"}, 2);
  top.OnSession(third);
  top.OnFrame(std::make_shared<const FrameMessage>(FrameOf(third)));
  EXPECT_THAT(top.Text(20), HasSubstr(" 0 without an agent"));
}

RunOutcome SomeOutcome() {
  RunOutcome outcome;
  outcome.run.ticks = 600;
  outcome.run.sim_seconds = 60.0;
  outcome.run.robots = 2;
  outcome.run.stalls = 4;
  outcome.run.state_hash = 0x0123456789abcdefu;
  outcome.run.slowest = {{"r1", 17, 0.5}};
  outcome.run.lost = {"r0"};
  outcome.run.totals = {{.robot = "r0", .distance = 12.34, .stalls = 3, .contacts = {"wall", "r1"}},
                        {.robot = "r1", .distance = 5.0, .joules = 40.0, .capacity = 80.0}};
  outcome.processes = 3;
  outcome.agent_peak_memory_mib = 8.5;
  outcome.agents_restarted = 1;
  return outcome;
}

TEST(Summary, IsAJsonObjectWithTheHashAsText) {
  nlohmann::json json = nlohmann::json::parse(SummaryJson(SomeOutcome()));
  EXPECT_EQ(json["ticks"], 600);
  EXPECT_EQ(json["processes"], 3);
  EXPECT_EQ(json["agents_restarted"], 1);
  EXPECT_EQ(json["state_hash"], "0123456789abcdef");
  EXPECT_EQ(json["slowest_robots"][0]["robot"], "r1");
  for (const char* key : {"sim_seconds", "wall_seconds", "real_time_factor", "robots", "startup_seconds", "stalls",
                          "service_peak_memory_mib", "agent_peak_memory_mib", "lost", "interrupted"}) {
    EXPECT_TRUE(json.contains(key)) << key;
  }
  EXPECT_EQ(json["robot_totals"][0]["contacts"], nlohmann::json::array({"wall", "r1"}));
  EXPECT_EQ(json["robot_totals"][1]["joules"], 40.0);
  EXPECT_FALSE(json["robot_totals"][0].contains("joules"));
}

TEST(Summary, HasTheTrafficOfRobotsOnLanes) {
  RunOutcome outcome = SomeOutcome();
  EXPECT_THAT(SummaryText(outcome, {}), Not(HasSubstr("on lanes")));
  outcome.run.traffic = {
      .robots = 2, .seconds = 60.0, .arrivals = 6, .arrivals_per_hour = 360.0, .utilisation = 0.614, .waiting = 0.2};
  outcome.run.waits = {{.kind = "lane", .place = "0: a - b", .seconds = 8.25, .longest = 5.0, .waits = 2},
                       {.kind = "door", .place = "gate", .seconds = 1.5, .longest = 1.5, .waits = 1}};
  EXPECT_THAT(
      SummaryText(outcome, {}),
      HasSubstr("2 robots on lanes: 6 arrivals (360 an hour), 61 % of their time moving to goals, 20 % waiting\n"
                "waits at lane 0: a - b: 8.2 s in 2 waits, the longest 5.0 s\n"
                "waits at door gate: 1.5 s in 1 wait, the longest 1.5 s\n"));
  const nlohmann::json json = nlohmann::json::parse(SummaryJson(outcome));
  EXPECT_EQ(json["traffic"]["arrivals"], 6);
  EXPECT_EQ(json["traffic"]["utilisation"], 0.614);
  EXPECT_EQ(json["waits"][1]["place"], "gate");
}

TEST(Summary, IsOfRobotsUnlessStatisticsAreAskedFor) {
  const std::string text = SummaryText(SomeOutcome(), {});
  EXPECT_THAT(text, HasSubstr("2 robots, 4 stalls, state hash 0123456789abcdef\n"
                              "robot  distance  energy  contacts\n"
                              "r0       12.3 m       -  3: wall, r1\n"
                              "r1        5.0 m    50 %  none\n"));
  EXPECT_THAT(text, Not(HasSubstr("goals")));
  EXPECT_THAT(text, Not(HasSubstr("MiB")));
  EXPECT_THAT(text, Not(HasSubstr("slowest robots")));
  EXPECT_THAT(text, HasSubstr("without an agent at the end: r0"));
}

TEST(Summary, ShowsGoalsAndGripsWhereThereAreAny) {
  RunOutcome outcome = SomeOutcome();
  outcome.run.totals[0].goals = 2;
  outcome.run.totals[0].goals_reached = 1;
  outcome.run.totals[1].grips = 3;
  const std::string text = SummaryText(outcome, {});
  EXPECT_THAT(text, HasSubstr("robot  distance   goals  gripped  energy  contacts\n"
                              "r0       12.3 m  1 of 2        0       -  3: wall, r1\n"));
  EXPECT_THAT(SummaryText(outcome, {.has_styles = true}), HasSubstr("\033[1mrobot  distance"));
}

TEST(Summary, ShowsTheFirstOfManyRobots) {
  RunOutcome outcome = SomeOutcome();
  outcome.run.robots = 100;
  outcome.run.totals.assign(100, {.robot = "r"});
  EXPECT_THAT(SummaryText(outcome, {}), HasSubstr("and 88 more robots"));
}

TEST(StyledLine, MarksTheWordsThatMatterOnATerminal) {
  EXPECT_EQ(StyledLine("w.world:1:2: error: no", true), "w.world:1:2: \033[1;31merror:\033[0m no");
  EXPECT_EQ(StyledLine("error: no", true), "\033[1;31merror:\033[0m no");
  EXPECT_EQ(StyledLine("terror: no", true), "terror: no");
  EXPECT_EQ(StyledLine("viewer: http://x/", true), "viewer: \033[1;4mhttp://x/\033[0m");
  EXPECT_EQ(StyledLine("error: no", false), "error: no");
}

TEST(Summary, ShowsLostRobotsAndMemory) {
  std::string text = SummaryText(SomeOutcome(), {.with_stats = true});
  EXPECT_THAT(text, HasSubstr("3 processes, first tick"));
  EXPECT_THAT(text, HasSubstr("8.5 MiB the largest agent"));
  EXPECT_THAT(text, HasSubstr("1 restart of agents that died\n"));
  EXPECT_THAT(text, HasSubstr("without an agent at the end: r0"));
  EXPECT_THAT(text, Not(HasSubstr("stopped before its end")));
}

TEST(Summary, CountsRobotsThatStoodStillAndNamesTheFirstOfManyThatAreLost) {
  RunOutcome outcome = SomeOutcome();
  outcome.run.frozen = 12;
  outcome.run.lost.assign(12, "r");
  const std::string text = SummaryText(outcome, {});
  EXPECT_THAT(text, HasSubstr("12 robots stood still in some ticks, without an agent"));
  EXPECT_THAT(text, HasSubstr("without an agent at the end: r, r, r, r, r, r, r, r, r, r and 2 more\n"));
  EXPECT_EQ(ExitStatusOf(outcome.run), kExitRobotsLost);
  outcome.run.interrupted = true;
  EXPECT_EQ(ExitStatusOf(outcome.run), kExitInterrupted);
}

TEST(Summary, OfOneProcessOmitsTheNetworkAndTheSlowestRobots) {
  RunOutcome outcome = SomeOutcome();
  outcome.run.frames_repeated = 3;
  EXPECT_THAT(SummaryText(outcome, {.with_stats = true}), HasSubstr("slowest robots: r1"));
  EXPECT_THAT(SummaryText(outcome, {.with_stats = true}), HasSubstr("3 frames resent"));
  outcome.processes = 1;
  EXPECT_THAT(SummaryText(outcome, {.with_stats = true}), Not(HasSubstr("slowest robots")));
  EXPECT_THAT(SummaryText(outcome, {.with_stats = true}), Not(HasSubstr("frames resent")));
}

TEST(SessionTable, HasALineForEachSession) {
  SessionInfo running{"cave-1", 1, "host", 42, "cave", 100, WaitingStatus()};
  SessionInfo starting{"lab", 2, "host", 7, "lab", 3, std::nullopt};
  std::string table = SessionTable({running, starting});
  EXPECT_THAT(table, HasSubstr("WAITING FOR\n"));
  EXPECT_THAT(table, HasSubstr("312/600  31.2         12.34        99/100         a, b, c, d and 2 more (1.2 s)\n"));
  EXPECT_THAT(table, HasSubstr("lab      lab    host:7"));
  EXPECT_EQ(SessionTable({}).find('\n'), SessionTable({}).size() - 1);
}

TEST(SessionTable, IsPlainTextWhateverTheNetworkSends) {
  const SessionInfo hostile{"a\nb", 1, "\x1b[2J", 7, "\xff", 3, std::nullopt};
  EXPECT_THAT(SessionTable({hostile}), HasSubstr("a b      ?      "));
  EXPECT_THAT(SessionTable({hostile}), HasSubstr(" [2J:7  "));
}

TEST(DescribeWorld, DescribesTheContentOfAWorld) {
  LoadedWorld loaded;
  loaded.world.name = "w";
  loaded.world.shapes.resize(1);
  loaded.world.shapes[0].rectangles.resize(12);
  loaded.world.models.resize(2);
  for (ModelDescription& model : loaded.world.models) model.shape = ShapeId(0);
  RobotDescription robot{.name = "r0", .root = ModelId(0)};
  SensorDescription ranger{.name = "ranger:0", .model = ModelId(0)};
  RaySensors(ranger).resize(2);
  RaySensors(ranger)[1].samples = 180;
  robot.sensors.push_back(ranger);
  loaded.world.robots.push_back(robot);
  for (const char* name : {"lift", "left", "right"}) {
    loaded.world.joints.push_back(
        JointDescription{.name = name, .robot = RobotId(0), .position = {0.0, 0.25}, .max_speed = 0.5});
  }
  loaded.world.joints[2].type = JointType::kRevolute;
  GripperDescription gripper{.name = "hand", .robot = RobotId(0), .left = JointId(1), .right = JointId(2)};
  gripper.beams.resize(2);
  loaded.world.grippers = {gripper};
  gripper.lift = JointId(0);
  gripper.autosnatch = true;
  loaded.world.grippers.push_back(gripper);
  loaded.world.models[1].name = "box";
  loaded.world.models[1].size_x = 0.5;
  loaded.world.objects = {ModelId(1)};
  loaded.map_width = 40;
  loaded.map_height = 30;
  loaded.warnings.push_back({{"w.world", 3, 1}, "unknown property \"fancy\""});
  std::string text = DescribeWorld(loaded);
  EXPECT_THAT(text, HasSubstr("map: 40 x 30 pixels\n"));
  EXPECT_THAT(text, HasSubstr("models: 2 (0 blocks, 24 rectangles from bitmaps)\n"));
  EXPECT_THAT(text, HasSubstr("  r0: differential drive, controller idle, ranger:0 (2 sensors, 181 rays)\n"));
  EXPECT_THAT(text, HasSubstr("rays)\n    joint lift: shifts from 0 to 0.25 m, at most 0.5 m/s\n"
                              "    joint left: shifts from 0 to 0.25 m, at most 0.5 m/s\n"
                              "    joint right: turns from 0 to 0.25 rad, at most 0.5 rad/s\n"
                              "    gripper hand: fingers left and right, no lift, 2 beams\n"
                              "    gripper hand: fingers left and right, lift lift, 2 beams, autosnatch\n"
                              "objects: 1 (gravity 9.81 m/s^2)\n  box: 0.5 x 0 x 0 m\n"));
  EXPECT_THAT(text, HasSubstr("warnings: 1\n  w.world:3:1: warning: unknown property \"fancy\"\n"));
}

TEST(DescribeWorld, CountsThePartsOfABuilding) {
  Site site;
  site.name = "house";
  site.levels.resize(2);
  site.levels[0].name = "L1";
  site.levels[0].drawing = "plan.png";
  site.levels[0].scale = 0.05;
  site.levels[0].walls.resize(1);
  site.levels[0].lanes.resize(3);
  site.levels[0].lanes[2].graph = 4;
  site.levels[0].human_lanes.resize(2);
  site.levels[1].name = "L2";
  site.levels[1].elevation = 4.5;
  site.lifts.push_back({.name = "up", .width = 1.5, .depth = 2.0, .doors_at = {{}, {0}}});
  site.crowd.groups = {{.count = 3}, {.count = 1, .robots = {"r0"}}};
  LoadedWorld loaded;
  loaded.site = std::make_shared<const Site>(site);
  loaded.world.places = {{.name = "a", .tags = {"L1", "charger", "dock:d1"}}, {.name = "b", .tags = {"L1", "charger"}}};
  EXPECT_THAT(
      DescribeWorld(loaded),
      HasSubstr("building: house, 2 levels, 1 lift\n"
                "  level L1: elevation 0 m, drawing plan.png of 0.05 m a pixel, 1 wall, 0 doors, 0 floors, 3 lanes "
                "in 2 graphs, 0 vertices, 2 lanes of people\n"
                "  level L2: elevation 4.5 m, 0 walls, 0 doors, 0 floors, 0 lanes in 0 graphs, 0 vertices\n"
                "  lift up: 1.5 x 2 m, at L2\n"
                "  places: 2, 2 charger, 1 dock\n"
                "  crowd: 3 people in 2 groups, off\n"
                "models: 0"));
}

TEST(PoseText, HasThreeOrFourNumbersAsInScenarios) {
  const PoseText three = test::ValueOf(ParsePoseText("1.5,-2,90"));
  EXPECT_EQ(three.X_WE, (Pose{1.5, -2.0, 0.0, std::numbers::pi / 2.0}));
  EXPECT_FALSE(three.has_height);
  const PoseText four = test::ValueOf(ParsePoseText("-1,2,0.5,0"));
  EXPECT_EQ(four.X_WE, (Pose{-1.0, 2.0, 0.5, 0.0}));
  EXPECT_TRUE(four.has_height);
}

TEST(PoseText, AnyOtherTextIsAnError) {
  for (const char* text :
       {"", "1", "1,2", "1,2,3,4,5", "1,2,x", "1,,2", "1,2,3,", ",1,2,3", "1 2 3", "1,2,nan", "1,2,1e999", "1, 2, 3"}) {
    const Result<PoseText> read = ParsePoseText(text);
    ASSERT_FALSE(read.ok()) << text;
    EXPECT_EQ(read.error().message,
              "found '" + std::string(text) + "', expected X,Y,HEADING or X,Y,Z,HEADING, in metres and degrees");
  }
}

TEST(ShellWords, AreQuotedIfAShellWouldInterpretThem) {
  EXPECT_EQ(ShellQuoted(std::vector<std::string>{"a/b", "c d", "it's", ""}), "a/b 'c d' 'it'\\''s' ''");
}

TEST(ShellWords, FillInReplacesKnownNamesAndKeepsOtherBraces) {
  EXPECT_EQ(FillIn("ssh {host} ${HOME} {x {host}", {{"host", "h1"}}), "ssh h1 ${HOME} {x h1");
}

TEST(HostMessages, EncodeAllBytes) {
  std::string bytes;
  for (int i = 0; i < 256; ++i) bytes += static_cast<char>(i);
  EXPECT_EQ(FromHexadecimal(ToHexadecimal(std::as_bytes(std::span(bytes)))), bytes);
  for (const char* text : {"a", "0g", "AB", "0 "}) EXPECT_EQ(FromHexadecimal(text), std::nullopt) << text;
}

TEST(HostMessages, AreObjectsOrInvalid) {
  EXPECT_FALSE(ReadHostMessage("Welcome to Debian").ok());
  EXPECT_FALSE(ReadHostMessage("17").ok());
  EXPECT_TRUE(ReadHostMessage(R"({"output":"x"})").ok());
}

TEST(TeleopKeysTest, KeysMoveForAWhileAfterTheirLastRepetition) {
  TeleopKeys keys({.speed = 0.5, .turn_rate = 1.0, .hold_seconds = 0.7});
  EXPECT_TRUE(keys.TwistAt(0.0).IsZero());
  EXPECT_TRUE(keys.Press("w", 10.0));
  EXPECT_EQ(keys.TwistAt(10.6), (Twist{0.5, 0.0, 0.0}));
  EXPECT_TRUE(keys.TwistAt(10.8).IsZero());
  EXPECT_TRUE(keys.Press("ww", 11.0));
  EXPECT_TRUE(keys.Press("w", 11.5));
  EXPECT_EQ(keys.TwistAt(12.1).vx, 0.5);
  EXPECT_TRUE(keys.Press("s", 12.1));
  EXPECT_EQ(keys.TwistAt(12.2).vx, -0.5);
}

TEST(TeleopKeysTest, DirectionsAddUp) {
  TeleopKeys keys({.speed = 0.5, .turn_rate = 1.0, .hold_seconds = 0.7});
  EXPECT_TRUE(keys.Press("waq", 0.0));
  EXPECT_EQ(keys.TwistAt(0.1), (Twist{0.5, 0.5, 1.0}));
  EXPECT_TRUE(keys.Press("de", 0.1));
  EXPECT_EQ(keys.TwistAt(0.2), (Twist{0.5, -0.5, -1.0}));
  EXPECT_TRUE(keys.Press(" ", 0.2));
  EXPECT_TRUE(keys.TwistAt(0.2).IsZero());
}

TEST(TeleopKeysTest, ArrowsMayArriveInPieces) {
  TeleopKeys keys({});
  EXPECT_TRUE(keys.Press("\033", 0.0));
  EXPECT_TRUE(keys.Press("[", 0.0));
  EXPECT_TRUE(keys.TwistAt(0.1).IsZero());
  EXPECT_TRUE(keys.Press("A\033OD", 0.0));
  EXPECT_EQ(keys.TwistAt(0.1), (Twist{0.5, 0.0, 1.0}));
  // Other sequences, and letters within them, are no keys.
  EXPECT_TRUE(keys.Press(" \033[3~\033[1;5x\033[15~\033Z", 0.0));
  EXPECT_TRUE(keys.TwistAt(0.1).IsZero());
  EXPECT_TRUE(keys.Press("w", 0.0));
  EXPECT_EQ(keys.TwistAt(0.1).vx, 0.5);
}

TEST(TeleopKeysTest, SpeedsAreScaledWithinBounds) {
  TeleopKeys keys({.speed = 0.5, .turn_rate = 1.0, .hold_seconds = 1.0});
  EXPECT_TRUE(keys.Press("w+=", 0.0));
  EXPECT_DOUBLE_EQ(keys.TwistAt(0.1).vx, 0.5 * 1.25 * 1.25);
  EXPECT_TRUE(keys.Press("---", 0.0));
  EXPECT_DOUBLE_EQ(keys.TwistAt(0.1).vx, 0.4);
  EXPECT_TRUE(keys.Press(std::string(1000, '+'), 0.0));
  EXPECT_EQ(keys.TwistAt(0.1).vx, 100.0);
}

TEST(TeleopKeysTest, OrdersToTheGripperAreGivenOnce) {
  TeleopKeys keys({});
  EXPECT_FALSE(keys.DrainOrder());
  EXPECT_TRUE(keys.Press("c", 0.0));
  EXPECT_TRUE(keys.Press("r", 0.0));
  EXPECT_EQ(keys.DrainOrder(), (GripperOrder{0, 0.0, 100.0}));
  EXPECT_FALSE(keys.DrainOrder());
  EXPECT_TRUE(keys.Press("of", 0.0));
  EXPECT_EQ(keys.DrainOrder(), (GripperOrder{0, 100.0, 0.0}));
}

TEST(TeleopKeysTest, XAndCtrlDEnd) {
  TeleopKeys keys({});
  EXPECT_FALSE(keys.Press("wx", 0.0));
  EXPECT_FALSE(keys.Press("\004", 0.0));
  EXPECT_TRUE(keys.Press(std::string("\0\177zZ", 4), 0.0));
}

TEST(GoalTextTest, ReadsPointsAndAHeading) {
  const Result<Goal> goal = ParseGoalText({"1,-2.5", "3e0,4,-90"});
  ASSERT_TRUE(goal.ok());
  EXPECT_EQ(goal.value().waypoints, (std::vector<Vec2>{{1.0, -2.5}, {3.0, 4.0}}));
  EXPECT_NEAR(*goal.value().heading, -1.5707963267948966, 1e-15);
  EXPECT_FALSE(ParseGoalText({"1,2"}).value().heading);
  for (const char* text : {"", "1", "1,", ",1", "1,2,3,4", "1;2", "1,2 ", "inf,1", "1,0x2", "a,b"}) {
    EXPECT_FALSE(ParseGoalText({text}).ok()) << text;
  }
}

}  // namespace
}  // namespace troupe
