// Any state of a recorded run, in any order, is that of the run.
#include "world-service/replay/stepped_timeline.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <random>
#include <set>

#include "common/model/states.h"
#include "recording/mcap/reader.h"
#include "tests/support/controlled_run.h"
#include "tests/support/files.h"
#include "tests/support/small_world.h"

namespace troupe::test {
namespace {

class SteppedTimelineTest : public testing::Test {
 protected:
  // Steps, a change of a pose, a robot that is deleted and restored, a rewind and a reset.
  void SetUp() override {
    const OutputFiles outputs{.record = Path(), .keyframe_interval = 4};
    const WorldDescription world = Yard(2);
    const std::string& name = world.robots[0].name;
    ControlledRun run(world, {.outputs = outputs});
    run.Step(9);
    ASSERT_TRUE(run.Ask(control::SetPose{name, {-3.0, -3.0, 0.0, 0.0}}).done);
    run.Step(4);
    ASSERT_TRUE(run.Ask(control::Delete{name}).done);
    run.Step(5);
    ASSERT_TRUE(run.Ask(control::Rewind{11}).done);
    run.Step(6);
    ASSERT_TRUE(run.Ask(control::Reset()).done);
    run.Step(3);
    ASSERT_TRUE(run.Finish().ok());
    const Recording recording = Open();
    TickReader reader(recording);
    RecordedTick tick;
    while (reader.Next(tick).value()) ticks_.push_back(tick);
  }

  std::string Path() const { return folder_.Path("run.mcap"); }
  Recording Open() const { return Recording::Open(Path()).value(); }
  void ExpectRecorded(const TimelineState& state, std::uint64_t position) const {
    const RecordedTick& tick = ticks_.at(position);
    EXPECT_EQ(state.position, position);
    EXPECT_EQ(state.state->tick, tick.tick);
    EXPECT_EQ(state.state_hash, tick.state_hash);
    EXPECT_EQ(StateHash(*state.state), tick.state_hash);
    EXPECT_EQ(state.edition, tick.edition);
    EXPECT_EQ(state.events == nullptr ? std::vector<Event>() : *state.events, tick.events);
    EXPECT_TRUE(state.world->scene->CheckState(*state.state).ok());
  }

  const TemporaryFolder folder_;
  std::vector<RecordedTick> ticks_;
};

TEST_F(SteppedTimelineTest, HasEveryStateInAnyOrder) {
  for (const std::size_t bytes : {std::size_t{1}, SteppedTimeline::kMaxKeptBytes}) {
    SCOPED_TRACE(bytes);
    WorldCache worlds;
    const auto timeline = std::move(SteppedTimeline::Create(Open(), worlds, bytes)).value();
    EXPECT_TRUE(timeline->is_whole());
    ASSERT_EQ(timeline->Spans()->last() + 1, ticks_.size());
    std::set<std::uint32_t> numbers;
    const auto expect_at = [&](std::uint64_t position) {
      const Result<SharedState> state = timeline->At(position);
      ASSERT_TRUE(state.ok()) << state.error().ToString();
      ExpectRecorded(*state.value(), position);
      numbers.insert(state.value()->world->number);
    };
    for (std::uint64_t position = 0; position < ticks_.size(); ++position) expect_at(position);
    for (std::uint64_t position = ticks_.size(); position-- > 0;) expect_at(position);
    std::mt19937 random(3);
    for (int i = 0; i < 100; ++i) expect_at(random() % ticks_.size());
    EXPECT_EQ(timeline->At(ticks_.size() + 7).value()->position, ticks_.size() - 1) << "the nearest one";
    EXPECT_LE(numbers.size(), 4u) << "a world that is seen again is the same one";
  }
}

TEST_F(SteppedTimelineTest, ItsSpansAreThoseOfTheIndexOfTheFile) {
  WorldCache worlds;
  const auto timeline = std::move(SteppedTimeline::Create(Open(), worlds)).value();
  const TimeSpans& spans = *timeline->Spans();
  EXPECT_EQ(spans.all(), Open().spans().all());
  for (const RecordedTick& tick : ticks_) {
    EXPECT_EQ(spans.TickAt(tick.number), tick.tick);
    EXPECT_EQ(spans.PositionOf({tick.edition, tick.tick}), tick.number);
    EXPECT_LE(spans.BeginOf(tick.edition), tick.number);
  }
}

TEST_F(SteppedTimelineTest, AFileThatIsCutOffIsATimelineUpToThere) {
  const mcap::Reader file = mcap::Reader::Open(mcap::OpenFileSource(Path()).value()).value();
  std::filesystem::resize_file(Path(), file.chunks()[file.chunks().size() / 2].offset + 1);
  WorldCache worlds;
  const auto timeline = std::move(SteppedTimeline::Create(Open(), worlds)).value();
  EXPECT_TRUE(timeline->damage());
  EXPECT_FALSE(timeline->is_whole());
  const std::uint64_t last = timeline->Spans()->last();
  EXPECT_LT(last + 1, ticks_.size());
  ExpectRecorded(*timeline->At(last).value(), last);
}

TEST_F(SteppedTimelineTest, ACursorFindsTheNewestStateOfATick) {
  const Recording recording = Open();
  for (const Tick tick : {0u, 3u, 9u, 11u, 13u}) {
    const Result<ReplayCursor> cursor = ReplayCursor::AtTick(recording, tick);
    ASSERT_TRUE(cursor.ok()) << cursor.error().ToString();
    EXPECT_EQ(cursor.value().world().state_hash(), ticks_[cursor.value().position()].state_hash);
    const auto newest =
        std::find_if(ticks_.rbegin(), ticks_.rend(), [&](const RecordedTick& each) { return each.tick == tick; });
    EXPECT_EQ(cursor.value().position(), newest->number);
  }
  EXPECT_EQ(ReplayCursor::AtTick(recording, std::nullopt).value().position(), ticks_.size() - 1);
  const Result<ReplayCursor> missing = ReplayCursor::AtTick(recording, 1000);
  ASSERT_FALSE(missing.ok());
  EXPECT_THAT(missing.error().message, testing::HasSubstr("found tick 1000, expected at most"));
}

}  // namespace
}  // namespace troupe::test
