// Recordings of other versions: messages with other fields than those of today.
#include "recording/older_layout.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "common/model/states.h"
#include "recording/recorded_run.h"
#include "recording/recording.h"
#include "recording/recording_writer.h"
#include "tests/support/small_world.h"
#include "tests/support/values.h"

namespace troupe {
namespace {

using test::ValueOf;
using testing::HasSubstr;

// The text without the lines that contain one of the words.
std::string Without(const std::string& text, const std::vector<std::string>& words) {
  std::string left;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size() - 1) + 1;
    const std::string line = text.substr(begin, end - begin);
    const bool has = std::any_of(words.begin(), words.end(),
                                 [&](const std::string& word) { return line.find(word) != std::string::npos; });
    if (!has) left += line;
    begin = end;
  }
  return left;
}

// As before there were doors, lifts, levels and lanes.
const std::vector<std::string> kNewFields = {" doors;", " lifts;", " levels;", " lane_graphs;"};

TEST(OlderLayout, FieldsThatAreNewAreEmptyAndOthersKeepTheirBits) {
  SmallWorld world;
  world.AddBox("wall", 3.0, 0.0, 0.2, 4.0, {0.0, 1.0});
  world.AddRobot("r0", {0.1, -0.2, 0.3, 0.4});
  world.AddRobot("r1", {0.0, 2.0, 0.0, 0.0});
  world.SetController(RobotId(0), "wander", "{\"speed\": 0.3}");
  RecordedRun run{.run = 7, .program_version = "1.2", .step_version = 4, .file = "small.world", .keyframe_interval = 5};
  run.world = world.world();
  const std::string today = SchemaOf(kChannelTypes[0]).data;
  const std::string former = Without(today, kNewFields);
  ASSERT_NE(former, today);
  const char* const type = kChannelTypes[0].type;
  const std::vector<std::byte> bytes = RunToBytes(run);
  const std::vector<std::byte> old = ValueOf(ValueOf(LayoutChange::Between(today, former, type)).Apply(bytes));
  EXPECT_LT(old.size(), bytes.size());
  EXPECT_FALSE(RunFromBytes(old).ok()) << "it would need no change";
  const std::vector<std::byte> again = ValueOf(ValueOf(LayoutChange::Between(former, today, type)).Apply(old));
  EXPECT_EQ(again, bytes);
}

TEST(OlderLayout, AnyBytesAreSafe) {
  const std::string today = SchemaOf(kChannelTypes[3]).data;
  const LayoutChange change = ValueOf(LayoutChange::Between(Without(today, kNewFields), today, kChannelTypes[3].type));
  std::vector<std::byte> bytes(200, std::byte{0});
  bytes[1] = std::byte{1};
  for (std::size_t i = 4; i < bytes.size(); ++i) {
    bytes[i] = std::byte{255};
    EXPECT_FALSE(change.Apply(bytes).ok());
    bytes[i] = std::byte{static_cast<unsigned char>(i % 3)};
    EXPECT_FALSE(change.Apply(std::span(bytes).first(i)).ok());
  }
  EXPECT_FALSE(change.Apply({}).ok());
}

TEST(OlderLayout, AnotherTypeOfAFieldIsAnError) {
  const std::string today = SchemaOf(kChannelTypes[4]).data;
  std::string other = today;
  const std::string field = "unsigned long edition;";
  ASSERT_NE(other.find(field), std::string::npos);
  other.replace(other.find(field), field.size(), "string edition;");
  const Result<LayoutChange> change = LayoutChange::Between(other, today, kChannelTypes[4].type);
  ASSERT_FALSE(change.ok());
  EXPECT_THAT(change.error().message, HasSubstr("field edition has another type"));
  EXPECT_FALSE(LayoutChange::Between("struct { broken", today, kChannelTypes[4].type).ok());
  EXPECT_TRUE(LayoutChange::IsNone(today, "// another comment\n" + today));
}

// A file as a former version wrote it: its schemas and its messages without the new fields.
TEST(OlderLayout, ARecordingOfAFormerVersionIsRead) {
  SmallWorld world;
  world.AddRobot("r0", {});
  RecordedRun run{.run = 7, .program_version = "1.2", .step_version = 4, .file = "w", .keyframe_interval = 5};
  run.world = world.world();
  const WorldState state = PlacedState(run.world);
  RecordedTick first{.state_hash = StateHash(state)};
  first.keyframe = FrameMessage{.run = 7, .state = state, .state_hash = first.state_hash};
  std::vector<std::byte> file;
  mcap::Writer writer = ValueOf(mcap::Writer::Create(mcap::MakeMemorySink(file), kRecordingProfile, "troupe"));
  std::array<std::uint16_t, kRecordingChannels> channels{};
  const auto former_of = [](std::size_t channel) { return Without(SchemaOf(kChannelTypes[channel]).data, kNewFields); };
  for (std::size_t i = 0; i < kRecordingChannels; ++i) {
    mcap::Schema schema = SchemaOf(kChannelTypes[i]);
    schema.data = former_of(i);
    channels[i] = writer.AddChannel({writer.AddSchema(schema), kChannelTypes[i].topic, "cdr"});
  }
  const auto add = [&](RecordingChannel channel, const std::vector<std::byte>& data) {
    const auto i = static_cast<std::size_t>(channel);
    const std::string today = SchemaOf(kChannelTypes[i]).data;
    const std::vector<std::byte> old =
        ValueOf(ValueOf(LayoutChange::Between(today, former_of(i), kChannelTypes[i].type)).Apply(data));
    writer.Add({.channel = channels[i], .data = old});
  };
  add(RecordingChannel::kRun, RunToBytes(run));
  ASSERT_TRUE(writer.EndChunk().ok());
  for (const TickMessage& message : MessagesOf(first, 7)) add(message.channel, message.data);
  ASSERT_TRUE(writer.EndChunk().ok());
  ASSERT_TRUE(writer.Close().ok());
  const Recording recording = ValueOf(Recording::Open(mcap::MakeMemorySource("former.mcap", file)));
  EXPECT_EQ(recording.run().world, run.world);
  RecordedTick tick;
  ASSERT_TRUE(ValueOf(TickReader(recording).Next(tick)));
  EXPECT_EQ(tick.state_hash, first.state_hash);
  ASSERT_TRUE(tick.keyframe);
  EXPECT_EQ(tick.keyframe->state, state);
}

}  // namespace
}  // namespace troupe
