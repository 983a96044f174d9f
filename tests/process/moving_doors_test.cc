// Doors and lifts in motion: the same hashes in every kind of run, after requests of users, rewinds and kills.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/process/programs.h"
#include "tests/support/dds_domain.h"
#include "tests/support/files.h"
#include "transport/dds/tools/control_client.h"

namespace troupe::test {
namespace {

// A robot rides to the other level and back, opening and closing a door that another one passes.
constexpr const char* kLift = "guesthouse_lift.json";
// Two robots follow lanes through the same door and with the same lift.
constexpr const char* kLanes = "guesthouse_lanes.json";
// Four robots on a single track with sidings, whose ways are planned as one.
constexpr const char* kSidings = "sidings.json";
// Guests open doors and ride the lift, which they share with a robot.
constexpr const char* kGuests = "guesthouse_guests.json";

std::vector<std::string> RunOf(const std::string& scenario, const std::vector<std::string>& options) {
  return Words("run % --domain % --headless",
               {WorldPath("../../../worlds/sites/" + scenario), std::to_string(TestDomain())}) +
         options;
}
std::vector<std::string> RunOfLift(const std::vector<std::string>& options) {
  return RunOf(kLift, options);
}

std::string HashesOf(const std::vector<std::string>& options, const char* scenario = kLift) {
  TemporaryFolder folder;
  OutputOf(Troupe(RunOf(scenario, options + Words("--ticks 700 --speed max --hash-log %", {folder.Path("hashes")}))));
  return folder.Read("hashes");
}

void Kill(const Program& run, const std::string& part) {
  for (const pid_t child : ChildrenOf(run.pid())) {
    if (CommandLineOf(child).find(part) == std::string::npos) continue;
    ASSERT_EQ(kill(child, SIGKILL), 0);
    return;
  }
  FAIL() << "no process with " << part;
}

TEST(DoorsOverDds, AreTheSameInEveryKindOfRun) {
  TemporaryFolder folder;
  const std::string expected = HashesOf({"--in-process", "--record", folder.Path("run.mcap")});
  ASSERT_FALSE(expected.empty());
  EXPECT_TRUE(HashesOf({}) == expected) << "a process for each robot";
  EXPECT_TRUE(HashesOf({"--robots-per-process", "2", "--data-sharing", "off"}) == expected);
  EXPECT_TRUE(HashesOf({"--faults", "loss=0.02,duplicate=0.05,reorder=0.05,delay=0.1:0.002,seed=3"}) == expected);
  OutputOf(Troupe({"replay", folder.Path("run.mcap"), "--verify", "--controllers"}));
}

TEST(LanesOverDds, AreFollowedAlikeInEveryKindOfRun) {
  TemporaryFolder folder;
  const std::string expected = HashesOf({"--in-process", "--record", folder.Path("run.mcap")}, kLanes);
  ASSERT_FALSE(expected.empty());
  EXPECT_TRUE(HashesOf({}, kLanes) == expected) << "a process for each robot";
  EXPECT_TRUE(HashesOf({"--robots-per-process", "2", "--threads", "2"}, kLanes) == expected);
  OutputOf(Troupe({"replay", folder.Path("run.mcap"), "--verify", "--controllers"}));
}

TEST(TrafficOverDds, IsPlannedAlikeInEveryKindOfRun) {
  TemporaryFolder folder;
  const std::string expected = HashesOf({"--in-process", "--record", folder.Path("run.mcap")}, kSidings);
  ASSERT_FALSE(expected.empty());
  EXPECT_TRUE(HashesOf({}, kSidings) == expected) << "a process for each robot";
  EXPECT_TRUE(HashesOf({"--robots-per-process", "3", "--data-sharing", "off", "--threads", "2"}, kSidings) == expected);
  EXPECT_TRUE(HashesOf({"--faults", "loss=0.02,duplicate=0.05,reorder=0.05,delay=0.1:0.002,seed=3"}, kSidings) ==
              expected);
  OutputOf(Troupe({"replay", folder.Path("run.mcap"), "--verify", "--controllers"}));
}

TEST(TrafficOverDds, HasTheSameSumsInEveryKindOfRun) {
  TemporaryFolder folder;
  const auto sums_of = [&](const std::vector<std::string>& options) {
    const std::string file = folder.Path("summary");
    OutputOf(Troupe(RunOf(kSidings, Words("--ticks 1500 --speed max --summary %", {file}) + options)));
    const nlohmann::json summary = nlohmann::json::parse(folder.Read("summary"));
    return nlohmann::json{summary["traffic"], summary["waits"]};
  };
  const nlohmann::json expected = sums_of({"--in-process"});
  EXPECT_EQ(expected[0]["robots"], 4);
  EXPECT_GT(expected[0]["arrivals"], 0);
  EXPECT_GT(expected[0]["utilisation"], 0.1);
  EXPECT_FALSE(expected[1].empty()) << "they wait for each other";
  EXPECT_EQ(sums_of({}), expected) << "a process for each robot";
  EXPECT_EQ(sums_of({"--robots-per-process", "3", "--threads", "2"}), expected);
}

TEST(TrafficOverDds, IsPlannedAlikeWhateverDies) {
  TemporaryFolder folder;
  Program run = Troupe(RunOf(kSidings, Words("--ticks 700 --speed 20 --on-agent-loss rebuild --lease 1 --hash-log %",
                                             {folder.Path("hashes")})));
  run.WaitForLine("ready");
  Kill(run, "robot-agent");
  run.WaitForLineAfter("restart ");
  Kill(run, "world-service");
  run.WaitForLineAfter("the world service has been started again");
  EXPECT_EQ(run.Wait(), 0) << run.output();
  EXPECT_TRUE(folder.Read("hashes") == HashesOf({"--in-process"}, kSidings));
}

TEST(GuestsOverDds, RideAlikeInEveryKindOfRun) {
  TemporaryFolder folder;
  const std::string expected = HashesOf({"--in-process", "--record", folder.Path("run.mcap")}, kGuests);
  ASSERT_FALSE(expected.empty());
  EXPECT_TRUE(HashesOf({"--in-process", "--threads", "2"}, kGuests) == expected);
  EXPECT_TRUE(HashesOf({"--data-sharing", "off", "--threads", "2"}, kGuests) == expected) << "processes";
  OutputOf(Troupe({"replay", folder.Path("run.mcap"), "--verify", "--controllers"}));
}

TEST(GuestsOverDds, RideAlikeWhateverDies) {
  TemporaryFolder folder;
  Program run = Troupe(RunOf(
      kGuests, Words("--ticks 700 --speed 20 --on-agent-loss rebuild --lease 1 --hash-log %", {folder.Path("hashes")}) +
                   Words("--record %", {folder.Path("run.mcap")})));
  run.WaitForLine("ready");
  Kill(run, "world-service");
  run.WaitForLineAfter("the world service has been started again");
  EXPECT_EQ(run.Wait(), 0) << run.output();
  EXPECT_TRUE(folder.Read("hashes") == HashesOf({"--in-process"}, kGuests));
}

// A rewind to a tick at which guests wait for the lift or ride in it.
TEST(GuestsOverDds, RideOnFromATickThatIsRewoundTo) {
  TemporaryFolder folder;
  const std::string session = TestSession("guests");
  Program run = Troupe(RunOf(kGuests, {"--paused", "--session", session, "--record", folder.Path("run.mcap")}));
  ControlClient client(NetworkOf(session));
  ASSERT_TRUE(client.WaitForService(kSeconds).ok()) << run.output();
  run.WaitForLine("ready");
  const auto call = [&](const control::Request& request) {
    const Result<ControlReply> reply = client.Call(request, kSeconds);
    EXPECT_TRUE(reply.ok() && reply.value().done) << (reply.ok() ? reply.value().problem : reply.error().message);
    return reply.ok() ? reply.value() : ControlReply();
  };
  call(control::Step{.ticks = 200});
  const std::uint64_t first = call(control::Step{.ticks = 200}).state_hash;
  EXPECT_EQ(call(control::Rewind{.tick = 200}).tick, 200u);
  EXPECT_EQ(call(control::Step{.ticks = 200}).state_hash, first);
  run.Interrupt();
  OutputOf(Troupe({"replay", folder.Path("run.mcap"), "--verify"}));
}

TEST(LanesOverDds, LeadToPlacesThatUsersName) {
  const std::string session = TestSession("lanes");
  Program run = Troupe(RunOf(kLanes, {"--session", session, "--speed", "50"}));
  run.WaitForLine("ready");
  const auto go = [&](const std::string& place, int status) {
    return OutputOf(Troupe(Words("goto --domain % --session % tiny_1", {std::to_string(TestDomain()), session}) +
                           std::vector<std::string>{place}),
                    status);
  };
  EXPECT_THAT(go("room_1", 0), testing::ContainsRegex("tiny_1 is at (2\\.9|3\\.0)"));
  EXPECT_THAT(go("attic", 3), testing::HasSubstr("error: the world has no entity 'attic'"));
  EXPECT_THAT(go("rom_1", 3), testing::HasSubstr("error: the world has no entity 'rom_1'; did you mean 'room_"));
  EXPECT_THAT(OutputOf(Troupe(Words("ctl --domain % --session % get room_1", {std::to_string(TestDomain()), session}))),
              testing::HasSubstr("room_1"));
  run.Interrupt();
}

// A robot that a user calls the lift away from, at the moment at which it enters, rides all the same.
TEST(LanesOverDds, LeadThroughALiftThatAUserCallsAway) {
  TemporaryFolder folder;
  const std::string session = TestSession("lanecall");
  Program run = Troupe(Words(
      "run % --headless --no-ros --paused --domain % --session %",
      {folder.Write("s.json", R"({"world": ")" + WorldPath("../../../worlds/sites/guesthouse.building.yaml") + R"(",
                "people": [], "robots": [{"name": "tiny_1", "controller": {"name": "lanes",
                  "parameters": {"places": ["room_1"], "repeat": false}}},
                {"name": "delivery_1", "pose": [2, -5, 0], "controller": "idle"}]})"),
       std::to_string(TestDomain()), session}));
  run.WaitForLine("ready");
  const auto ctl = [&](const std::vector<std::string>& words) { return OutputOf(Ctl(session, words)); };
  ctl({"step", "288"});
  EXPECT_THAT(ctl({"get", "guest_lift"}), testing::HasSubstr(R"("session":"tiny_1")"));
  ctl({"lift", "guest_lift", "L2"});
  ctl({"step", "601"});
  EXPECT_THAT(ctl({"get", "tiny_1"}), testing::ContainsRegex("position +(2\\.9|3\\.0)[0-9]+,-5\\.[45][0-9]+,4\\.000"));
  EXPECT_THAT(ctl({"get", "L2"}), testing::HasSubstr(R"(level {"name":"L2","z":4,"robots":1)"));
  run.Interrupt();
}

// The session of a robot ends with its process, which is not started again; another robot has the lift then.
TEST(LanesOverDds, LeaveTheLiftOfALostRobotToOthers) {
  TemporaryFolder folder;
  const std::string session = TestSession("lanelost");
  Program run = Troupe(Words(
      "run % --headless --no-ros --paused --domain % --session % --restart-agents 0 --lease 2",
      {folder.Write("s.json", R"({"world": ")" + WorldPath("../../../worlds/sites/guesthouse.building.yaml") + R"(",
                "people": [], "without": ["delivery_1"], "robots": [
                {"name": "tiny_1", "controller": {"name": "lanes", "parameters": {"places": ["room_1", "charger_1"]}}},
                {"name": "tiny_2", "model": "TinyRobot", "pose": [4, -5.5, 0], "controller": "idle"}]})"),
       std::to_string(TestDomain()), session}));
  run.WaitForLine("ready");
  const auto ctl = [&](const std::vector<std::string>& words) { return OutputOf(Ctl(session, words)); };
  ctl({"step", "250"});
  EXPECT_THAT(ctl({"get", "guest_lift"}), testing::HasSubstr(R"("session":"tiny_1")"));
  Kill(run, "--robot=tiny_1");
  ctl({"step", "20"});
  EXPECT_THAT(ctl({"get", "guest_lift"}), testing::Not(testing::HasSubstr("session")));
  run.Signal(SIGINT);
  run.Wait();
  EXPECT_THAT(run.output(), testing::HasSubstr("tiny_1"));
}

