#include "recording/journal.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "recording/recording_writer.h"
#include "tests/support/small_world.h"

namespace troupe {
namespace {

namespace fs = std::filesystem;

class JournalTest : public testing::Test {
 protected:
  JournalTest() {
    std::string pattern = testing::TempDir() + "troupe-journal-XXXXXX";
    folder_ = mkdtemp(pattern.data());
    files_ = JournalFiles::Of((folder_ / "run.mcap").string());
    SmallWorld world;
    world.AddRobot("r0", {});
    run_.run = 7;
    run_.world = world.world();
  }
  ~JournalTest() override { fs::remove_all(folder_); }

  // Ticks that last 0.1 s each, the first `steps` + 1 of a run.
  static std::vector<RecordedTick> Ticks(std::uint64_t steps) {
    std::vector<RecordedTick> ticks;
    for (std::uint64_t number = 0; number <= steps; ++number) {
      RecordedTick& tick = ticks.emplace_back();
      tick.number = tick.tick = number;
      tick.state_hash = 1000 + number;
      if (number > 0) tick.proposals = {{RobotId(0), {0.25, 0.0, 0.001 * static_cast<double>(number)}, {}}};
    }
    return ticks;
  }

  // A recording of the ticks below `recorded`, as a process leaves it that is killed, and a tail of all.
  void WriteAndDie(const std::vector<RecordedTick>& ticks, std::uint64_t recorded) {
    RecordingWriter writer = RecordingWriter::Create(mcap::CreateFileSink(files_.recording).value(), run_).value();
    const std::unique_ptr<JournalTail> tail = JournalTail::Create(files_, run_.run, JournalSync::kNo).value();
    for (const RecordedTick& tick : ticks) {
      ASSERT_TRUE(tail->Append(&tick, Progress(tick.number)).ok());
      ASSERT_TRUE(tick.number >= recorded || writer.Add(tick).ok());
    }
    ASSERT_TRUE(writer.EndChunk().ok());
  }

  static RunProgress Progress(std::uint64_t stalls) {
    RunProgress progress{.incarnation = 3,
                         .absent = {RobotId(0)},
                         .newcomers = {RobotId(1), RobotId(2)},
                         .stalls = stalls,
                         .frozen = {"r0", "a robot"},
                         .speed_is_set = true,
                         .speed = 2.5};
    progress.commands = {{{.robot = RobotId(1), .twist = Twist{0.5, 0.0, 0.1}}, 7, true},
                         {{.robot = RobotId(1), .goal = Goal{9, {{1.0, 2.0}}, 0.5}}, stalls, false}};
    return progress;
  }

  Journal Open() const {
    Result<std::optional<Journal>> journal = Journal::OpenToContinue(files_);
    if (!journal.ok()) throw std::runtime_error(journal.error().ToString());
    return std::move(journal.value().value());
  }

  static std::vector<RecordedTick> Read(const Recording& recording) {
    std::vector<RecordedTick> ticks;
    TickReader reader(recording);
    RecordedTick tick;
    for (;;) {
      const Result<bool> more = reader.Next(tick);
      if (!more.ok()) throw std::runtime_error(more.error().ToString());
      if (!more.value()) return ticks;
      ticks.push_back(tick);
    }
  }

  static void ExpectSame(const std::vector<RecordedTick>& found, const std::vector<RecordedTick>& expected) {
    ASSERT_EQ(found.size(), expected.size());
    for (std::size_t i = 0; i < found.size(); ++i) {
      EXPECT_EQ(found[i].number, expected[i].number);
      EXPECT_EQ(found[i].state_hash, expected[i].state_hash);
      EXPECT_EQ(found[i].proposals, expected[i].proposals);
    }
  }

  void CutOff(const std::string& file, std::uintmax_t bytes) const {
    fs::resize_file(file, fs::file_size(file) - bytes);
  }

