// Recordings of real runs: a replay gives the same files, byte for byte, and finds every difference.
#include "recording/recording.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "recording/recording_writer.h"
#include "tests/process/programs.h"
#include "tests/support/dds_domain.h"
#include "tests/support/edits.h"
#include "tests/support/files.h"
#include "transport/dds/tools/control_client.h"

namespace troupe::test {
namespace {

using testing::ContainsRegex;
using testing::HasSubstr;

std::string ScenarioPath(const std::string& name) {
  return std::string(std::getenv("TROUPE_SOURCE_DIR")) + "/worlds/scenarios/" + name;
}

class RecordingTest : public testing::Test {
 protected:
  std::string Path(const std::string& name) const { return folder_.Path(name); }

  // Arguments for all output files of a run or a replay, by a prefix of their names.
  std::vector<std::string> Outputs(const std::string& prefix) const {
    return {"--hash-log", Path(prefix + "hashes"), "--poses", Path(prefix + "poses"),
            "--scans",    Path(prefix + "scans")};
  }
  // `troupe run` in one process or with a process for each robot, with a recording.
  void Run(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), "run");
    for (const std::string& argument : Outputs("run-")) arguments.push_back(argument);
    for (const std::string& argument : {std::string("--record"), Path("run.mcap"), std::string("--headless"),
                                        std::string("--domain"), std::to_string(TestDomain())}) {
      arguments.push_back(argument);
    }
    OutputOf(Troupe(arguments));
  }
  Finished Replay(std::vector<std::string> arguments, const std::string& file = "run.mcap") const {
    arguments.insert(arguments.begin(), {"replay", Path(file)});
    return Finish(Troupe(arguments));
  }
  // The run's scans of a tick are in the order in which the agents were started, those of a replay in that of the
  // robots.
  enum class ScanOrder : bool { kSame, kOfAgents };
  void ExpectEqualReplay(ScanOrder order = ScanOrder::kSame) const {
    std::vector<std::string> arguments = Outputs("replay-");
    arguments.insert(arguments.end(), {"--verify", "--controllers"});
    const std::string replay = OutputOf(Replay(arguments));
    EXPECT_THAT(replay, HasSubstr("all state hashes are equal"));
    EXPECT_THAT(replay, HasSubstr("all recorded events are equal, and the file is whole"));
    EXPECT_THAT(replay, ContainsRegex("\n[0-9]+ proposals of controllers are equal"));
    EXPECT_FALSE(folder_.Read("run-hashes").empty());
    for (const char* name : {"hashes", "poses"}) {
      EXPECT_TRUE(folder_.Read(std::string("run-") + name) == folder_.Read(std::string("replay-") + name)) << name;
    }
    if (order == ScanOrder::kSame) {
      EXPECT_TRUE(folder_.Read("run-scans") == folder_.Read("replay-scans"));
    } else {
      EXPECT_TRUE(SortedLines("run-scans") == SortedLines("replay-scans"));
    }
  }
  std::vector<std::string> SortedLines(const std::string& name) const {
    std::vector<std::string> lines;
    for (const std::string& line : LinesOf(folder_.Read(name))) lines.push_back(line);
    std::sort(lines.begin(), lines.end());
    return lines;
  }
  // Writes the recording again, with changes.
  template <typename ChangeRun, typename ChangeTick>
  void Rewrite(const std::string& to, const ChangeRun& change_run, const ChangeTick& change_tick) const {
    const Recording recording = std::move(Recording::Open(Path("run.mcap"))).value();
    RecordedRun run = recording.run();
    change_run(run);
    RecordingWriter writer = RecordingWriter::Create(mcap::CreateFileSink(Path(to)).value(), run).value();
    TickReader reader(recording);
    RecordedTick tick;
    while (reader.Next(tick).value()) {
      change_tick(tick);
      ASSERT_TRUE(writer.Add(tick).ok());
    }
    ASSERT_TRUE(writer.Close().ok());
  }

  TemporaryFolder folder_;
};