// Two levels with places one above the other.
TEST(LanesOverDds, LeadToAPlaceOnItsLevel) {
  TemporaryFolder folder;
  const std::string session = TestSession("stacked");
  const std::string building = folder.Write("s.building.yaml", R"(
coordinate_system: cartesian_meters
levels:
  A:
    vertices: [[7, 3, 0, cabA, {lift_cabin: [1, up]}], [7, 6, 0, doorA],
               [11, 8, 0, eA, {spawn_robot_type: [1, TinyRobot], spawn_robot_name: [1, r1]}]]
    lanes: [[0, 1, {bidirectional: true}], [1, 2, {bidirectional: true}]]
  B:
    elevation: 4
    vertices: [[7, 3, 0, cabB, {lift_cabin: [1, up]}], [7, 6, 0, doorB], [11, 8, 0, eB]]
    lanes: [[0, 1, {bidirectional: true}], [1, 2, {bidirectional: true}]]
lifts:
  up:
    {width: 2, depth: 2, x: 7, y: 3, yaw: 0, initial_floor_name: A,
     doors: {d: {motion_axis_orientation: 0, width: 1.2, x: 0, y: 1}}, level_doors: {A: [d], B: [d]}}
)");
  Program run = Troupe(Words("run % --headless --no-ros --domain % --session % --speed 50",
                             {building, std::to_string(TestDomain()), session}));
  run.WaitForLine("ready");
  const auto go = [&](const std::string& place) {
    return OutputOf(Troupe(Words("goto --domain % --session % r1 %", {std::to_string(TestDomain()), session, place})));
  };
  go("eB");
  const auto at = [&] { return OutputOf(Ctl(session, {"get", "r1"})); };
  EXPECT_THAT(at(), testing::ContainsRegex("position +(10\\.9|11\\.0)[0-9]+,(7\\.9|8\\.0)[0-9]+,4\\.000"));
  go("eA");
  EXPECT_THAT(at(), testing::ContainsRegex("position +(10\\.9|11\\.0)[0-9]+,(7\\.9|8\\.0)[0-9]+,0\\.000"));
  run.Interrupt();
}

