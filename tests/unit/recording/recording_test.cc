#include "recording/recording.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <regex>
#include <string>
#include <vector>

#include "recording/recorded_run.h"
#include "recording/recording_writer.h"
#include "tests/support/small_world.h"

namespace troupe {
namespace {

using ::testing::HasSubstr;

RecordedRun MakeRun() {
  SmallWorld world;
  world.AddBox("wall", 3.0, 0.0, 0.2, 4.0, {0.0, 1.0});
  world.AddRobot("r0", {});
  world.AddRobot("r1", {0.0, 2.0, 0.0, 0.0});
  RecordedRun run{
      .run = 7, .program_version = "1.2.3", .step_version = 4, .file = "small.world", .keyframe_interval = 5};
  run.settings.ticks = 20;
  run.settings.mode = Mode::kRealtime;
  run.settings.speed = 2.5;
  run.settings.on_agent_loss = OnAgentLoss::kPause;
  run.world = world.world();
  run.expectations = {{"slow", "forall r: always speed(r) < 1 m/s"}, {"", "true"}};
  run.regions = {{"hall", {{0.0, 0.0}, {2.0, 0.0}, {2.0, 1.0}}, {}},
                 {"attic", {{0.0, 0.0}, {1.0, 0.0}, {0.0, 1.0}}, 4.0}};
  return run;
}

FrameMessage FrameOf(const RecordedTick& tick, const WorldDescription& world) {
  FrameMessage frame{.run = 7, .state = PlacedState(world)};
  frame.state.tick = tick.tick;
  frame.edition = tick.edition;
  frame.state_hash = tick.state_hash;
  return frame;
}

// 21 states: a keyframe every five, a set pose after tick 7, and a reset to tick 0 after tick 12.
std::vector<RecordedTick> MakeTicks(const WorldDescription& world) {
  std::vector<RecordedTick> ticks;
  Tick tick = 0;
  Edition edition = 0;
  for (std::uint64_t number = 0; number <= 20; ++number) {
    RecordedTick& next = ticks.emplace_back();
    const bool moves = number == 8;
    const bool resets = number == 14;
    if (moves || resets) {
      next.edit.emplace();
      next.edit->before = FrameOf(ticks[number - 1], world);
      next.edit->request = resets ? control::Request(control::Reset()) : control::SetPose{.name = "r0"};
      ++edition;
    } else if (number > 0) {
      ++tick;
      next.proposals = {{RobotId(0), {0.25, 0.0, -0.5}, {}}, {RobotId(1), {1.0 / 3.0, 0.0, 0.0}, {0.5, 1e-300}}};
    }
    if (number % 4 == 1) {
      RobotCommand& command = next.commands.emplace_back();
      command.robot = RobotId(1);
      command.twist = Twist{0.5, 0.0, 0.25};
      command.grippers = {{.gripper = 2, .opening = 30.0, .lift = {}}};
      command.goal = Goal{3, {{1.0, 2.0}, {-1.0, 0.5}}, 0.5};
    }
    if (resets) tick = 0;
    next.number = number;
    next.tick = tick;
    next.edition = edition;
    next.state_hash = 1000 + number;
    if (number % 3 == 0) next.events.push_back({tick, EventType::kStallBegan, RobotId(1), ModelId(0), "detail"});
    if (!next.edit && tick % 5 == 0) next.keyframe = FrameOf(next, world);
  }
  return ticks;
}

std::vector<std::byte> Write(const RecordedRun& run, const std::vector<RecordedTick>& ticks) {
  std::vector<std::byte> bytes;
  RecordingWriter writer = RecordingWriter::Create(mcap::MakeMemorySink(bytes), run).value();
  for (const RecordedTick& tick : ticks) EXPECT_TRUE(writer.Add(tick).ok());
  EXPECT_TRUE(writer.Close().ok());
  return bytes;
}

Result<Recording> Open(std::span<const std::byte> bytes) {
  return Recording::Open(mcap::MakeMemorySource("test.mcap", bytes));
}

void ExpectSame(const RecordedTick& found, const RecordedTick& expected) {
  EXPECT_EQ(found.number, expected.number);
  EXPECT_EQ(found.tick, expected.tick);
  EXPECT_EQ(found.edition, expected.edition);
  EXPECT_EQ(found.state_hash, expected.state_hash);
  EXPECT_EQ(found.proposals, expected.proposals);
  EXPECT_EQ(found.commands, expected.commands);
  EXPECT_EQ(found.events, expected.events);
  EXPECT_EQ(found.keyframe, expected.keyframe);
  ASSERT_EQ(found.edit.has_value(), expected.edit.has_value());
  if (!found.edit) return;
  EXPECT_EQ(found.edit->before, expected.edit->before);
  EXPECT_EQ(found.edit->request, expected.edit->request);
  EXPECT_EQ(found.edit->world, expected.edit->world);
}

// The number of ticks up to the first that cannot be read; each is as it was written.
std::size_t CountEqualTicks(const Recording& recording, const std::vector<RecordedTick>& expected, bool& whole) {
  TickReader reader(recording);
  RecordedTick tick;
  std::size_t count = 0;
  whole = !recording.damage();
  for (;; ++count) {
    const Result<bool> more = reader.Next(tick);
    if (!more.ok()) whole = false;
    if (!more.ok() || !more.value()) return count;
    if (count == expected.size()) {
      ADD_FAILURE() << "found more ticks than were written";
      return count;
    }
    ExpectSame(tick, expected[count]);
  }
}

TEST(Recording, ReturnsTheRunAndItsTicks) {
  const RecordedRun run = MakeRun();
  const std::vector<RecordedTick> ticks = MakeTicks(run.world);
  const std::vector<std::byte> bytes = Write(run, ticks);
  const Result<Recording> opened = Open(bytes);
  ASSERT_TRUE(opened.ok()) << opened.error().message;
  const RecordedRun& found = opened.value().run();
  EXPECT_EQ(found.run, 7u);
  EXPECT_EQ(found.program_version, "1.2.3");
  EXPECT_EQ(found.step_version, 4u);
  EXPECT_EQ(found.file, "small.world");
  EXPECT_EQ(found.keyframe_interval, 5u);
  EXPECT_EQ(found.settings.ticks, 20u);
  EXPECT_EQ(found.settings.mode, Mode::kRealtime);
  EXPECT_EQ(found.settings.speed, 2.5);
  EXPECT_EQ(found.settings.on_agent_loss, OnAgentLoss::kPause);
  EXPECT_EQ(found.world, run.world);
  EXPECT_EQ(found.expectations, run.expectations);
  ASSERT_EQ(found.regions.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(found.regions[i].name, run.regions[i].name);
    EXPECT_EQ(found.regions[i].outline, run.regions[i].outline);
    EXPECT_EQ(found.regions[i].z, run.regions[i].z);
  }
  bool whole = false;
  EXPECT_EQ(CountEqualTicks(opened.value(), ticks, whole), ticks.size());
  EXPECT_TRUE(whole);
}

TEST(Recording, HasAPlainCopyWithoutCompression) {
  const RecordedRun run = MakeRun();
  const std::vector<RecordedTick> ticks = MakeTicks(run.world);
  const std::vector<std::byte> packed = Write(run, ticks);
  const Recording original = Open(packed).value();
  const Result<std::vector<std::byte>> plain = PlainCopy(original);
  ASSERT_TRUE(plain.ok());
  EXPECT_GT(plain.value().size(), packed.size());
  const Recording copy = Open(plain.value()).value();
  EXPECT_EQ(copy.run().world, run.world);
  EXPECT_EQ(copy.keyframes(), original.keyframes());
  bool whole = false;
  EXPECT_EQ(CountEqualTicks(copy, ticks, whole), ticks.size());
  EXPECT_TRUE(whole);
  const auto source = mcap::Reader::Open(mcap::MakeMemorySource("copy", plain.value()));
  ASSERT_TRUE(source.ok());
  for (const mcap::ChunkInfo& chunk : source.value().chunks()) EXPECT_EQ(chunk.compression, mcap::kUncompressed);
}

TEST(Recording, FindsTheStatesOfATickAndTheKeyframeBefore) {
  const RecordedRun run = MakeRun();
  const std::vector<RecordedTick> ticks = MakeTicks(run.world);
  const std::vector<std::byte> bytes = Write(run, ticks);
  const Recording recording = std::move(Open(bytes)).value();
  const TimeSpans& spans = recording.spans();
  EXPECT_EQ(spans.greatest(), 12u);
  EXPECT_EQ(spans.all().size(), 3u) << "two edits";
  EXPECT_EQ(spans.last(), ticks.size() - 1);
  for (const RecordedTick& tick : ticks) {
    EXPECT_EQ(spans.TickAt(tick.number), tick.tick);
    EXPECT_EQ(spans.PositionOf({tick.edition, tick.tick}), tick.number);
    EXPECT_LE(spans.First(tick.tick), tick.number);
    EXPECT_GE(spans.Last(tick.tick), tick.number);
  }
  EXPECT_EQ(spans.First(3), 3u);
  EXPECT_EQ(ticks[spans.Last(3).value()].edition, 2u) << "behind the reset";
  EXPECT_EQ(spans.First(13), std::nullopt);
  // From each keyframe on the ticks are those that were written.
  for (std::uint64_t position = 0; position < ticks.size(); ++position) {
    const std::size_t chunk = recording.KeyframeUpTo(position);
    TickReader reader(recording, chunk);
    RecordedTick tick;
    ASSERT_TRUE(reader.Next(tick).value());
    EXPECT_TRUE(tick.keyframe);
    EXPECT_LE(tick.number, position);
    EXPECT_LE(position - tick.number, 7u) << "a reset sets the ticks back";
    ExpectSame(tick, ticks[tick.number]);
    std::size_t edits = 0;
    EXPECT_TRUE(
        recording.VisitEdits(chunk, [&](std::uint64_t, const RecordedEdit&) { return ++edits, Status(); }).ok());
    EXPECT_EQ(edits, tick.edition);
  }
}

TEST(Recording, ReadsACutOffFileUpToItsLastWholeChunk) {
  const RecordedRun run = MakeRun();
  const std::vector<RecordedTick> ticks = MakeTicks(run.world);
  const std::vector<std::byte> bytes = Write(run, ticks);
  std::size_t most = 0;
  for (std::size_t size = 0; size < bytes.size(); size += size < bytes.size() / 2 ? 127 : 53) {
    SCOPED_TRACE(size);
    const Result<Recording> recording = Open(std::span(bytes).first(size));
    if (!recording.ok()) {
      EXPECT_FALSE(recording.error().message.empty());
      EXPECT_EQ(most, 0u);
      continue;
    }
    bool whole = true;
    const std::size_t count = CountEqualTicks(recording.value(), ticks, whole);
    EXPECT_FALSE(whole);
    EXPECT_GE(count, most);
    most = count;
  }
  EXPECT_EQ(most, ticks.size()) << "only the summary is missing at the end";
}

TEST(Recording, NeverReturnsOtherTicksAfterAChangedBit) {
  const RecordedRun run = MakeRun();
  const std::vector<RecordedTick> ticks = MakeTicks(run.world);
  std::vector<std::byte> bytes = Write(run, ticks);
  for (std::size_t at = 0; at < bytes.size(); at += 41) {
    SCOPED_TRACE(at);
    const std::byte mask = std::byte{1} << (at / 41 % 8);
    bytes[at] ^= mask;
    if (const Result<Recording> recording = Open(bytes); recording.ok()) {
      bool whole = false;
      const std::size_t count = CountEqualTicks(recording.value(), ticks, whole);
      if (whole) {
        EXPECT_EQ(count, ticks.size());
        EXPECT_FALSE(recording.value().CheckData().ok());
      }
    }
    bytes[at] ^= mask;
  }
}

TEST(Recording, ReportsAMissingState) {
  const RecordedRun run = MakeRun();
  std::vector<RecordedTick> ticks = MakeTicks(run.world);
  ticks.erase(ticks.begin() + 3);
  const std::vector<std::byte> bytes = Write(run, ticks);
  const Recording recording = std::move(Open(bytes)).value();
  TickReader reader(recording);
  RecordedTick tick;
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(reader.Next(tick).value());
  const Result<bool> fourth = reader.Next(tick);
  ASSERT_FALSE(fourth.ok());
  EXPECT_THAT(fourth.error().message, HasSubstr("found state number 4, expected 3: states are missing"));
}

TEST(Recording, RefusesAnMcapFileOfAnotherProgram) {
  std::vector<std::byte> bytes;
  mcap::Writer writer = mcap::Writer::Create(mcap::MakeMemorySink(bytes), "ros2", "another").value();
  EXPECT_TRUE(writer.Close().ok());
  const Result<Recording> recording = Open(bytes);
  ASSERT_FALSE(recording.ok());
  EXPECT_EQ(recording.error().code, ErrorCode::kBadInput);
  EXPECT_THAT(recording.error().message, HasSubstr("found an MCAP file of profile \"ros2\""));
}

TEST(Recording, HasCompleteSchemas) {
  for (const ChannelType& channel : kChannelTypes) {
    const mcap::Schema schema = SchemaOf(channel);
    EXPECT_EQ(schema.encoding, "omgidl");
    EXPECT_EQ(schema.name.find("troupe::wire::"), 0u);
    EXPECT_THAT(schema.data, HasSubstr("struct " + schema.name.substr(14) + " {"));
    EXPECT_THAT(schema.data, testing::Not(HasSubstr("#include")));
  }
  EXPECT_THAT(SchemaOf(kChannelTypes[2]).data, HasSubstr("struct World {"));
}

// The names of the members of a struct in idl/. Converters match members by their order and types.
std::vector<std::string> MembersOf(const std::string& type) {
  const std::string begin = "struct " + type + " {";
  const auto* const idl = std::find_if(kIdlTexts, kIdlTexts + kIdlTextCount, [&](const IdlText& each) {
    return std::string(each.text).find(begin) != std::string::npos;
  });
  if (idl == kIdlTexts + kIdlTextCount) return {};
  const std::string text = std::regex_replace(std::string(idl->text), std::regex("//[^\n]*"), "");
  const std::size_t start = text.find(begin);
  const std::string body = text.substr(start, text.find("};", start) - start);
  const std::regex member(R"((\w+);)");
  std::vector<std::string> names;
  for (std::sregex_iterator found(body.begin(), body.end(), member), end; found != end; ++found) {
    names.push_back((*found)[1]);
  }
  return names;
}

template <typename Row>
std::vector<std::string> LeafNames() {
  std::vector<std::string> names;
  ForEachLeaf<Row>([&](const auto& leaf) { names.emplace_back(leaf.name); });
  return names;
}

TEST(IdlColumnsTest, HaveTheNamesOfTheFields) {
  std::vector<std::string> tables;
  ForEachTable([&]<typename Row>(const Field<WorldState, std::vector<Row>>& table) {
    tables.emplace_back(table.name);
    std::string type;  // without the s at the end, and a capital for each word
    std::string words = "_" + (tables.back() == "people" ? "persons" : tables.back());
    if (words == "_coverage") words += "s";
    for (std::size_t i = 0; i + 1 < words.size(); ++i) {
      if (words[i] == '_') continue;
      type += words[i - 1] == '_' ? static_cast<char>(std::toupper(words[i])) : words[i];
    }
    std::vector<std::string> expected = LeafNames<Row>();
    if constexpr (std::is_same_v<Row, RadioTransmission>) {
      expected.insert(expected.end() - 1, "length");  // of the bytes
    } else if constexpr (!kIsVaryingTable<Row>) {
      expected.insert(expected.begin(), "row");
    }
    EXPECT_EQ(MembersOf(type + "Columns"), expected);
  });
  EXPECT_EQ(MembersOf("StateColumns"), tables);
  std::vector<std::string> event = LeafNames<Event>();
  event.erase(event.begin());  // the tick
  EXPECT_EQ(MembersOf("EventColumns"), event);
}

// The names of the members for a field: its own, or those of its parts where the type in idl/ has no struct for them.
template <typename Part>
void AddMembers(const std::string& name, std::vector<std::string>& names) {
  constexpr bool kIsSpread = std::is_same_v<Part, Blinking> || std::is_same_v<Part, PowerDescription> ||
                             std::is_same_v<Part, MapGrid> || std::is_same_v<Part, RosIdentity>;
  if constexpr (std::is_same_v<Part, Interval> || std::is_same_v<Part, ZRange>) {
    names.insert(names.end(), {name + "_min", name + "_max"});
  } else if constexpr (std::is_same_v<Part, Vec2>) {
    names.insert(names.end(), {name + "_x", name + "_y"});
  } else if constexpr (std::is_same_v<Part, SensorParameters>) {
    names.insert(names.end(), {"type", "fields"});
  } else if constexpr (kIsSpread) {
    for (const std::string& leaf : LeafNames<Part>()) names.push_back(leaf);
  } else {
    names.push_back(name);
  }
}

template <typename Row>
void ExpectMembers(const std::string& type) {
  std::vector<std::string> names;
  ForEachField<Row>(
      [&]<typename Part>(const Field<Row, Part>& field) { AddMembers<Part>(std::string(field.name), names); });
  EXPECT_EQ(MembersOf(type), names) << type;
}

TEST(IdlColumnsTest, TheWorldHasTheNamesOfTheFields) {
  ExpectMembers<Color>("Color");
  ExpectMembers<Pose>("Pose");
  ExpectMembers<Block>("Block");
  ExpectMembers<Shape>("Shape");
  ExpectMembers<ModelDescription>("Model");
  ExpectMembers<TwistBounds>("TwistBounds");
  ExpectMembers<DriveDescription>("Drive");
  ExpectMembers<LocalizationDescription>("Localization");
  ExpectMembers<SensorDescription>("Sensor");
  ExpectMembers<ControllerDescription>("Controller");
  ExpectMembers<RobotDescription>("Robot");
  ExpectMembers<NamedPlace>("Place");
  ExpectMembers<JointDescription>("Joint");
  ExpectMembers<BreakBeam>("BreakBeam");
  ExpectMembers<GripperDescription>("Gripper");
  ExpectMembers<DoorLeaf>("DoorLeaf");
  ExpectMembers<DoorDescription>("Door");
  ExpectMembers<LiftFloor>("LiftFloor");
  ExpectMembers<LiftDescription>("Lift");
  ExpectMembers<NextGoals>("NextGoals");
  ExpectMembers<GoalSet>("GoalSet");
  ExpectMembers<PersonDescription>("Person");
  ExpectMembers<LevelDescription>("Level");
  ExpectMembers<LaneVertex>("LaneVertex");
  ExpectMembers<LaneDoor>("LaneDoor");
  ExpectMembers<Lane>("Lane");
  ExpectMembers<LaneGraph>("LaneGraph");
  ExpectMembers<LaneTrip>("LaneTrip");
  ExpectMembers<WorldDescription>("World");
}

}  // namespace
}  // namespace troupe