struct World {
  std::string file;  // in worlds/scenarios, or beside this test
  bool in_process;
  int ticks = 250;
};

class RecordedWorld : public RecordingTest, public testing::WithParamInterface<World> {};

TEST_P(RecordedWorld, IsReplayedWithTheSameFiles) {
  const World& world = GetParam();
  const std::string path = world.file.ends_with(".world") ? WorldPath(world.file) : ScenarioPath(world.file);
  std::vector<std::string> arguments = {path, "--ticks", std::to_string(world.ticks), "--speed", "max"};
  if (world.in_process) arguments.emplace_back("--in-process");
  Run(arguments);
  ExpectEqualReplay();
}

INSTANTIATE_TEST_SUITE_P(Worlds, RecordedWorld,
                         testing::Values(World{"demo.json", true}, World{"relay.json", true},
                                         World{"stage_stacking.json", true}, World{"stacking.json", false},
                                         World{"lab.json", false}, World{"pen.world", false},
                                         World{"sensors.json", false, 40}, World{"hands.world", true}),
                         [](const testing::TestParamInfo<World>& world) {
                           const std::string& file = world.param.file;
                           return file.substr(0, file.find('.')) + (world.param.in_process ? "InProcess" : "");
                         });

TEST_F(RecordingTest, IsEqualOnALossyNetwork) {
  Run({WorldPath("pen.world"), "--ticks", "200", "--speed", "max", "--faults",
       "loss=0.02,duplicate=0.05,reorder=0.05,delay=0.1:0.002,seed=3"});
  ExpectEqualReplay();
}

// Late robots stop: the recording has the proposals that were used.
TEST_F(RecordingTest, IsEqualInRealtimeModeWithLateRobots) {
  Run(Words("% --ticks 150 --mode realtime --speed 10 --faults delay=0.4:0.03,seed=5", {WorldPath("pen.world")}));
  OutputOf(Replay({"--verify", "--hash-log", Path("hashes"), "--poses", Path("poses")}));
  EXPECT_EQ(folder_.Read("hashes"), folder_.Read("run-hashes"));
  EXPECT_TRUE(folder_.Read("poses") == folder_.Read("run-poses"));
  EXPECT_THAT(OutputOf(Replay({"--verify", "--controllers"}), 2), HasSubstr("found a recording of mode realtime"));
  const Recording recording = std::move(Recording::Open(Path("run.mcap"))).value();
  TickReader reader(recording);
  RecordedTick tick;
  std::size_t late = 0;
  while (reader.Next(tick).value()) late += tick.is_step() && tick.proposals.size() < 4 ? 1 : 0;
  EXPECT_GT(late, 0u) << "no robot was late";
}

// The divergence finder.
class ControllersTest : public RecordingTest {
 protected:
  void RunWith(const std::string& drifts_of_second) {
    std::ofstream(Path("drift.json")) << R"({"world": ")" << WorldPath("pen.world") << R"(", "robots": [)"
                                      << Robot("r0", "false") << ", " << Robot("r1", drifts_of_second) << "]}";
    Run({Path("drift.json"), "--ticks", "60", "--speed", "max"});
  }

 private:
  static std::string Robot(const std::string& name, const std::string& drifts) {
    return R"({"name": ")" + name +
           R"(", "controller": {"name": ")" DRIFTING_LIBRARY R"(", "parameters": {"drifts": )" + drifts + "}}}";
  }
};

TEST_F(ControllersTest, ARepeatableControllerDecidesTheSameAgain) {
  RunWith("false");
  EXPECT_THAT(OutputOf(Replay({"--verify", "--controllers"})), HasSubstr("\n240 proposals of controllers are equal\n"));
}

