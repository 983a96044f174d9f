// What the page's forms need: controllers and their parameters, warnings at values, models of libraries, plans.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <string>

#include "common/image/image_file.h"
#include "tests/support/files.h"
#include "tests/support/values.h"
#include "tests/unit/viewer/editor/edited_world.h"

namespace troupe {
namespace {

using Json = nlohmann::json;

const char* const kScenario = R"({
  "robots": [
    {"name": "a", "model": "position", "pose": [0, 0, 90], "controller": {"name": "wander", "parameters": {"speed": 0.50,  "turn_rate": 1}}},
    {"name": "b", "model": "position", "pose": [2, 0, 0]}
  ]
}
)";

Json Member(const std::string& name, const Json& inside, const std::string& key, const Json& value) {
  Json path = inside;
  path.push_back(key);
  return {{"op", "set_value"}, {"name", name}, {"path", path}, {"value", value}};
}

TEST(TypedValuesTest, AParameterOfAScenariosControllerChangesItsBytesAlone) {
  const test::TemporaryFolder folder;
  const auto editor = OpenedEditor(folder.Write("two.json", kScenario));
  Applied(*editor, Member("a", {"controller", "parameters"}, "speed", 0.8));
  EXPECT_EQ(editor->text(), WithPart(kScenario, "0.50", "0.8"));
  const Json report = Applied(*editor, {{"op", "entity"}, {"name", "a"}});
  EXPECT_EQ(report["controller"]["name"], "wander");
  EXPECT_EQ(report["controller"]["own"], true);
  EXPECT_EQ(report["controller"]["parameters"]["speed"], 0.8);

  // What is missing is added around the member.
  Applied(*editor, Member("b", Json::array(), "controller", "wander"));
  EXPECT_NE(editor->text().find(R"("pose": [2, 0, 0], "controller": "wander"})"), std::string::npos) << editor->text();
  Applied(*editor, Member("b", Json::array(), "controller",
                          {{"name", "patrol"}, {"parameters", {{"waypoints", {{0, 0}, {1, 0}}}}}}));
  EXPECT_NE(editor->text().find(R"({"name": "patrol", "parameters": {"waypoints": [[0, 0], [1, 0]]}})"),
            std::string::npos)
      << editor->text();
  Applied(*editor, Member("b", {"controller", "parameters"}, "speed", 1.5));
  EXPECT_NE(editor->text().find(R"(]], "speed": 1.5})"), std::string::npos) << editor->text();

  EXPECT_NE(Refused(*editor, Member("a", {"controller", "parameters"}, "speed", -1)).find("the number -1 as 'speed'"),
            std::string::npos);
  Refused(*editor, Member("a", {"controller", 7}, "speed", 1));
  Refused(*editor, Member("a", Json(std::vector<std::string>(12, "a")), "speed", 1));
  Json deep = 1;
  for (int i = 0; i < 100; ++i) deep = Json::array({std::move(deep)});
  EXPECT_NE(Refused(*editor, Member("a", Json::array(), "controller", deep)).find("deep"), std::string::npos);
}

TEST(TypedValuesTest, AValueHasTheWarningAboutIt) {
  const test::TemporaryFolder folder;
  const auto editor = OpenedEditor(
      folder.Write("r.world", "position( name \"r\" pose [0 0 0 0] ctrl \"wander speed=900\" color \"grren\" )\n"));
  const Json report = Applied(*editor, {{"op", "entity"}, {"name", "r"}});
  std::string found;
  for (const Json& property : report["properties"]) {
    if (!property.contains("warning")) continue;
    found += property["name"].get<std::string>() + " ";
    const std::string expected = property["name"] == "ctrl" ? "speed=900" : "grren";
    EXPECT_NE(property["warning"].get<std::string>().find(expected), std::string::npos) << property;
  }
  EXPECT_EQ(found, "ctrl color ");
}

// ReplyToEdit gives these to every reply.
TEST(TypedValuesTest, ReportsLeaveTheMembersOfRepliesToThem) {
  const test::TemporaryFolder folder;
  const auto editor =
      OpenedEditor(folder.Write("r.world", "define bot position( size [1 1 1] )\nbot( name \"r\" pose [0 0 0 0] )\n"));
  for (const Json& request : {Json{{"op", "document"}}, Json{{"op", "palette"}}, Json{{"op", "help"}},
                              Json{{"op", "entity"}, {"name", "r"}}, Json{{"op", "model"}, {"name", "bot"}}}) {
    const Json report = Applied(*editor, request);
    for (const char* const member : {"type", "id", "done", "problem", "conflict"}) {
      EXPECT_FALSE(report.contains(member)) << request << " " << member;
    }
  }
  EXPECT_EQ(Applied(*editor, {{"op", "entity"}, {"name", "r"}})["base_type"], "position");
}

TEST(TypedValuesTest, HelpHasControllersAndColours) {
  const test::TemporaryFolder folder;
  const auto editor = OpenedEditor(folder.Write("r.world", ""));
  const Json help = Applied(*editor, {{"op", "help"}});
  EXPECT_EQ(help["colors"]["red"], Json({255, 0, 0}));
  EXPECT_EQ(help["stage_controllers"]["expand_swarm"]["name"], "expand");
  EXPECT_EQ(help["controllers"].size(), 21U);
}

// A library in a folder of STAGEPATH.
class LibraryTest : public ::testing::Test {
 protected:
  LibraryTest() {
    std::filesystem::create_directories(folder_.Path("library"));
    folder_.Write("library/lamps.inc",
                  "define base model ( color \"gray\" )\n"
                  "define lamp base ( size [0.2 0.2 1.5] )\n"
                  "define rover position ( size [0.4 0.3 0.2] )\n");
    setenv("STAGEPATH", folder_.Path("library").c_str(), 1);
  }
  ~LibraryTest() override { unsetenv("STAGEPATH"); }

