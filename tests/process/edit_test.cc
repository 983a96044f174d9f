// Editing the worlds of real runs, with the ControlClient and with `troupe ctl`.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <optional>

#include "tests/process/programs.h"
#include "tests/support/controlled_run.h"
#include "tests/support/dds_domain.h"
#include "tests/support/edits.h"
#include "tests/support/files.h"
#include "transport/dds/tools/control_client.h"
#include "worldfile/load_world.h"

namespace troupe::test {
namespace {

using testing::HasSubstr;

// Edits of every kind, with steps between them.
std::vector<control::Request> Script() {
  control::Step step;
  step.ticks = 15;
  control::Spawn spawn{.name = "late", .pose = {0.0, -2.0, 0.0, 1.0}};
  spawn.source = "rover";
  control::Spawn wall{.name = "block", .pose = {-2.0, 0.5, 0.0, 0.0}};
  wall.source = "wall";
  control::Spawn again{.name = "r1", .pose = {2.0, -2.0, 0.0, 0.5}};
  again.source = "rover";
  control::LoadWorld load;
  load.source = WorldPath("pen.world");
  return {step,
          control::SetPose{.name = "r0", .pose = {1.0, -1.0, 0.0, 0.3}},
          step,
          control::Delete{.name = "r1"},
          step,
          spawn,
          wall,
          step,
          again,
          control::SetPose{.name = "bar", .pose = {-0.6, 1.4, 0.0, 0.0}},
          step,
          control::Delete{.name = "r3"},
          control::Reset(),
          step,
          spawn,
          step,
          load,
          step};
}

template <typename Call>
std::vector<std::uint64_t> HashesOfScript(Call call) {
  std::vector<std::uint64_t> hashes;
  for (const control::Request& request : Script()) {
    const Result<ControlReply> reply = call(request);
    if (!reply.ok() || !reply.value().done) {
      ADD_FAILURE() << "request " << hashes.size() << ": "
                    << (reply.ok() ? reply.value().problem : reply.error().message);
      return hashes;
    }
    hashes.push_back(reply.value().state_hash);
  }
  return hashes;
}

std::vector<std::uint64_t> HashesOverDds(const std::string& robots_per_process) {
  const std::string session = TestSession("edits" + robots_per_process);
  Program run = RunPen({"--paused", "--session", session, "--robots-per-process", robots_per_process});
  ControlClient client(NetworkOf(session));
  if (Status missing = client.WaitForService(kSeconds); !missing.ok()) {
    ADD_FAILURE() << missing.error().message << run.output();
    return {};
  }
  run.WaitForLine("ready");
  std::vector<std::uint64_t> hashes =
      HashesOfScript([&](const control::Request& request) { return client.Call(request, kSeconds); });
  run.Interrupt();
  return hashes;
}

TEST(Edit, GivesTheSameHashesForAnyPackingAndInOneProcess) {
  const std::string world = WorldPath("pen.world");
  ControlledRun run(LoadWorld(world).value().world, {.packing = 4, .world_file = world});
  const std::vector<std::uint64_t> expected =
      HashesOfScript([&](const control::Request& request) { return Result<ControlReply>(run.Ask(request)); });
  ASSERT_EQ(expected.size(), Script().size());
  EXPECT_EQ(HashesOverDds("1"), expected);
  EXPECT_EQ(HashesOverDds("3"), expected);
}

// `troupe ctl` on one run.
class CtlTest : public testing::Test {
 protected:
  Finished Ctl(const std::vector<std::string>& action) const { return test::Ctl(session_, action); }
  std::string Problem(const std::vector<std::string>& action) const { return OutputOf(Ctl(action), 3); }
  std::string Done(const std::vector<std::string>& action) const { return OutputOf(Ctl(action)); }