// A square of lanes, and a box, a person, a robot or a door that stays closed on one side of it.
class ObstructedLanes : public testing::Test {
 protected:
  // The output of a run in which the robot `r` is to drive from a to b; `lanes`: those after the one from a to b. The
  // robot is to be there at the end, or not. `planned`: in the planned traffic.
  std::string Run(const std::string& lanes, const std::string& obstacle, bool planned, bool arrives) {
    folder_.Write("s.building.yaml", R"(
coordinate_system: cartesian_meters
levels:
  L1:
    vertices: [[0, 0, 0, a, {spawn_robot_type: [1, TinyRobot], spawn_robot_name: [1, r]}], [6, 0, 0, b], [6, 5, 0, c],
               [0, 5, 0, d], [3, 0.6, 0, ""], [3, -0.6, 0, ""]]
    lanes: [[0, 1, {bidirectional: true}])" +
                                         lanes + R"(]
    doors: [[4, 5, {name: gate, type: hinged, motion_axis: start, motion_degrees: 90, motion_direction: 1}]]
)");
    const std::string scenario = folder_.Write(
        "s.json", R"~({"world": "s.building.yaml", "ticks": 900, "expect": ["eventually at(r, \"b\")"], "robots": [
          {"name": "r", "controller": {"name": "lanes", "parameters": {"places": ["b"], "repeat": false, "planned": )~" +
                      std::string(planned ? "true}}}" : "false}}}") + obstacle + "}");
    OutputOf(Troupe({"test", scenario, "--no-shrink"}), arrives ? 0 : 1);
    return OutputOf(Troupe({"run", scenario, "--in-process", "--headless", "--no-ros"}));
  }

  TemporaryFolder folder_;
};

constexpr const char* kRound =
    ", [1, 2, {bidirectional: true}], [2, 3, {bidirectional: true}], [3, 0, {bidirectional: true}]";
constexpr const char* kBox = R"(], "models": [{"name": "box", "model": "model", "pose": [1.6, 0, 0],
  "properties": {"size": [0.4, 0.4, 0.6]}}])";