TEST_F(ControllersTest, NamesTheFirstNumberOfAControllerThatIsNotRepeatable) {
  RunWith("true");
  EXPECT_EQ(Replay({"--verify"}).exit_status, 0);
  const std::string replay = OutputOf(Replay({"--verify", "--controllers"}), 3);
  EXPECT_THAT(replay, HasSubstr("31 states, of ticks 0 to 30, replayed"));
  EXPECT_THAT(replay, ContainsRegex("run.mcap: error: tick 31: robot r1: the vx is 0.1[0-9]*, expected 0.1"));
  // From any tick: the memory of controllers begins with the run.
  EXPECT_EQ(Replay({"--verify", "--controllers", "--from", "20", "--to", "30"}).exit_status, 0);
  EXPECT_EQ(Replay({"--controllers"}).exit_status, 2) << "without --verify";
}

control::Step Steps(std::uint64_t ticks) {
  return {ticks};
}

control::Reset Reset(std::uint8_t scopes) {
  return {scopes};
}

// Edits of every kind; the pen has robots, walls and a bar.
std::vector<control::Request> Edits() {
  return {Steps(12),
          control::SetPose{.name = "r0", .pose = {1.0, -1.0, 0.0, 0.3}},
          Steps(7),
          control::Delete{.name = "r1"},
          control::Spawn{.source = "rover", .name = "late", .pose = {0.0, -2.0, 0.0, 1.0}},
          control::Spawn{.source = "wall", .name = "block", .pose = {-2.0, 0.5, 0.0, 0.0}},
          Steps(11),
          control::SetPose{.name = "bar", .pose = {-2.0, -0.5, 0.0, 0.0}},
          control::Spawn{.source = "rover", .name = "r1", .pose = {2.0, -2.0, 0.0, 0.5}},
          Steps(9),
          Reset(kResetState),
          Steps(4),
          Reset(kResetTime),
          Steps(6),
          Reset(kResetSpawned),
          Steps(5),
          Reset(kResetAll),
          Steps(13),
          control::LoadWorld{.source = WorldPath("pen.world")},
          control::Delete{.name = "r3"},
          Steps(8),
          Reset(kResetAll),
          Steps(3)};
}

class EditedRunTest : public RecordingTest {
 protected:
  // Runs the pen with the edits; the tick of the last state, twice: the last frame is another one.
  void RunWithEdits() {
    const std::string session = TestSession("recorded-edits");
    std::vector<std::string> arguments = Outputs("run-");
    for (const std::string& argument :
         {std::string("--paused"), std::string("--speed"), std::string("max"), std::string("--session"), session,
          std::string("--keyframe-interval"), std::string("10"), std::string("--record"), Path("run.mcap")}) {
      arguments.push_back(argument);
    }
    Program run = RunPen(arguments);
    ControlClient client(NetworkOf(session));
    ASSERT_TRUE(client.WaitForService(kSeconds).ok()) << run.output();
    run.WaitForLine("ready");
    for (const control::Request& request : Edits()) {
      const Result<ControlReply> reply = client.Call(request, kSeconds);
      ASSERT_TRUE(reply.ok() && reply.value().done)
          << (reply.ok() ? reply.value().problem : reply.error().message) << run.output();
    }
    run.Interrupt();
  }
};

TEST_F(EditedRunTest, IsReplayedWithTheSameFilesFromAnyTick) {
  RunWithEdits();
  ExpectEqualReplay(ScanOrder::kOfAgents);
  // The lines of the hash log from the first state of a tick to the last of another.
  std::vector<std::string> lines;
  for (const std::string& line : LinesOf(folder_.Read("run-hashes"))) lines.push_back(line + "\n");
  const auto is_of = [](Tick tick) {
    return [tick](const std::string& line) { return line.starts_with(std::to_string(tick) + " "); };
  };
  for (const auto& [from, to] : std::vector<std::pair<Tick, Tick>>{
           {0, 0}, {0, 3}, {7, 8}, {12, 12}, {19, 5}, {25, 11}, {31, 1}, {39, 13}, {43, 2}}) {
    SCOPED_TRACE(std::to_string(from) + " to " + std::to_string(to));
    OutputOf(Replay({"--from", std::to_string(from), "--to", std::to_string(to), "--hash-log", Path("part")}));
    const auto first = std::find_if(lines.begin(), lines.end(), is_of(from));
    const auto last = std::find_if(lines.rbegin(), lines.rend(), is_of(to));
    std::string expected;
    for (auto line = first; line != last.base(); ++line) expected += *line;
    EXPECT_EQ(folder_.Read("part"), expected);
  }
}