  TemporaryFolder folder_;
  const std::string session_ = TestSession("ctl-edits");
  Program run_ = RunPen({"--paused", "--session", session_, "--poses", folder_.Path("poses"), "--scans",
                         folder_.Path("scans"), "--record", folder_.Path("record")});
};

TEST_F(CtlTest, EditsTheWorld) {
  run_.WaitForLine("ready");
  EXPECT_THAT(Done({"list"}), HasSubstr("robot  r0                       position     -2.000,-2.000,0.000,45.00"));
  EXPECT_THAT(Done({"set-pose", "r0", "--pose", "-1,-2,0,90"}), HasSubstr("paused tick 0"));
  EXPECT_THAT(Done({"get", "r0"}), HasSubstr("-1.000,-2.000,0.000,90.00"));
  Done({"set-pose", "r0", "--pose=-1,-2,0.25,0"});
  Done({"set-pose", "r0", "--pose=-1.5,-2,90"});
  EXPECT_THAT(Done({"get", "r0"}), HasSubstr("-1.500,-2.000,0.250,90.00"))
      << "without a height it keeps the one it has";
  EXPECT_THAT(Done({"spawnables"}), HasSubstr("rover                    position"));
  EXPECT_THAT(Done({"spawn", "rover", "--pose=0,-2,0,0"}), HasSubstr("robot  rover"));
  EXPECT_THAT(Done({"spawn", "rover", "--pose=1,-2,0"}), HasSubstr("robot  rover0"));
  EXPECT_THAT(Done({"delete", "r3"}), HasSubstr("edition 6"));
  Done({"step", "3"});
  Done({"reset"});
  Done({"step", "3"});
  run_.Interrupt();
  const std::string poses = folder_.Read("poses");
  EXPECT_THAT(poses, HasSubstr("\n3,rover0,"));
  EXPECT_THAT(poses, HasSubstr("\n3,r3,")) << "after the reset";
  const std::string record = folder_.Read("record");
  EXPECT_THAT(record, HasSubstr(R"("edition":6,)"));
  EXPECT_THAT(record, HasSubstr(R"("robots":["r0","r1","r2",null,"rover","rover0"])"));
  const std::string scans = folder_.Read("scans");
  EXPECT_THAT(scans, HasSubstr(R"({"edition":7})"));
  EXPECT_THAT(scans, HasSubstr(R"({"tick":2,"robot":"rover0")"));
}

TEST_F(CtlTest, SpawnsARobotWithAController) {
  run_.WaitForLine("ready");
  Done({"spawn", "rover", "--name", "idler", "--pose=0,-2,0,0"});
  Done({"spawn", "rover", "--name", "walker", "--controller", "wander", "--pose=0,2,0,0"});
  Done({"step", "20"});
  EXPECT_THAT(Done({"get", "idler"}), HasSubstr("0.000,-2.000,0.000,0.00"));
  EXPECT_THAT(Done({"get", "walker"}), Not(HasSubstr("0.000,2.000,0.000,0.00")));
  EXPECT_THAT(Problem({"spawn", "rover", "--controller", "wonder", "--pose=0,0,0,0"}),
              HasSubstr("unknown controller 'wonder'"));
  EXPECT_THAT(Problem({"spawn", "wall", "--controller", "wander", "--pose=0,0,1,0"}),
              HasSubstr("a controller for a model that is no robot"));
  EXPECT_THAT(Problem({"spawn", "rover", "--controller", "/nowhere/own.so", "--pose=0,0,0,0"}),
              HasSubstr("is not allowed"));
  run_.Interrupt();
}

TEST_F(CtlTest, PrintsTheReasonOfARefusal) {
  run_.WaitForLine("ready");
  EXPECT_THAT(Problem({"set-pose", "nobody", "--pose=0,0,0,0"}), HasSubstr("the world has no entity 'nobody'"));
  EXPECT_THAT(Problem({"get", "nobody"}), HasSubstr("the world has no entity 'nobody'"));
  EXPECT_THAT(Problem({"delete", "r0.ranger:0"}), HasSubstr("is a part of 'r0'"));
  EXPECT_THAT(Problem({"set-pose", "r0", "--pose=3.1,0,0,0"}), HasSubstr("'r0' would be inside 'east'"));
  EXPECT_THAT(Problem({"spawn", "rover", "--name", "r0", "--pose=0,-2,0,0"}), HasSubstr("the name 'r0' is in use"));
  EXPECT_THAT(Problem({"spawn", "truck", "--pose=0,-2,0,0"}), HasSubstr("truck"));
  EXPECT_THAT(Problem({"spawn", "/nowhere/truck.inc"}), HasSubstr("/nowhere/truck.inc"));
  EXPECT_THAT(Problem({"load", "/nowhere/pen.world"}), HasSubstr("/nowhere/pen.world"));
  EXPECT_THAT(Problem({"spawn", WorldPath("pen.world")}), HasSubstr("found 10 models, expected one"));
  EXPECT_THAT(Problem({"set-pose", "r0", "--pose=0,0,-5,0"}), HasSubstr("'r0' would be 5 m below the ground"));
  EXPECT_EQ(Ctl({"set-pose", "r0", "--pose=0,0"}).exit_status, 2);
  EXPECT_NE(Ctl({"set-pose", "r0", "--pose=nan,0,0,0"}).exit_status, 0);
  EXPECT_THAT(Done({"status"}), HasSubstr("paused tick 0")) << "the run continues";
  run_.Interrupt();
}

// A world without robots has no agent that could answer: the service alone has to keep the run going.
class EmptyWorldTest : public testing::Test {
 protected:
  EmptyWorldTest() {
    std::ofstream(folder_.Path("empty.world")) << "model ( name \"wall\" )\n";
    std::ofstream(folder_.Path("one.world")) << "define rover position ()\nrover ( name \"a\" pose [3 0 0 0] )\n";
  }