TEST_F(ObstructedLanes, AreLeftForOtherLanes) {
  const std::string closed =
      R"(], "override": [{"match": {"name": "gate"}, "properties": {"operated": 0, "opening": 0}}])";
  const std::pair<std::string, std::string> obstacles[] = {
      {kBox, "box is in the way from a to b: "},
      {R"(], "people": [{"count": 1, "region": [1.59, -0.01, 1.61, 0.01], "name_prefix": "guest"}])", ""},
      {R"(, {"name": "lost", "model": "TinyRobot", "pose": [1.6, 0, 0], "controller": "idle"}])", ""},
      {closed, "door gate, which does not open, is in the way from a to b: "},
  };
  for (const bool planned : {false, true}) {
    const std::string then = planned ? "asks for another way" : "goes round";
    for (const auto& [obstacle, report] : obstacles) {
      const std::string output = Run(kRound, obstacle, planned, true);
      EXPECT_THAT(output, testing::HasSubstr(report.empty() ? "" : report + then));
      EXPECT_THAT(output, testing::HasSubstr(" 0 stalls"));
    }
  }
}

TEST_F(ObstructedLanes, AreWaitedForWithoutOthers) {
  const std::string output = Run("", kBox, false, false);
  EXPECT_THAT(output, testing::HasSubstr("box is in the way from a to b: waits, since there is no better way to b"));
  EXPECT_THAT(output, testing::HasSubstr(" 0 stalls"));
  const std::string planned = Run("", kBox, true, false);
  EXPECT_THAT(planned, testing::HasSubstr("box is in the way from a to b: asks for another way"));
  EXPECT_THAT(planned, testing::HasSubstr(" 0 stalls"));
}

