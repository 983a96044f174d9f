// Every table of things is in every view of users: expectations, exported tables, recorded lines, poses, Foxglove and
// plots; and every type of event in expectations.
// The views of Python are in tests/python/test_tables.py, that of ROS in tests/process/export_test.cc.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "common/model/states.h"
#include "common/signals/state_tables.h"
#include "launcher/export/run_export.h"
#include "tests/support/files.h"
#include "tests/support/small_world.h"
#include "tests/support/values.h"
#include "transport/protocol/messages.h"
#include "troupe/expectation.h"
#include "viewer/foxglove/messages.h"
#include "viewer/gateway/signals.h"
#include "world-service/observers/recorder/recorder.h"
#include "worldfile/load_world.h"

namespace troupe {
namespace {

// A building with doors, a lift, people, lanes, and robots with sensors.
WorldDescription Guesthouse() {
  const char* const source = std::getenv("TROUPE_SOURCE_DIR");
  return test::ValueOf(
             LoadWorld(std::string(source == nullptr ? "." : source) + "/worlds/sites/guesthouse_guests.json"))
      .world;
}

std::vector<std::string> ColumnsOf(const StateTable& table) {
  std::vector<std::string> columns;
  for (const Signal& signal : table.signals) columns.push_back(signal.name);
  return columns;
}

// The tables that have things in the world.
std::vector<const StateTable*> TablesOf(const WorldDescription& world) {
  const Things things(world);
  std::vector<const StateTable*> tables;
  for (std::size_t kind = 0; kind < StateTables().size(); ++kind) {
    if (things.count(kind) > 0) tables.push_back(&StateTables()[kind]);
  }
  return tables;
}

TEST(SignalViews, EveryFieldOfEveryRowOfTheStateIsASignal) {
  ForEachTable([&]<typename Row>(const Field<WorldState, std::vector<Row>>& table) {
    const std::size_t kind = KindOf(table.name);
    ForEachLeaf<Row>([&](const auto& leaf) {
      EXPECT_NE(StateTables()[kind].Find(leaf.name), nullptr) << table.name << "." << leaf.name;
    });
  });
  for (const char* const described : {"levels", "lanes", "sensors"}) {
    EXPECT_FALSE(StateTables()[KindOf(described)].signals.empty()) << described;
  }
}

TEST(SignalViews, EveryTableIsInExpectations) {
  const WorldDescription world;
  const ExpectationScope scope{world};
  for (const StateTable& table : StateTables()) {
    EXPECT_TRUE(Expectation::Parse("always count(" + table.name + ") >= 0", scope).ok()) << table.name;
    if (table.varies) continue;
    for (const Signal& signal : table.signals) {
      const std::string read = signal.name + "(v)";
      const std::string condition = signal.type == ValueType::kTruth    ? read
                                    : signal.type == ValueType::kNumber ? read + " == " + read
                                                                        : read + " == 'a'";
      const Result<Expectation> result =
          Expectation::Parse("forall v in " + table.name + ": always " + condition, scope);
      const bool lacks_value = !result.ok() && result.error().message.find("expected one of") != std::string::npos;
      EXPECT_TRUE(result.ok() || lacks_value) << condition << ": " << result.error().message;
    }
  }
}

TEST(SignalViews, EveryTableIsInTheExportedTables) {
  test::TemporaryFolder folder;
  const std::string path = folder.path() + "/tables";
  ASSERT_TRUE(test::ValueOf(MakeCsvExport(path))->Close().ok());
  for (const StateTable& table : StateTables()) {
    std::ifstream file(path + "/" + (table.name == "robots" ? "poses" : table.name) + ".csv");
    std::string head;
    ASSERT_TRUE(std::getline(file, head)) << table.name;
    std::string columns = "time,tick," + table.singular;
    for (const std::string& column : ColumnsOf(table)) columns += "," + column;
    EXPECT_EQ(head, columns);
  }
}

// Robots, joints, grippers, objects and sensors have lines of their own (docs/running.md).
TEST(SignalViews, EveryOtherTableIsInTheRecordedLines) {
  const WorldDescription world = Guesthouse();
  test::TemporaryFolder folder;
  const std::string path = folder.path() + "/run.jsonl";
  ASSERT_TRUE(test::ValueOf(Recorder::Create(world, {.record = path}))->OnEnd().ok());
  const nlohmann::json head = nlohmann::json::parse(folder.Read("run.jsonl"));
  std::size_t found = 0;
  for (const StateTable* const table : TablesOf(world)) {
    if (head.contains(table->name) || table->name == "sensors") continue;
    ASSERT_TRUE(head["tables"].contains(table->name)) << table->name;
    EXPECT_EQ(head["tables"][table->name]["columns"], ColumnsOf(*table)) << table->name;
    ++found;
  }
  EXPECT_GE(found, 5u);  // doors, lifts, people, levels, lanes
}

// A table whose things have no pose of their own stands here, so that each new table has been thought of.
TEST(SignalViews, EveryTableOfThingsWithAPoseIsInThePoses) {
  const std::set<std::string> without_pose = {"grippers", "stores", "imus", "lights", "cameras"};
  const WorldDescription world = Guesthouse();
  const Things things(world);
  test::TemporaryFolder folder;
  const std::unique_ptr<Recorder> recorder = test::ValueOf(Recorder::Create(world, {.poses = folder.Path("poses")}));
  EXPECT_TRUE(recorder->OnTick({FrameMessage{.state = PlacedState(world)}, {}}).ok());
  EXPECT_TRUE(recorder->OnEnd().ok());
  const std::string poses = folder.Read("poses");
  int found = 0;
  ForEachTable([&]<typename Row>(const Field<WorldState, std::vector<Row>>& field) {
    const StateTable& table = StateTables()[KindOf(field.name)];
    if (table.varies || without_pose.contains(table.name) || things.count(KindOf(table.name)) == 0) return;
    EXPECT_THAT(poses, testing::HasSubstr("," + table.singular + ",")) << table.name;
    ++found;
  });
  EXPECT_GE(found, 5);  // robots, objects, doors, lifts, people
}

TEST(SignalViews, EveryTypeOfEventIsInExpectations) {
  const WorldDescription world = Guesthouse();
  const ExpectationScope scope{world};
  for (const std::string& type : AllNames<EventType>()) {
    const std::string singular = type.substr(0, type.find('_'));
    const auto of_singular = [&](const StateTable& each) { return !each.varies && each.singular == singular; };
    const auto table = std::find_if(StateTables().begin(), StateTables().end(), of_singular);
    const std::string text = table == StateTables().end()
                                 ? "always not event(" + type + ")"
                                 : "forall v in " + table->name + ": always not event(" + type + ", v)";
    const Result<Expectation> parsed = Expectation::Parse(text, scope);
    EXPECT_TRUE(parsed.ok()) << text << ": " << parsed.error().message;
  }
}

// The topics of the export for ROS have the same rows: tests/process/export_test.cc.
TEST(SignalViews, EveryTableIsAChannelOfFoxglove) {
  const WorldDescription world = Guesthouse();
  const WorldState state = PlacedState(world);
  const Things things(world);
  const std::vector<foxglove::Channel> channels = foxglove::ChannelsOf(world);
  for (const StateTable* const table : TablesOf(world)) {
    const auto channel = std::find_if(channels.begin(), channels.end(),
                                      [&](const foxglove::Channel& c) { return c.topic == "/tables/" + table->name; });
    ASSERT_NE(channel, channels.end()) << table->name;
    const nlohmann::json schema = nlohmann::json::parse(foxglove::Schema(*channel));
    const nlohmann::json rows =
        nlohmann::json::parse(foxglove::TableText(*table, {things, world, state}, 0)).at("rows");
    ASSERT_EQ(rows.size(), things.count(KindOf(table->name))) << table->name;
    for (const std::string& column : ColumnsOf(*table)) {
      EXPECT_TRUE(schema["properties"]["rows"]["items"]["properties"].contains(column)) << table->name;
    }
    const SignalView view{things, world, state};
    for (const Signal& signal : table->signals) {
      const bool has_value =
          signal.type == ValueType::kText ? !signal.text(view, 0).empty() : !std::isnan(signal.number(view, 0));
      EXPECT_EQ(rows[0].contains(signal.name), has_value) << table->name << "." << signal.name;
    }
    EXPECT_GE(rows[0].size(), 2u) << table->name;
  }
}

TEST(SignalViews, EveryTableIsInThePlots) {
  SmallWorld world;
  world.AddRobot("anna", {1.0, 2.0, 0.0, 0.0});
  SignalReader reader;
  const WorldState state = PlacedState(world.world());
  WorldCache worlds;
  reader.SetState(std::make_shared<const TimelineState>(TimelineState{
      .world = worlds.Of(SessionMessage{.world = world.world()}), .state = std::make_shared<const WorldState>(state)}));
  const nlohmann::json described = reader.Describe();
  ASSERT_EQ(described.size(), StateTables().size());
  for (std::size_t kind = 0; kind < described.size(); ++kind) {
    const StateTable& table = StateTables()[kind];
    EXPECT_EQ(described[kind]["name"], table.name);
    EXPECT_EQ(reader.Value({table.name, "count"}), table.name == "robots" ? 1.0 : 0.0) << table.name;
    if (table.varies) continue;
    std::vector<std::string> names;
    for (const nlohmann::json& signal : described[kind]["signals"]) names.push_back(signal["name"]);
    EXPECT_EQ(names, ColumnsOf(table)) << table.name;
  }
  EXPECT_EQ(reader.Value({"anna", "y"}), 2.0);
}

// Two levels, and on the upper one a lane of 4 m without a door.
TEST(SignalViews, LevelsAndLanesCountTheBodiesOnThem) {
  SmallWorld world;
  const Pose poses[] = {{0.0, 0.0, 0.0, 0.0}, {1.0, 0.4, 3.0, 0.0}, {1.0, 0.6, 3.0, 0.0}, {4.4, 0.0, 3.0, 0.0}};
  for (std::size_t i = 0; i < std::size(poses); ++i) world.AddRobot("r" + std::to_string(i), poses[i]);
  world.world().levels = {{"ground", 0.0}, {"upper", 3.0}};
  LaneGraph graph;
  for (const double x : {0.0, 4.0}) graph.vertices.push_back({.position = {x, 0.0}, .z = 3.0});
  graph.vertices[0].name = "dock";
  graph.lanes.push_back({.start = 0, .end = 1});
  world.world().lane_graphs.push_back(graph);
  const WorldState state = PlacedState(world.world());
  const Things things(world.world());
  const SignalView view{things, world.world(), state};
  const auto number = [&](const char* table, const char* signal, std::size_t row) {
    return StateTables()[KindOf(table)].Find(signal)->number(view, row);
  };
  EXPECT_EQ(number("levels", "robots", 0), 1.0);
  EXPECT_EQ(number("levels", "robots", 1), 3.0);
  EXPECT_EQ(number("levels", "people", 1), 0.0);
  EXPECT_EQ(number("lanes", "robots", 0), 2.0);  // 0.4 m beside it, and 0.4 m behind its end
  EXPECT_EQ(number("lanes", "length", 0), 4.0);
  EXPECT_EQ(number("lanes", "open", 0), 1.0);
  EXPECT_TRUE(things.Find("upper", KindOf("levels")));
  EXPECT_TRUE(things.Find("0: dock - vertex 1", KindOf("lanes")));
}

TEST(SignalViews, ThingsHaveTheNumbersOfTheirBodies) {
  SmallWorld world;
  for (const char* const name : {"anna", "bob"}) world.AddRobot(name, {});
  const Things things(world.world());
  EXPECT_EQ(things.Find("bob", RobotKind()), 1u);
  EXPECT_EQ(things.kind_of(1), RobotKind());
  EXPECT_EQ(things.row_of(1), 1u);
  EXPECT_FALSE(things.Find("bob", ObjectKind()));
  EXPECT_EQ(things.names(), (std::vector<std::string>{"anna", "bob"}));
}

}  // namespace
}  // namespace troupe