TEST_F(RecordingTest, IsReplayedInPart) {
  Run({WorldPath("pen.world"), "--ticks", "120", "--speed", "max", "--in-process", "--keyframe-interval", "25"});
  std::vector<std::string> arguments = Outputs("part-");
  for (const char* word : {"--from", "61", "--to", "90"}) arguments.emplace_back(word);
  EXPECT_THAT(OutputOf(Replay(arguments)), HasSubstr("30 states, of ticks 61 to 90, replayed"));
  // Scans and hashes are the lines of these ticks.
  const auto lines_of = [&](const std::string& name, const auto& tick_of) {
    std::string lines;
    for (const std::string& line : LinesOf(folder_.Read(name))) {
      const int tick = tick_of(line);
      if (tick < 0 || (tick >= 61 && tick <= 90)) lines += line + "\n";
    }
    return lines;
  };
  const auto number = [](const std::string& line) { return std::isdigit(line[0]) != 0 ? std::stoi(line) : -1; };
  EXPECT_EQ(folder_.Read("part-hashes"), lines_of("run-hashes", number));
  EXPECT_EQ(folder_.Read("part-poses"), lines_of("run-poses", number));
  const auto of_scan = [](const std::string& line) { return nlohmann::json::parse(line)["tick"].get<int>(); };
  EXPECT_TRUE(folder_.Read("part-scans") == lines_of("run-scans", of_scan));

  for (const auto& [option, tick] : {std::pair("--from", "121"), std::pair("--to", "500")}) {
    EXPECT_THAT(OutputOf(Replay({option, tick}), 2), HasSubstr("expected at most 120"));
  }
  EXPECT_EQ(Replay({"--from", "50", "--to", "40"}).exit_status, 2);
}

TEST_F(RecordingTest, IsDrawnAndChecked) {
  Run({ScenarioPath("demo.json"), "--ticks", "60", "--speed", "max", "--in-process"});
  ASSERT_EQ(Finish(Troupe({"snapshot", Path("run.mcap"), "--tick", "50", "--rays", "-o", Path("a.svg")})).exit_status,
            0);
  ASSERT_EQ(Finish(Troupe({"snapshot", ScenarioPath("demo.json"), "--tick", "50", "--rays", "-o", Path("b.svg")}))
                .exit_status,
            0);
  EXPECT_TRUE(folder_.Read("a.svg") == folder_.Read("b.svg"));
  OutputOf(Troupe({"snapshot", Path("run.mcap"), "--tick", "61", "-o", Path("c.svg")}), 2);
  EXPECT_THAT(OutputOf(Troupe({"check", Path("run.mcap")})),
              HasSubstr("recorded: ticks 0 to 60, 6 s simulated, 0 edits, 2 keyframes"));
}