TEST(DoorsOverDds, AreTheSameWhateverDies) {
  TemporaryFolder folder;
  Program run =
      Troupe(RunOfLift(Words("--ticks 700 --speed 20 --on-agent-loss rebuild --lease 1 --record % --hash-log %",
                             {folder.Path("run.mcap"), folder.Path("hashes")})));
  run.WaitForLine("ready");
  Kill(run, "--robot=tiny_1");
  run.WaitForLineAfter("restart ");
  Kill(run, "world-service");
  run.WaitForLineAfter("the world service has been started again");
  EXPECT_EQ(run.Wait(), 0) << run.output();
  EXPECT_TRUE(folder.Read("hashes") == HashesOf({"--in-process"}));
}

// Requests of a user, a rewind before them and the same requests again.
TEST(DoorsOverDds, RequestsAfterARewindGiveTheSameStates) {
  TemporaryFolder folder;
  const std::string session = TestSession("doors");
  Program run =
      Troupe(RunOfLift({"--paused", "--session", session, "--record", folder.Path("run.mcap"), "--lease", "5"}));
  auto client = std::make_unique<ControlClient>(NetworkOf(session));
  ASSERT_TRUE(client->WaitForService(kSeconds).ok()) << run.output();
  run.WaitForLine("ready");
  const auto call = [&](const control::Request& request) {
    const Result<ControlReply> reply = client->Call(request, kSeconds);
    EXPECT_TRUE(reply.ok() && reply.value().done) << (reply.ok() ? reply.value().problem : reply.error().message);
    return reply.ok() ? reply.value() : ControlReply();
  };
  const auto operate = [&] {
    call(control::Door{"room_1_door", 0.0});
    call(control::Step{20});
    call(control::Lift{"guest_lift", "L2"});
    return call(control::Step{60}).state_hash;
  };
  call(control::Step{10});
  const std::uint64_t first = operate();
  EXPECT_EQ(call(control::Rewind{10}).tick, 10u);
  Kill(run, "world-service");
  run.WaitForLineAfter("the world service has been started again");
  // The other client may still wait for a reply of the service that died.
  client = std::make_unique<ControlClient>(NetworkOf(session));
  ASSERT_TRUE(client->WaitForService(kSeconds).ok()) << run.output();
  EXPECT_EQ(operate(), first);
  control::Door wrong;
  wrong.name = "no_door";
  const Result<ControlReply> refused = client->Call(wrong, kSeconds);
  ASSERT_TRUE(refused.ok());
  EXPECT_THAT(refused.value().problem, testing::HasSubstr("the world has no door 'no_door'"));
  run.Interrupt();
  OutputOf(Troupe({"replay", folder.Path("run.mcap"), "--verify"}));
}