  void Start(const std::string& world) {
    run_.emplace(Troupe({"run", folder_.Path(world), "--headless", "--speed", "10", "--domain",
                         std::to_string(TestDomain()), "--session", session_}));
    ASSERT_TRUE(client_.WaitForService(kSeconds).ok()) << run_->output();
    run_->WaitForLine("ready");
  }
  ControlReply Ask(const control::Request& request) {
    const Result<ControlReply> reply = client_.Call(request, kSeconds);
    EXPECT_TRUE(reply.ok() && reply.value().done)
        << (reply.ok() ? reply.value().problem : reply.error().message) << run_->output();
    return reply.ok() ? reply.value() : ControlReply();
  }
  ControlReply Load(const std::string& world) {
    control::LoadWorld load;
    load.source = folder_.Path(world);
    return Ask(load);
  }
  ControlReply Spawn(const std::string& name) {
    control::Spawn spawn{.name = name, .pose = {3.0, 0.0, 0.0, 0.0}};
    spawn.source = "rover";
    return Ask(spawn);
  }
  void ExpectPausesAndSteps() {
    const Tick tick = Ask(control::Pause()).tick;
    control::Step step;
    step.ticks = 3;
    EXPECT_EQ(Ask(step).tick, tick + 3);
    Ask(control::Play());
  }

  TemporaryFolder folder_;
  const std::string session_ = TestSession("empty");
  std::optional<Program> run_;
  ControlClient client_{NetworkOf(session_)};
};

TEST_F(EmptyWorldTest, AnswersAllRequests) {
  Start("empty.world");
  ExpectPausesAndSteps();
  Load("one.world");
  ExpectPausesAndSteps();
  Load("empty.world");
  ExpectPausesAndSteps();
  run_->Interrupt();
}

TEST_F(EmptyWorldTest, ContinuesAfterTheLastRobotOfAPlayingRunIsDeleted) {
  Start("one.world");
  Ask(control::Delete{.name = "a"});
  ExpectPausesAndSteps();
  Spawn("b");
  ExpectPausesAndSteps();
  run_->Interrupt();
}

TEST_F(EmptyWorldTest, RunsInOneProcess) {
  std::vector<std::string> hashes;
  for (const char* mode : {"--headless", "--in-process"}) {
    OutputOf(Troupe({"run", folder_.Path("empty.world"), mode, "--ticks", "20", "--domain",
                     std::to_string(TestDomain()), "--hash-log", folder_.Path("hashes"), "--scans",
                     folder_.Path("scans"), "--trace", folder_.Path("trace")}));
    hashes.push_back(folder_.Read("hashes"));
  }
  EXPECT_THAT(hashes[0], HasSubstr("\n20 "));
  EXPECT_EQ(hashes[0], hashes[1]);
}

}  // namespace
}  // namespace troupe::test