// The same from a recording as from a run.
TEST_F(RecordingTest, IsDrawnAsAHeatMap) {
  Run({ScenarioPath("demo.json"), "--ticks", "60", "--speed", "max", "--in-process"});
  const auto draw = [&](const std::string& file, const char* to, std::vector<std::string> options, int status = 0) {
    std::vector<std::string> words = {"snapshot", file, "-o", Path(to), "--heat", "robots"};
    words.insert(words.end(), options.begin(), options.end());
    return OutputOf(Troupe(words), status);
  };
  draw(Path("run.mcap"), "a.svg", {});
  draw(ScenarioPath("demo.json"), "b.svg", {"--tick", "60"});
  EXPECT_TRUE(folder_.Read("a.svg") == folder_.Read("b.svg"));
  OutputOf(Troupe({"snapshot", Path("run.mcap"), "-o", Path("plain.svg")}));
  EXPECT_FALSE(folder_.Read("a.svg") == folder_.Read("plain.svg"));
  draw(Path("run.mcap"), "c.svg", {"--since", "30", "--tick", "50"});
  draw(ScenarioPath("demo.json"), "d.svg", {"--since", "30", "--tick", "50"});
  EXPECT_TRUE(folder_.Read("c.svg") == folder_.Read("d.svg"));
  EXPECT_FALSE(folder_.Read("a.svg") == folder_.Read("c.svg"));
  draw(Path("run.mcap"), "e.svg", {"--cell", "2"});
  EXPECT_FALSE(folder_.Read("a.svg") == folder_.Read("e.svg"));
  EXPECT_THAT(draw(Path("run.mcap"), "f.svg", {"--tick", "61"}, 2), HasSubstr("the recording ends at tick 60"));
  EXPECT_THAT(draw(ScenarioPath("demo.json"), "f.svg", {}, 2), HasSubstr("found --heat without --tick"));
  EXPECT_THAT(draw(Path("run.mcap"), "f.svg", {"--view", "side"}, 2), HasSubstr("found --heat with --view side"));
  EXPECT_THAT(draw(Path("run.mcap"), "f.svg", {"--cell", "0.001"}, 2), HasSubstr("expected 0.05 to 100 m"));
}

class ChangedRecordingTest : public RecordingTest {
 protected:
  void SetUp() override {
    Run({WorldPath("pen.world"), "--ticks", "60", "--speed", "max", "--in-process", "--keyframe-interval", "20"});
  }
  static void Same(const RecordedRun&) {}
};

TEST_F(ChangedRecordingTest, AChangedProposalIsADifferenceThatNamesTheModel) {
  Rewrite("changed.mcap", Same, [](RecordedTick& tick) {
    if (tick.tick == 27) tick.proposals[2].twist.vx *= 0.99;
  });
  const std::string replay = OutputOf(Replay({}, "changed.mcap"), 3);
  EXPECT_THAT(replay, HasSubstr("27 states, of ticks 0 to 26, replayed"));
  EXPECT_THAT(replay, HasSubstr("changed.mcap: error: tick 27: found the state hash "));
  EXPECT_THAT(replay, HasSubstr("; at the next recorded state, of tick 40, the x of r2 is "));
}

TEST_F(ChangedRecordingTest, AChangedStateIsADifferenceThatNamesTheField) {
  Rewrite("changed.mcap", Same, [](RecordedTick& tick) {
    if (tick.keyframe && tick.tick == 40) tick.keyframe->state.robots[1].X_WR.heading = 0.125;
  });
  const std::string replay = OutputOf(Replay({}, "changed.mcap"), 3);
  EXPECT_THAT(replay, HasSubstr("tick 40: the heading of r1 is "));
  EXPECT_THAT(replay, HasSubstr(", expected 0.125"));
}

TEST_F(ChangedRecordingTest, AChangedHashIsADifference) {
  Rewrite("changed.mcap", Same, [](RecordedTick& tick) { tick.state_hash ^= tick.tick == 33 ? 1U : 0U; });
  EXPECT_THAT(OutputOf(Replay({}, "changed.mcap"), 3),
              HasSubstr("; at the next recorded state, of tick 40, no model differs any more"));
}

TEST_F(ChangedRecordingTest, AChangedEventIsFoundByVerify) {
  Rewrite("changed.mcap", Same, [](RecordedTick& tick) {
    if (tick.tick == 33) tick.events.push_back({33, EventType::kStallEnded, RobotId(0)});
  });
  EXPECT_EQ(Replay({}, "changed.mcap").exit_status, 0);
  EXPECT_THAT(OutputOf(Replay({"--verify"}, "changed.mcap"), 3), HasSubstr("tick 33: found "));
}

TEST_F(ChangedRecordingTest, AProposalBeyondTheLimitsIsADifference) {
  Rewrite("changed.mcap", Same, [](RecordedTick& tick) {
    if (tick.tick == 27) tick.proposals[0].twist.vx = 1e9;
  });
  EXPECT_THAT(OutputOf(Replay({}, "changed.mcap"), 3),
              HasSubstr("tick 27: the proposal of robot r0 is refused: found the twist"));
}

