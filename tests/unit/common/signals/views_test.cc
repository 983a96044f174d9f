// Every table of the state is in every view of users: expectations, exported tables and plots. The view of Python is in
// tests/python/test_tables.py.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "common/model/states.h"
#include "common/signals/state_tables.h"
#include "launcher/export/run_export.h"
#include "tests/support/files.h"
#include "tests/support/small_world.h"
#include "tests/support/values.h"
#include "transport/protocol/messages.h"
#include "troupe/expectation.h"
#include "viewer/gateway/signals.h"

namespace troupe {
namespace {

using testing::HasSubstr;

// Calls visit(table, names of its fields) for all tables of a state.
template <typename Visit>
void ForEachTableByName(const Visit& visit) {
  ForEachTable([&]<typename Row>(const Field<WorldState, std::vector<Row>>& table) {
    std::vector<std::string> fields;
    ForEachLeaf<Row>([&](const auto& leaf) { fields.emplace_back(leaf.name); });
    visit(std::string(table.name), fields);
  });
}

TEST(SignalViews, EveryTableIsInExpectations) {
  const WorldDescription world;
  const ExpectationScope scope{world};
  ForEachTableByName([&](const std::string& name, const std::vector<std::string>& fields) {
    EXPECT_TRUE(Expectation::Parse("always count(" + name + ") >= 0", scope).ok()) << name;
    const StateTable& table = StateTables()[KindOf(name)];
    if (table.varies) return;
    for (const std::string& field : fields) {
      const Signal* const signal = table.Find(field);
      ASSERT_NE(signal, nullptr) << name << "." << field;
      const std::string read = field + "(v)";
      const std::string condition = signal->type == ValueType::kTruth    ? read
                                    : signal->type == ValueType::kNumber ? read + " == " + read
                                                                         : read + " == 'a'";
      const Result<Expectation> result = Expectation::Parse("forall v in " + name + ": always " + condition, scope);
      const bool lacks_value = !result.ok() && result.error().message.find("expected one of") != std::string::npos;
      EXPECT_TRUE(result.ok() || lacks_value) << condition << ": " << result.error().message;
    }
  });
}

TEST(SignalViews, EveryTableIsInTheExportedTables) {
  test::TemporaryFolder folder;
  const std::string path = folder.path() + "/tables";
  ASSERT_TRUE(test::ValueOf(MakeCsvExport(path))->Close().ok());
  ForEachTableByName([&](const std::string& name, const std::vector<std::string>& fields) {
    std::ifstream file(path + "/" + (name == "robots" ? "poses" : name) + ".csv");
    std::string head;
    ASSERT_TRUE(std::getline(file, head)) << name;
    for (const std::string& field : fields) EXPECT_THAT(head + ",", HasSubstr("," + field + ",")) << name;
  });
}

TEST(SignalViews, EveryTableIsInThePlots) {
  SmallWorld world;
  world.AddRobot("anna", {1.0, 2.0, 0.0, 0.0});
  SignalReader reader;
  const WorldState state = PlacedState(world.world());
  WorldCache worlds;
  reader.SetState(std::make_shared<const TimelineState>(TimelineState{
      .world = worlds.Of(SessionMessage{.world = world.world()}), .state = std::make_shared<const WorldState>(state)}));
  const nlohmann::json tables = reader.Describe();
  ForEachTableByName([&](const std::string& name, const std::vector<std::string>& fields) {
    const auto table =
        std::find_if(tables.begin(), tables.end(), [&](const nlohmann::json& t) { return t["name"] == name; });
    ASSERT_NE(table, tables.end()) << name;
    if (StateTables()[KindOf(name)].varies) {
      EXPECT_EQ(reader.Value({name, "count"}), 0.0);
      return;
    }
    for (const std::string& field : fields) {
      const auto& signals = (*table)["signals"];
      const bool has_field = std::any_of(signals.begin(), signals.end(),
                                         [&](const nlohmann::json& signal) { return signal["name"] == field; });
      EXPECT_TRUE(has_field) << name << "." << field;
    }
  });
  EXPECT_EQ(reader.Value({"anna", "y"}), 2.0);
  EXPECT_EQ(reader.Value({"robots", "count"}), 1.0);
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