  fs::path folder_;
  JournalFiles files_;
  RecordedRun run_;
};

TEST_F(JournalTest, HasTheTicksOfTheRecordingAndThoseOfItsTail) {
  WriteAndDie(Ticks(30), 20);
  const Journal journal = Open();
  EXPECT_EQ(journal.recording.tail().size(), 11u);
  ExpectSame(Read(journal.recording), Ticks(30));
  EXPECT_EQ(journal.progress, Progress(30));
}

TEST_F(JournalTest, LosesAtMostTheTickThatWasBeingWritten) {
  WriteAndDie(Ticks(30), 20);
  CutOff(files_.tail[0], 1);
  const Journal journal = Open();
  ExpectSame(Read(journal.recording), Ticks(29));
  EXPECT_EQ(journal.progress, Progress(29));
}

TEST_F(JournalTest, TakesTheTicksOfAChunkThatIsCutOffFromItsTail) {
  WriteAndDie(Ticks(30), 20);
  CutOff(files_.recording, 5);
  ExpectSame(Read(Open().recording), Ticks(30));
}

TEST_F(JournalTest, IsNothingWithoutTheDescriptionOfARun) {
  EXPECT_FALSE(Journal::OpenToContinue(files_).value());
  std::ofstream(files_.recording) << "";
  EXPECT_FALSE(Journal::OpenToContinue(files_).value());
  RecordingWriter writer = RecordingWriter::Create(mcap::CreateFileSink(files_.recording).value(), run_).value();
  CutOff(files_.recording, 5);
  EXPECT_FALSE(Journal::OpenToContinue(files_).value());
}

TEST_F(JournalTest, IsRefusedWhileItsProcessLives) {
  RecordingWriter writer = RecordingWriter::Create(mcap::CreateFileSink(files_.recording).value(), run_).value();
  const Result<std::optional<Journal>> journal = Journal::OpenToContinue(files_);
  ASSERT_FALSE(journal.ok());
  EXPECT_THAT(journal.error().message, testing::HasSubstr("another process writes this file"));
}

TEST_F(JournalTest, IgnoresTheTailOfAnotherRun) {
  WriteAndDie(Ticks(30), 20);
  run_.run = 8;
  RecordingWriter writer = RecordingWriter::Create(mcap::CreateFileSink(files_.recording).value(), run_).value();
  for (const RecordedTick& tick : Ticks(3)) ASSERT_TRUE(writer.Add(tick).ok());
  ASSERT_TRUE(writer.Close().ok());
  ExpectSame(Read(Open().recording), Ticks(3));
}

// However often it is continued, and wherever it was cut off, the recording is whole at the end.
TEST_F(JournalTest, IsContinuedToAWholeRecording) {
  const std::vector<RecordedTick> ticks = Ticks(60);
  WriteAndDie({ticks.begin(), ticks.begin() + 31}, 20);
  for (const std::size_t end : {41u, 61u}) {
    CutOff(files_.recording, 3);
    Journal journal = Open();
    std::vector<RecordedTick> rest = journal.recording.tail();
    const std::size_t next = Read(journal.recording).size();
    rest.insert(rest.end(), ticks.begin() + static_cast<std::ptrdiff_t>(next),
                ticks.begin() + static_cast<std::ptrdiff_t>(end));
    RecordingWriter writer = RecordingWriter::Continue(std::move(journal.sink), std::move(journal.written), run_.run,
                                                       journal.recording.interval_ns(), journal.recording.end_time());
    const std::unique_ptr<JournalTail> tail = JournalTail::Continue(files_, run_.run, JournalSync::kYes).value();
    for (const RecordedTick& tick : rest) {
      ASSERT_TRUE(tick.number < next || tail->Append(&tick, Progress(tick.number)).ok());
      ASSERT_TRUE(writer.Add(tick).ok());
    }
    ASSERT_TRUE(writer.EndChunk().ok());
    ASSERT_TRUE(end < ticks.size() || writer.Close().ok());
  }
  const Recording recording = Recording::Open(files_.recording).value();
  EXPECT_FALSE(recording.damage());
  EXPECT_TRUE(recording.CheckData().ok());
  EXPECT_EQ(recording.end_time(), 60u * static_cast<std::uint64_t>(run_.world.interval_ns));
  ExpectSame(Read(Open().recording), ticks);
}

// The files do not grow: each is used again once the recording has its ticks.
TEST_F(JournalTest, ReusesTheFilesOfItsTail) {
  const std::unique_ptr<JournalTail> tail = JournalTail::Create(files_, run_.run, JournalSync::kNo).value();
  RecordedTick tick = Ticks(1).back();
  tick.events.assign(1000, {0, EventType::kStallBegan, RobotId(0), ModelId(0), "detail"});
  for (tick.number = 1; tick.number < 300; ++tick.number) {
    ASSERT_TRUE(tail->Append(&tick, Progress(tick.number)).ok());
    tail->Release(tick.number);
  }
  for (const std::string& file : files_.tail) EXPECT_LT(fs::file_size(file), 2u << 20);
  const JournalTailContent content = ReadJournalTail(files_, run_.run, 298).value();
  EXPECT_EQ(content.ticks.size(), 2u);
  EXPECT_EQ(content.progress, Progress(299));
  tail->Remove();
  for (const std::string& file : files_.tail) EXPECT_FALSE(fs::exists(file));
}

// A run that goes on: its writers live, and nothing is locked or cut.
TEST_F(JournalTest, ARunThatGoesOnIsReadAsFarAsItHasCome) {
  const std::vector<RecordedTick> ticks = Ticks(20);
  RecordingWriter writer = RecordingWriter::Create(mcap::CreateFileSink(files_.recording).value(), run_).value();
  const std::unique_ptr<JournalTail> tail = JournalTail::Create(files_, run_.run, JournalSync::kNo).value();
  const auto read = [this] {
    const Result<Recording> run = ReadJournal(files_);
    if (!run.ok()) throw std::runtime_error(run.error().ToString());
    return std::pair(Read(run.value()), !run.value().damage());
  };
  for (const RecordedTick& tick : ticks) {
    ASSERT_TRUE(tail->Append(&tick, Progress(0)).ok());
    ASSERT_TRUE(writer.Add(tick).ok());
    if (tick.number == 7) {
      ASSERT_TRUE(writer.EndChunk().ok());
    }
    if (tick.number < 7) continue;
    const auto [found, is_whole] = read();
    ExpectSame(found, {ticks.begin(), ticks.begin() + static_cast<std::ptrdiff_t>(tick.number) + 1});
    EXPECT_FALSE(is_whole);
  }
  ASSERT_TRUE(writer.Close().ok());
  const auto [found, is_whole] = read();
  ExpectSame(found, ticks);
  EXPECT_TRUE(is_whole);
}

}  // namespace
}  // namespace troupe