TEST(DoorsOverDds, AreOperatedByTheCommandLine) {
  const std::string session = TestSession("doorctl");
  Program run = Troupe(RunOfLift({"--paused", "--session", session}));
  run.WaitForLine("ready");
  const auto ctl = [&](const std::vector<std::string>& words) {
    return OutputOf(Troupe(Words("ctl --domain % --session %", {std::to_string(TestDomain()), session}) + words));
  };
  EXPECT_THAT(ctl({"door", "front_door", "close"}), testing::HasSubstr("paused tick 0"));
  EXPECT_THAT(ctl({"lift", "guest_lift", "L2"}), testing::Not(testing::HasSubstr("edition"))) << "no edit";
  EXPECT_THAT(
      OutputOf(Troupe(Words("ctl --domain % --session % lift guest_lift L9", {std::to_string(TestDomain()), session})),
               3),
      testing::HasSubstr("lift 'guest_lift' has no floor 'L9', expected L1, L2"));
  run.Interrupt();
}

// Many requests to a run that plays: it never pauses, makes no edition, and its recording has them with their ticks.
// The service is killed after the reply to a request and before its tick.
TEST(DoorsOverDds, RequestsToAPlayingRunAreInputsOfItsTicks) {
  TemporaryFolder folder;
  const std::string session = TestSession("inputs");
  Program run = Troupe(RunOf(kLanes, Words("--session % --record % --hash-log % --lease 5 --speed 20",
                                           {session, folder.Path("run.mcap"), folder.Path("hashes")})));
  auto client = std::make_unique<ControlClient>(NetworkOf(session));
  ASSERT_TRUE(client->WaitForService(kSeconds).ok()) << run.output();
  run.WaitForLine("ready");
  const auto call = [&](const control::Request& request) {
    const Result<ControlReply> reply = client->Call(request, kSeconds);
    EXPECT_TRUE(reply.ok() && reply.value().done) << (reply.ok() ? reply.value().problem : reply.error().message);
    return reply.ok() ? reply.value() : ControlReply();
  };
  for (int i = 0; i < 20; ++i) {
    const ControlReply reply = call(control::Door{"room_1_door", i % 2 == 0 ? 1.0 : 0.0});
    EXPECT_EQ(reply.state, RunState::kPlaying);
    EXPECT_EQ(reply.edition, 0u);
  }
  // In a pause an input waits for the next tick: also in the journal.
  const Tick paused_at = call(control::Pause()).tick;
  call(control::Lift{"guest_lift", "L2"});
  EXPECT_EQ(call(control::GetStatus()).tick, paused_at);
  Kill(run, "world-service");
  run.WaitForLineAfter("the world service has been started again");
  client = std::make_unique<ControlClient>(NetworkOf(session));
  ASSERT_TRUE(client->WaitForService(kSeconds).ok()) << run.output();
  call(control::Step());
  EXPECT_EQ(call(control::Play()).edition, 0u);
  call(control::Door{"room_1_door", 1.0});
  run.Interrupt();
  OutputOf(Troupe({"replay", folder.Path("run.mcap"), "--verify"}));
  EXPECT_THAT(folder.Read("hashes"), testing::Not(testing::HasSubstr("edition")));
}

}  // namespace
}  // namespace troupe::test