  static const Json* RowOf(const Json& palette, const std::string& name) {
    for (const Json& row : palette["models"]) {
      if (row["name"] == name) return &row;
    }
    return nullptr;
  }

  const test::TemporaryFolder folder_;
};

TEST_F(LibraryTest, ModelsArePutDownWithTheirInclude) {
  const auto editor = OpenedEditor(folder_.Write("new.world", ""));
  const Json palette = Applied(*editor, {{"op", "palette"}});
  const Json* const lamp = RowOf(palette, "lamp");
  ASSERT_NE(lamp, nullptr) << palette;
  EXPECT_EQ((*lamp)["library"], "lamps");
  EXPECT_FALSE((*lamp)["picture"].empty());
  EXPECT_EQ(RowOf(palette, "base"), nullptr) << "it has no body of its own";

  EXPECT_EQ(test::ValueOf(editor->Add("lamp", {1.0, 2.0, 0.0, 0.0})), "lamp1");
  EXPECT_EQ(editor->text(), "include \"lamps.inc\"\nlamp( name \"lamp1\" pose [1 2 0 0] )\n");
  EXPECT_EQ(test::ValueOf(editor->Add("rover", {0.0, 0.0, 0.0, 0.0})), "rover1");
  EXPECT_EQ(editor->text().find("include", 5), std::string::npos) << "once: " << editor->text();
  EXPECT_FALSE(RowOf(Applied(*editor, {{"op", "palette"}}), "lamp")->contains("library"));
  Applied(*editor, {{"op", "undo"}});
  Applied(*editor, {{"op", "undo"}});
  EXPECT_EQ(editor->text(), "");
}

TEST_F(LibraryTest, AnIncludeFollowsTheOthersAndLeavesTheRest) {
  folder_.Write("own.inc", "define box model( size [1 1 1] )\n");
  const std::string text = "# a yard\ninclude \"own.inc\"  # mine\n\n# the first\nbox( name \"b\" pose [0 0 0 0] )\n";
  const auto editor = OpenedEditor(folder_.Write("yard.world", text));
  test::ValueOf(editor->Add("lamp", {3.0, 0.0, 0.0, 0.0}));
  EXPECT_EQ(editor->text(),
            WithPart(text, "# mine\n", "# mine\ninclude \"lamps.inc\"\n") + "lamp( name \"lamp1\" pose [3 0 0 0] )\n");
}

TEST_F(LibraryTest, AScenarioIncludesItToo) {
  const auto editor = OpenedEditor(folder_.Write("two.json", kScenario));
  test::ValueOf(editor->Add("rover", {0.0, 3.0, 0.0, 0.0}));
  EXPECT_NE(editor->text().find(R"("include": ["lamps.inc"])"), std::string::npos) << editor->text();
  EXPECT_NE(editor->text().find(R"({"name": "rover1", "model": "rover", "pose": [0, 3, 0]})"), std::string::npos)
      << editor->text();
}

TEST_F(LibraryTest, AFileOfTheSameNameBesideTheWorldIsNotTaken) {
  folder_.Write("lamps.inc", "define mine model( size [1 1 1] )\n");
  const auto editor = OpenedEditor(folder_.Write("yard.world", ""));
  test::ValueOf(editor->Add("lamp", {3.0, 0.0, 0.0, 0.0}));
  EXPECT_NE(editor->text().find("library/lamps.inc\"\n"), std::string::npos) << editor->text();
}

TEST_F(LibraryTest, AFileInOtherUnitsHasNone) {
  const auto editor = OpenedEditor(folder_.Write("cm.world", "unit_length \"cm\"\n"));
  EXPECT_EQ(RowOf(Applied(*editor, {{"op", "palette"}}), "lamp"), nullptr);
}

// A plan of 8 x 4 pixels: a wall along its left edge and one from there to the right.
TEST(PlanTest, ThePixelsOfAPictureAreWalls) {
  const test::TemporaryFolder folder;
  const auto editor = OpenedEditor(folder.Write("plan.world", ""));
  const Json runs = {0, 1, 7, 1, 7, 6, 2, 1, 7};
  Json request = {{"op", "create_bitmap"}, {"file", "plan.png"},   {"size", {4.0, 2.0, 1.5}},
                  {"pixel", 0.5},          {"pose", {0, 0, 0, 0}}, {"runs", runs}};
  Applied(*editor, request);
  const WorldDescription& world = editor->world()->loaded.world;
  ASSERT_EQ(world.models.size(), 1U);
  const troupe::Shape& shape = world.shape(world.models[0].shape);
  const auto is_wall = [&](double x, double y) {
    for (const Rectangle& r : shape.rectangles) {
      if (x > r.min_x && x < r.max_x && y > r.min_y && y < r.max_y) return true;
    }
    return false;
  };
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 8; ++column) {
      const bool wanted = column == 0 || (row == 2 && column < 6);
      EXPECT_EQ(is_wall(-2.0 + 0.5 * column + 0.25, 1.0 - 0.5 * row - 0.25), wanted) << column << " " << row;
    }
  }
  for (const Json& wrong : {Json(7), Json({1, 2}), Json({-1, 33}), Json({0, 33}), Json({"a"}), Json({0.5, 31.5})}) {
    request["file"] = "other.png";
    request["runs"] = wrong;
    Refused(*editor, request);
  }
}

}  // namespace
}  // namespace troupe
