// Doors and lifts in motion: the same hashes in every kind of run, after requests of users, rewinds and kills.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <memory>

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
  EXPECT_THAT(go("attic", 3), testing::HasSubstr("error: the world has no place 'attic'"));
  EXPECT_THAT(OutputOf(Troupe(Words("ctl --domain % --session % get room_1", {std::to_string(TestDomain()), session}))),
              testing::HasSubstr("room_1"));
  run.Interrupt();
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
      Troupe(RunOfLift({"--paused", "--session", session, "--record", folder.Path("run.mcap"), "--lease", "1"}));
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
  EXPECT_EQ(refused.value().problem, "the world has no door 'no_door'");
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
  Program run = Troupe(RunOf(kLanes, Words("--session % --record % --hash-log % --lease 1 --speed 20",
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