TEST_F(ChangedRecordingTest, AnotherVersionOfTheStepIsRefusedUnlessForced) {
  const auto later = [](RecordedRun& run) {
    ++run.step_version;
    run.program_version = "9.8.7";
  };
  Rewrite("later.mcap", later, [](RecordedTick&) {});
  const std::string refused = OutputOf(Replay({}, "later.mcap"), 2);
  EXPECT_THAT(refused, HasSubstr("(troupe 9.8.7), expected"));
  EXPECT_THAT(refused, HasSubstr("--force replays it"));
  EXPECT_EQ(Replay({"--force"}, "later.mcap").exit_status, 0);
  EXPECT_EQ(Finish(Troupe({"snapshot", Path("later.mcap"), "-o", Path("a.svg")})).exit_status, 2);
}

TEST_F(ChangedRecordingTest, ACutOffFileIsReplayedToItsLastWholeChunk) {
  for (const double share : {0.05, 0.6, 0.9, 0.999}) {
    SCOPED_TRACE(share);
    const std::string whole = folder_.Read("run.mcap");
    const std::string part = whole.substr(0, static_cast<std::size_t>(share * static_cast<double>(whole.size())));
    std::ofstream(Path("part.mcap"), std::ios::binary) << part;
    EXPECT_THAT(OutputOf(Replay({}, "part.mcap"), 3), HasSubstr("part.mcap: error: "));
  }
}

TEST_F(RecordingTest, IsReadableAfterTheServiceWasKilled) {
  Program run = RunPen({"--speed", "200", "--session", TestSession("killed"), "--keyframe-interval", "10", "--record",
                        Path("run.mcap"), "--hash-log", Path("hashes"), "--on-service-loss", "end"});
  run.WaitForLine("ready");
  while (!std::filesystem::exists(Path("run.mcap")) || std::filesystem::file_size(Path("run.mcap")) < 250'000) {
    ASSERT_TRUE(std::filesystem::exists(Path("hashes"))) << run.output();
  }
  for (const pid_t child : ChildrenOf(run.pid())) {
    if (CommandLineOf(child).find("world-service") != std::string::npos) kill(child, SIGKILL);
  }
  EXPECT_EQ(run.Wait(), 3) << run.output();
  const std::string replay = OutputOf(Replay({}), 3);
  EXPECT_THAT(replay, HasSubstr("replayed"));
  EXPECT_THAT(replay, HasSubstr("their state hashes are equal"));
  EXPECT_THAT(replay, HasSubstr("run.mcap: error: "));
}

TEST_F(RecordingTest, EndsTheRunOnAFullDisk) {
  for (const std::string mode : {"--headless --on-service-loss end", "--in-process"}) {
    const std::string command = "ulimit -f 200; exec " + ProgramPath("troupe") + " run " + WorldPath("pen.world") +
                                " --speed max --keyframe-interval 10 --domain " + std::to_string(TestDomain()) + " " +
                                mode + " --record " + Path("run.mcap");
    EXPECT_THAT(OutputOf(Program({"/bin/sh", "-c", command}), 3),
                HasSubstr("\n" + Path("run.mcap") + ": error: cannot write: File too large"));
    EXPECT_THAT(OutputOf(Replay({}), 3), HasSubstr("their state hashes are equal"));
  }
}

TEST_F(RecordingTest, RefusesOtherFiles) {
  std::ofstream(Path("run.mcap")) << "not a recording";
  EXPECT_THAT(OutputOf(Replay({}), 2),
              HasSubstr("run.mcap: error: found other bytes at the start, expected an MCAP file"));
  EXPECT_EQ(Replay({}, "missing.mcap").exit_status, 2);
  EXPECT_EQ(Finish(Troupe({"check", Path("run.mcap")})).exit_status, 2);
}

}  // namespace
}  // namespace troupe::test
