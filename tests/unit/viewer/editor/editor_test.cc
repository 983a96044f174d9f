#include "viewer/editor/editor.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <numbers>

#include "tests/support/files.h"
#include "tests/support/stage_worlds.h"
#include "tests/support/values.h"
#include "tests/unit/viewer/editor/edited_world.h"
#include "viewer/editor/model_parts.h"
#include "worldfile/load_world.h"

namespace troupe {
namespace {

using Json = nlohmann::json;

const char* const kThings = "define crate model ( size [0.5 0.5 0.4] color \"brown\" gripper_return 1 )\n";
const char* const kYard = R"(include "things.inc"
unit_length "cm"   # all of them
crate( name "left" pose [100 200 0 30] )  # first
model
(
  name "table"  size [100 50 70]  pose [300 0 0 90]
  crate( name "box" pose [10 0 0 0] )
)
position( name "r0" pose [0 0 0 0] )
)";

TEST(EditorTest, PosesAreWrittenInTheUnitsAndTheFrameOfTheFile) {
  const test::TemporaryFolder folder;
  folder.Write("things.inc", "define crate model ( size [50 50 40] color \"brown\" gripper_return 1 )\n");
  const auto editor = OpenedEditor(folder.Write("yard.world", kYard));
  ASSERT_TRUE(editor->SetPose("left", {1.5, 2.0, 0.0, std::numbers::pi / 6}).ok());
  EXPECT_EQ(editor->text(), WithPart(kYard, "[100 200 0 30]", "[150 200 0 30]"));
  // A child: 0.1 m along the table's x is along y of the world; its height counts from the table's top.
  const EditedEntity* const box = editor->world()->Find("table.box");
  ASSERT_NE(box, nullptr);
  const Pose at = PoseInWorld(editor->world()->loaded.world, box->model);
  EXPECT_NEAR(at.y, 0.1, 1e-9);
  EXPECT_NEAR(at.z, 0.7, 1e-9);
  ASSERT_TRUE(editor->SetPose("table.box", {at.x, 0.3, at.z, at.heading}).ok());
  EXPECT_NE(editor->text().find("crate( name \"box\" pose [30 0 0 0] )"), std::string::npos) << editor->text();
}

TEST(EditorTest, EditsAreUndoneToTheByte) {
  const test::TemporaryFolder folder;
  folder.Write("things.inc", kThings);
  const std::string text = WithPart(kYard, "unit_length \"cm\"   # all of them\n", "");
  const auto editor = OpenedEditor(folder.Write("yard.world", text));
  ASSERT_TRUE(editor->Rename("left", "right").ok());
  ASSERT_TRUE(editor->Remove("table").ok());
  EXPECT_EQ(test::ValueOf(editor->Add("crate", {1.25, 0.5, 0.0, 0.0})), "crate1");
  Applied(*editor, {{"op", "set_property"}, {"name", "r0"}, {"property", "color"}, {"value", "\"green\""}});
  for (int i = 0; i < 4; ++i) Applied(*editor, {{"op", "undo"}});
  EXPECT_EQ(editor->text(), text);
  EXPECT_FALSE(editor->is_modified());
  for (int i = 0; i < 4; ++i) Applied(*editor, {{"op", "redo"}});
  Refused(*editor, {{"op", "redo"}});
  Applied(*editor, {{"op", "save"}});
  EXPECT_EQ(test::ValueOf(LoadWorld(folder / "yard.world")).world.robots.size(), 1U);
}

TEST(EditorTest, CopiesHaveAllThatTheirEntryHas) {
  const test::TemporaryFolder folder;
  folder.Write("things.inc", "define crate model ( size [50 50 40] color \"brown\" gripper_return 1 )\n");
  const auto editor = OpenedEditor(folder.Write("yard.world", kYard));
  // In the units of the file, behind the entry and its comment, under a free name; parts come along.
  const Json crate =
      Applied(*editor, {{"op", "copy"}, {"name", "left"}, {"pose", {1.5, 2.0, 0.0, std::numbers::pi / 6}}});
  EXPECT_EQ(crate["name"], "left1");
  EXPECT_NE(editor->text().find("  # first\ncrate( name \"left1\" pose [150 200 0 30] )\nmodel"), std::string::npos)
      << editor->text();
  EXPECT_EQ(Applied(*editor, {{"op", "copy"}, {"name", "table"}, {"pose", {5.0, 0.0, 0.0, 0.0}}})["name"], "table1");
  EXPECT_NE(editor->world()->Find("table1.box"), nullptr);
  EXPECT_NE(
      Refused(*editor, {{"op", "copy"}, {"name", "table.box"}, {"pose", {5.0, 0.0, 0.0, 0.0}}}).find("whole model"),
      std::string::npos);
  Refused(*editor, {{"op", "copy"}, {"name", "nothing"}, {"pose", {0.0, 0.0, 0.0, 0.0}}});
  for (int i = 0; i < 2; ++i) Applied(*editor, {{"op", "undo"}});
  EXPECT_EQ(editor->text(), kYard);
}

TEST(EditorTest, EntriesOfScenariosAreCopied) {
  const test::TemporaryFolder folder;
  folder.Write("things.inc", kThings);
  const std::string text = R"({
  "include": ["things.inc"],
  "robots": [
    {"name": "r1", "model": "position", "pose": [0, 0, 90], "controller": {"name": "wander", "parameters": {"speed": 0.3}}}
  ]
})";
  const auto editor = OpenedEditor(folder.Write("yard.json", text));
  EXPECT_EQ(Applied(*editor, {{"op", "copy"}, {"name", "r1"}, {"pose", {1.0, 2.0, 0.0, 0.0}}})["name"], "r2");
  EXPECT_NE(
      editor->text().find(R"({"name": "r2", "model": "position", "pose": [1, 2, 0], "controller": {"name": "wander")"),
      std::string::npos)
      << editor->text();
}

TEST(EditorTest, EditsThatDoNotLoadAreRefusedWithTheirPlace) {
  const test::TemporaryFolder folder;
  folder.Write("things.inc", kThings);
  const auto editor = OpenedEditor(folder.Write("yard.world", kYard));
  const auto set = [](const char* property, const char* value) {
    return Json{{"op", "set_property"}, {"name", "r0"}, {"property", property}, {"value", value}};
  };
  EXPECT_NE(Refused(*editor, set("pose", "[1 2]")).find("yard.world:9:"), std::string::npos);
  Refused(*editor, set("drive", "[\"diff\""));
  Refused(*editor, set("color", "\"a\" ) model("));
  Refused(*editor, set("a b", "1"));
  Refused(*editor, {{"op", "rename"}, {"name", "r0"}, {"to", "left"}});
  Refused(*editor, {{"op", "rename"}, {"name", "r0"}, {"to", "a\nb"}});
  Refused(*editor, {{"op", "delete"}, {"name", "nothing"}});
  Refused(*editor, {{"op", "nothing"}});
}

TEST(EditorTest, ABrokenTextIsCorrectedInTheText) {
  const test::TemporaryFolder folder;
  const auto editor = OpenedEditor(folder.Write("bad.world", "model( pose [0 0 )\n"));
  EXPECT_EQ(editor->world(), nullptr);
  const Json document = Applied(*editor, {{"op", "document"}});
  EXPECT_NE(document["error"].get<std::string>().find("bad.world:1:18: error: "), std::string::npos) << document;
  Refused(*editor, {{"op", "delete"}, {"name", "model:0"}});
  Applied(*editor, {{"op", "set_text"}, {"text", "model( pose [0 0 0 0] )\n"}});
  EXPECT_NE(editor->world(), nullptr);
  EXPECT_TRUE(editor->Remove("model:0").ok());
}

TEST(EditorTest, TheTextNamesFilesOfItsOwnFoldersOnly) {
  const test::TemporaryFolder folder;
  const test::TemporaryFolder elsewhere;
  elsewhere.Write("things.inc", kThings);
  const std::string file = folder.Write("yard.world", "position( name \"r0\" )\n");
  const std::string text = "include \"" + (elsewhere / "things.inc") + "\"\n";
  const auto editor = OpenedEditor(file);
  const Json reply = Applied(*editor, {{"op", "set_text"}, {"text", text}});
  EXPECT_NE(reply["error"].get<std::string>().find("allow"), std::string::npos) << reply;
  EXPECT_EQ(Applied(*test::ValueOf(Editor::Open(file, {elsewhere / "things.inc"})),
                    {{"op", "set_text"}, {"text", text}})["error"],
            "");
  folder.Write("yard.world", text);
  EXPECT_EQ(Applied(*OpenedEditor(file), {{"op", "document"}})["error"], "");
}

TEST(EditorTest, ModelsOfAnIncludeFileStandSideBySide) {
  const test::TemporaryFolder folder;
  const std::string text =
      std::string(kThings) + "# A robot.\ndefine bot position ( size [0.3 0.3 0.2] )\ndefine eye ranger ( )\n";
  const auto editor = OpenedEditor(folder.Write("things.inc", text));
  ASSERT_EQ(editor->world()->entities.size(), 2U);
  EXPECT_TRUE(editor->world()->entities[0].on_shelf);
  Refused(*editor, {{"op", "set_pose"}, {"name", "bot"}, {"pose", {1, 2, 0, 0}}});
  Applied(*editor, {{"op", "set_property"}, {"name", "bot"}, {"property", "drive"}, {"value", "\"omni\""}});
  EXPECT_EQ(editor->text(), WithPart(text, "size [0.3 0.3 0.2] )", "size [0.3 0.3 0.2] drive \"omni\" )"));
}

TEST(EditorTest, ADrawnModelIsWhereItWasDrawn) {
  const test::TemporaryFolder folder;
  for (const auto& [units, metres] : {std::pair("", 1.0), std::pair("unit_length \"mm\"\n", 0.001)}) {
    const auto editor = OpenedEditor(folder.Write("drawn.inc", units));
    const Json blocks = {{{"outline", {{0.1, 0.0}, {0.9, 0.0}, {0.9, 0.4}}}, {"z", {0.4, 0.7}}},
                         {{"outline", {{0.1, 0.0}, {0.2, 0.0}, {0.2, 0.1}, {0.1, 0.1}}}, {"z", {0.0, 0.4}}}};
    Applied(*editor, {{"op", "set_model"}, {"name", "desk"}, {"base", "model"}, {"blocks", blocks}});
    Json report = Applied(*editor, {{"op", "model"}, {"name", "desk"}});
    ASSERT_EQ(report["blocks"].size(), 2U);
    EXPECT_EQ(report["metres"], metres);
    EXPECT_NEAR(report["blocks"][0]["z"][0].get<double>(), 0.4, 1e-6);
    EXPECT_NEAR(report["blocks"][0]["z"][1].get<double>(), 0.7, 1e-6);
    double least = 1.0;
    for (const Json& corner : report["blocks"][0]["outline"]) least = std::min(least, corner[0].get<double>());
    EXPECT_NEAR(least, 0.1, 2e-4);
    // Again, lower and moved: the same text but for its numbers.
    Json lower = blocks;
    lower[0]["z"] = {0.4, 0.5};
    Applied(*editor, {{"op", "set_model"}, {"name", "desk"}, {"blocks", lower}});
    report = Applied(*editor, {{"op", "model"}, {"name", "desk"}});
    EXPECT_NEAR(report["blocks"][0]["z"][1].get<double>(), 0.5, 1e-6);
    Refused(*editor, {{"op", "set_model"}, {"name", "desk"}, {"base", "model"}, {"blocks", blocks}});
    Json crossed = blocks;
    crossed[1]["outline"] = {{0, 0}, {1, 1}, {1, 0}, {0, 1}};
    Refused(*editor, {{"op", "set_model"}, {"name", "desk"}, {"blocks", crossed}});
  }
}

TEST(EditorTest, PartsAreAddedChangedAndRemoved) {
  const test::TemporaryFolder folder;
  const std::string text = "define bot position ( size [0.4 0.4 0.3] )\n";
  const auto editor = OpenedEditor(folder.Write("bot.inc", text));
  Applied(*editor, {{"op", "change_part"},
                    {"model", "bot"},
                    {"part", Json::array()},
                    {"action", "add"},
                    {"kind", "ranger"},
                    {"sensor", {{"fov", "180"}, {"samples", "91"}}}});
  Applied(*editor, {{"op", "change_part"},
                    {"model", "bot"},
                    {"part", Json::array()},
                    {"action", "add"},
                    {"kind", "gripper"},
                    {"properties", {{"pose", "[0.3 0 -0.3 0]"}}}});
  Applied(*editor, {{"op", "change_part"},
                    {"model", "bot"},
                    {"part", {0, 0}},
                    {"action", "set"},
                    {"property", "fov"},
                    {"value", "90"}});
  const Json report = Applied(*editor, {{"op", "model"}, {"name", "bot"}});
  EXPECT_EQ(report["parts"][0]["parts"][0]["properties"]["fov"], "90");
  EXPECT_EQ(report["parts"][1]["type"], "gripper");
  Refused(*editor,
          {{"op", "change_part"}, {"model", "bot"}, {"part", Json::array()}, {"action", "add"}, {"kind", "nose"}});
  Refused(*editor, {{"op", "change_part"}, {"model", "bot"}, {"part", {2}}, {"action", "remove"}});
  Applied(*editor, {{"op", "change_part"}, {"model", "bot"}, {"part", {1}}, {"action", "remove"}});
  Applied(*editor, {{"op", "change_part"}, {"model", "bot"}, {"part", {0}}, {"action", "remove"}});
  EXPECT_EQ(editor->text(), text);
}

TEST(EditorTest, AScenarioMovesWhatItsWorldHas) {
  const test::TemporaryFolder folder;
  folder.Write("things.inc", kThings);
  folder.Write("yard.world", WithPart(kYard, "unit_length \"cm\"   # all of them\n", ""));
  const std::string text =
      "{\n  \"world\": \"yard.world\",\n  \"models\": [\n    {\"model\": \"crate\", \"name\": \"c\", \"pose\": [5, 5, "
      "0]}\n  ]\n}\n";
  const auto editor = OpenedEditor(folder.Write("s.json", text));
  ASSERT_TRUE(editor->SetPose("c", {5.5, 5.0, 0.0, 0.0}).ok());
  EXPECT_EQ(editor->text(), WithPart(text, "[5, 5, 0]", "[5.5, 5, 0]"));
  ASSERT_TRUE(editor->SetPose("r0", {0.0, -5.0, 0.0, std::numbers::pi / 2}).ok());
  ASSERT_TRUE(editor->SetPose("left", {-7.0, 200.0, 0.0, 0.0}).ok());
  ASSERT_TRUE(editor->SetPose("left", {-8.0, 200.0, 0.0, 0.0}).ok());
  const Json scenario = Json::parse(editor->text());
  EXPECT_EQ(scenario["robots"], Json::parse(R"([{"name": "r0", "pose": [0, -5, 90]}])"));
  EXPECT_EQ(scenario["override"].size(), 1U);
  const EditedEntity* const left = editor->world()->Find("left");
  ASSERT_NE(left, nullptr);
  EXPECT_NEAR(PoseInWorld(editor->world()->loaded.world, left->model).x, -8.0, 1e-6);
  // Models of the world and of rules are left out; they have no entry that could be deleted.
  EXPECT_NE(Refused(*editor, {{"op", "copy"}, {"name", "left"}, {"pose", {0, 0, 0, 0}}}).find("yard.world:2"),
            std::string::npos);
  Applied(*editor, {{"op", "delete"}, {"name", "left"}});
  EXPECT_EQ(editor->world()->Find("left"), nullptr);
  EXPECT_EQ(Json::parse(editor->text())["without"], Json::parse(R"(["left"])"));
  Applied(*editor, {{"op", "undo"}});

  const auto set_value = [](const Json& path, const Json& value) {
    return Json{{"op", "set_value"}, {"path", path}, {"value", value}};
  };
  Applied(*editor, set_value({"spawn", 0}, {{"model", "crate"}, {"count", 2}, {"region", {20, 20, 30, 30}}}));
  EXPECT_NE(editor->text().find("\"spawn\": [\n    {"), std::string::npos) << editor->text();
  EXPECT_NE(Refused(*editor, {{"op", "set_pose"}, {"name", "crate0"}, {"pose", {0, 0, 0, 0}}}).find("spawn"),
            std::string::npos);
  Refused(*editor, set_value({"spawn", 0, "count"}, -1));
  Refused(*editor, set_value({"spawn", 5, "count"}, 1));
  Applied(*editor, set_value(Json::array({"seed"}), 7));
  Refused(*editor, set_value(Json::array({"seed"}), "seven"));
  EXPECT_EQ(Applied(*editor, {{"op", "document"}})["members"]["spawn"][0]["count"], 2);
  Applied(*editor, set_value({"spawn", 0}, nullptr));
  // A wall with blocks is a child of the entry.
  const Json blocks = {{{"outline", {{-1, -1}, {1, -1}, {1, 1}}}, {"z", {0, 1}}}};
  const Json added =
      Applied(*editor, {{"op", "add_model"}, {"name", "wall"}, {"pose", {50, 50, 0, 0}}, {"blocks", blocks}});
  EXPECT_NE(editor->world()->Find(added["name"]), nullptr);
  Applied(*editor, {{"op", "save"}});
  EXPECT_TRUE(LoadWorld(folder / "s.json").ok());
}

// A robot of the scenario's world has what an entry of `robots` gives it.
TEST(EditorTest, AScenarioChangesTheRobotsOfItsWorld) {
  const test::TemporaryFolder folder;
  folder.Write(
      "yard.world",
      "position ( name \"rover\" pose [0 0 0 0] ctrl \"wander\" )\nposition ( name \"other\" pose [2 0 0 0] )\n");
  const auto editor = OpenedEditor(folder.Write("s.json", "{\n  \"world\": \"yard.world\"\n}\n"));
  const Json before = Applied(*editor, {{"op", "entity"}, {"name", "rover"}});
  EXPECT_EQ(before["refusal"], "");
  EXPECT_EQ(before["controller"]["own"], false);
  Applied(*editor, {{"op", "set_value"}, {"name", "rover"}, {"path", Json::array({"controller"})}, {"value", "idle"}});
  EXPECT_EQ(Json::parse(editor->text())["robots"], Json::parse(R"([{"name": "rover", "controller": "idle"}])"));
  Applied(*editor, {{"op", "set_property"}, {"name", "other"}, {"property", "color"}, {"value", "\"red\""}});
  Applied(*editor, {{"op", "set_pose"}, {"name", "rover"}, {"pose", {1, 1, 0, 0}}});
  EXPECT_EQ(Json::parse(editor->text())["robots"],
            Json::parse(R"([{"name": "rover", "controller": "idle", "pose": [1, 1, 0]},
                            {"name": "other", "properties": {"color": "red"}}])"));
  EXPECT_EQ(Applied(*editor, {{"op", "entity"}, {"name", "rover"}})["controller"]["own"], true);
  Refused(*editor, {{"op", "rename"}, {"name", "rover"}, {"to", "r2"}});
}

TEST(EditorTest, SeveralEditsAreOneOrNone) {
  const test::TemporaryFolder folder;
  const std::string text =
      "model ( name \"a\" pose [0 0 0 0] )\nmodel ( name \"b\" pose [1 0 0 0] )\nmodel ( name \"c\" pose [2 0 0 0] )\n";
  const auto editor = OpenedEditor(folder.Write("three.world", text));
  const Json move = {{"op", "set_pose"}, {"name", "a"}, {"pose", {0, 1, 0, 0}}};
  const Json other = {{"op", "set_pose"}, {"name", "b"}, {"pose", {1, 1, 0, 0}}};
  Applied(*editor, {{"op", "together"}, {"edits", {move, other}}});
  const Json document = Applied(*editor, {{"op", "document"}});
  EXPECT_EQ(document["undo"], "the move of 2 models");
  EXPECT_EQ(editor->text(), WithPart(WithPart(text, "[0 0 0 0]", "[0 1 0 0]"), "[1 0 0 0]", "[1 1 0 0]"));
  Applied(*editor, {{"op", "undo"}});
  EXPECT_EQ(editor->text(), text);
  EXPECT_EQ(Applied(*editor, {{"op", "document"}})["undo"], "");

  // The refused one takes the others with it, and undone edits can be redone.
  Refused(*editor, {{"op", "together"}, {"edits", {move, {{"op", "delete"}, {"name", "nothing"}}}}});
  EXPECT_EQ(Applied(*editor, {{"op", "document"}})["redo"], "the move of 2 models");
  EXPECT_NEAR(PoseInWorld(editor->world()->loaded.world, editor->world()->Find("a")->model).y, 0.0, 1e-9);
  Refused(*editor, {{"op", "together"}, {"edits", Json::array({Json{{"op", "save"}}})}});
  Refused(*editor, {{"op", "together"}, {"edits", Json::array()}});

  const Json copies = {{{"op", "copy"}, {"name", "a"}, {"pose", {5, 0, 0, 0}}},
                       {{"op", "copy"}, {"name", "b"}, {"pose", {6, 0, 0, 0}}}};
  EXPECT_EQ(Applied(*editor, {{"op", "together"}, {"edits", copies}})["names"], Json({"a1", "b1"}));
  Applied(*editor,
          {{"op", "together"}, {"edits", {{{"op", "delete"}, {"name", "a1"}}, {{"op", "delete"}, {"name", "b1"}}}}});
  EXPECT_EQ(editor->text(), text);
}

// Files that people have written: one robot is moved, and all other bytes stay.
TEST(EditorTest, StageWorldsChangeByOneToken) {
  const std::string source = test::StageWorldsFolder() + "/simple.world";
  if (!std::filesystem::exists(source)) GTEST_SKIP() << "no Stage worlds at " << source;
  const test::TemporaryFolder folder;
  std::filesystem::copy(test::StageWorldsFolder(), folder / "worlds", std::filesystem::copy_options::recursive);
  const auto editor = OpenedEditor(folder / "worlds/simple.world");
  const std::string before = editor->text();
  const auto& entities = editor->world()->entities;
  const auto robot =
      std::find_if(entities.begin(), entities.end(), [](const auto& each) { return each.type == "position"; });
  ASSERT_NE(robot, entities.end());
  Pose pose = PoseInWorld(editor->world()->loaded.world, robot->model);
  pose.x += 0.125;
  ASSERT_TRUE(editor->SetPose(robot->name, pose).ok());
  const std::string after = editor->text();
  std::size_t first = 0;
  while (before[first] == after[first]) ++first;
  std::size_t last = 0;
  while (before[before.size() - 1 - last] == after[after.size() - 1 - last]) ++last;
  const std::string changed = after.substr(first, after.size() - last - first);
  EXPECT_EQ(changed.find_first_not_of("0123456789.-"), std::string::npos) << changed;
  EXPECT_LT(changed.size(), 10U);
}

// Parts of models: their shapes, joints and grippers are edited with few bytes changed.

const char* const kLoader = R"(define loader position
(
  size [0.4 0.4 0.3]  # the base
  ranger( pose [0.1 0 0 0] sensor( fov 180 ) )
  actuator
  (
    name "arm"  type "rotational"  pose [0.1 0 -0.2 90]  # turned
    size [0.3 0.05 0.05]  max_position 90
    actuator( name "slide" pose [0.1 0 0 0] size [0.1 0.1 0.1] axis [1 0 0] start_position 0.75 )
  )
  gripper( pose [0.3 0 -0.3 0] )
)
loader( name "l" )
)";

Json Request(const Json& part, const char* action, const Json& more = Json::object()) {
  Json request = {{"op", "change_part"}, {"model", "loader"}, {"part", part}, {"action", action}};
  request.update(more);
  return request;
}

Json Shape(const Json& part, const Json& shape) {
  return Request(part, "shape", {{"shape", shape}});
}

TEST(ModelPartsTest, PartsAreReportedInTheFrameOfTheModel) {
  const test::TemporaryFolder folder;
  const auto editor = OpenedEditor(folder.Write("loader.world", kLoader));
  const Json report = Applied(*editor, {{"op", "model"}, {"name", "loader"}});
  const Json& slide = report["parts"][1]["parts"][0];
  EXPECT_EQ(slide["name"], "arm.slide");
  EXPECT_NEAR(slide["pose"][0].get<double>(), 0.1, 1e-9);
  EXPECT_NEAR(slide["pose"][1].get<double>(), 0.1, 1e-9);
  EXPECT_NEAR(slide["pose"][2].get<double>(), 0.15, 1e-9);  // on the arm
  EXPECT_NEAR(slide["joint"]["axis"][1].get<double>(), 1.0, 1e-9);
  EXPECT_EQ(slide["joint"]["limits"], Json({0.0, 1.0}));
  EXPECT_NEAR(report["parts"][1]["joint"]["limits"][1].get<double>(), std::numbers::pi / 2, 1e-9);
  const Json& gripper = report["parts"][2];
  EXPECT_NEAR(gripper["gripper"]["paddle"][0].get<double>(), 0.132, 1e-9);
  EXPECT_EQ(gripper["bodies"].size(), 3U);
  EXPECT_TRUE(report["others"].empty());
}

TEST(ModelPartsTest, AShapeChangesTheNumbersThatItConcerns) {
  const test::TemporaryFolder folder;
  const auto editor = OpenedEditor(folder.Write("loader.world", kLoader));
  // The slide's parent is turned: to the left in the model is forward on the arm.
  Applied(*editor, Shape({1, 0}, {{"pose", {0.1, 0.15, 0.15, std::numbers::pi / 2}}}));
  EXPECT_EQ(editor->text(), WithPart(kLoader, "\"slide\" pose [0.1 0 0 0]", "\"slide\" pose [0.15 0 0 0]"));
  EXPECT_EQ(Applied(*editor, {{"op", "undo"}})["label"], "the move of a part of loader");
  EXPECT_EQ(editor->text(), kLoader);
  Applied(*editor, Shape({0}, {{"pose", {0.1, 0.0, 0.4, 0.0}}}));
  EXPECT_EQ(editor->text(), WithPart(kLoader, "ranger( pose [0.1 0 0 0]", "ranger( pose [0.1 0 0.1 0]"));
  Applied(*editor, {{"op", "undo"}});
  // An axis in the frame of the model, and limits below the start.
  Applied(*editor, Shape({1, 0}, {{"axis", {2, 0, 0}}, {"limits", {0, 0.5}}}));
  std::string wanted = WithPart(kLoader, "axis [1 0 0] start_position 0.75", "axis [0 -1 0] start_position 0.5");
  wanted = WithPart(wanted, "start_position 0.5 )", "start_position 0.5 max_position 0.5 )");
  EXPECT_EQ(editor->text(), wanted);
  Applied(*editor, {{"op", "undo"}});
  Applied(*editor, Shape({1}, {{"limits", {-std::numbers::pi / 4, std::numbers::pi / 2}}}));
  EXPECT_EQ(editor->text(), WithPart(kLoader, "max_position 90\n", "max_position 90\n    min_position -45\n"));
  Applied(*editor, {{"op", "undo"}});
  Applied(*editor, Shape({2}, {{"pose", {0.35, 0, 0, 0}}, {"size", {0.3, 0.3, 0.2}}, {"paddle", {0.24, 0.03, 0.08}}}));
  const std::string paddles = "gripper( pose [0.35 0 -0.3 0] size [0.3 0.3 0.2] paddle_size [0.8 0.1 0.4] )";
  EXPECT_EQ(editor->text(), WithPart(kLoader, "gripper( pose [0.3 0 -0.3 0] )", paddles));
  EXPECT_EQ(Applied(*editor, {{"op", "undo"}})["label"], "the paddles of loader");
  EXPECT_FALSE(editor->is_modified());
}

TEST(ModelPartsTest, AGripperIsMadeOfDrawnParts) {
  const test::TemporaryFolder folder;
  const auto editor = OpenedEditor(folder.Write("loader.world", kLoader));
  const auto finger = [](double y, double towards) {
    const Json outline = {{0.4, y}, {0.6, y}, {0.6, y + 0.05}, {0.4, y + 0.05}};
    const Json blocks = {{{"outline", outline}, {"z", {0.05, 0.15}}}};
    return Request({2}, "add",
                   {{"kind", "actuator"},
                    {"name", towards < 0 ? "left" : "right"},
                    {"shape", {{"blocks", blocks}, {"axis", {0, towards, 0}}, {"limits", {0, 0.1}}}}});
  };
  Applied(*editor, finger(0.1, -1));
  Applied(*editor, finger(-0.15, 1));
  EXPECT_NE(Refused(*editor, Request({2}, "roles", {{"roles", {{"left_finger", {2, 0}}}}})).find("without"),
            std::string::npos);
  Applied(*editor, Request({2}, "roles", {{"roles", {{"left_finger", {2, 0}}, {"right_finger", {2, 1}}}}}));
  Applied(*editor, {{"op", "save"}});
  const Result<LoadedWorld> loaded = LoadWorld(folder / "loader.world");
  ASSERT_TRUE(loaded.ok()) << loaded.error().ToString();
  const WorldDescription& world = loaded.value().world;
  ASSERT_EQ(world.grippers.size(), 1U);
  const JointDescription& left = world.joint(world.grippers[0].left);
  EXPECT_EQ(left.name, "gripper:0.left");
  EXPECT_EQ(left.position.max, 0.1);
  EXPECT_NEAR(left.axis_xy.y(), -1.0, 1e-9);
  const Pose X_WL = PoseInWorld(world, left.model);
  EXPECT_NEAR(X_WL.x, 0.5, 1e-6);
  EXPECT_NEAR(X_WL.y, 0.125, 1e-6);
  EXPECT_NEAR(X_WL.z, 0.05, 1e-6);
  const Json report = Applied(*editor, {{"op", "model"}, {"name", "loader"}});
  EXPECT_EQ(report["parts"][2]["gripper"]["left_finger"], Json({2, 0}));
  Applied(*editor, Request({2}, "roles", {{"roles", {{"left_finger", nullptr}, {"right_finger", nullptr}}}}));
  EXPECT_EQ(editor->text().find("left_finger"), std::string::npos);
}

TEST(ModelPartsTest, ChosenPartsWithoutANameGetOne) {
  const test::TemporaryFolder folder;
  const std::string text = R"(define bot position
(
  actuator( axis [0 0 1] noblocks 1 gripper
  (
    actuator( pose [0.1 0.1 0 0] axis [0 -1 0] )
    actuator( pose [0.1 -0.1 0 0] axis [0 1 0] )
  ) )
)
)";
  const auto editor = OpenedEditor(folder.Write("bot.inc", text));
  const Json roles = {{"left_finger", {0, 0, 0}}, {"right_finger", {0, 0, 1}}, {"lift", {0}}};
  Applied(*editor, {{"op", "change_part"}, {"model", "bot"}, {"part", {0, 0}}, {"action", "roles"}, {"roles", roles}});
  for (const char* wanted : {"name \"lift\"", "lift \"lift\"", "left_finger \"left_finger\"", "name \"left_finger\""}) {
    EXPECT_NE(editor->text().find(wanted), std::string::npos) << wanted << " in " << editor->text();
  }
}

TEST(ModelPartsTest, HostileRequestsAreRefused) {
  const test::TemporaryFolder folder;
  const auto editor = OpenedEditor(folder.Write("loader.world", kLoader));
  const Json endless(1000, 0);
  for (const Json& part : {Json(7), Json({-1}), Json({"a"}), Json({9}), Json({1, 0, 0}), endless, Json({0, 0})}) {
    Refused(*editor, Shape(part, {{"pose", {0, 0, 0, 0}}}));
  }
  for (const Json& shape :
       {Json(7), Json::object(), Json{{"pose", {0, 0, 0}}}, Json{{"pose", {1e9, 0, 0, 0}}}, Json{{"size", {0, 1, 1}}},
        Json{{"size", {-1, 1, 1}}}, Json{{"axis", {0, 0, 0}}}, Json{{"limits", {2, 1}}}, Json{{"limits", {0, "a"}}},
        Json{{"nothing", 1}}, Json{{"blocks", 7}}, Json{{"blocks", Json::array()}}}) {
    Refused(*editor, Shape({1, 0}, shape));
  }
  Refused(*editor, Shape({2}, {{"paddle", {1, 1}}}));
  Refused(*editor, Shape(Json::array(), {{"pose", {0, 0, 0, 0}}}));
  for (const Json& roles :
       {Json(7), Json::object(), Json{{"name", {1}}}, Json{{"lift", {9}}}, Json{{"lift", Json::array()}},
        Json{{"left_finger", {1, 0}}, {"right_finger", {1}}}, Json{{"lift", {0}}}}) {
    Refused(*editor, Request({2}, "roles", {{"roles", roles}}));
  }
  Refused(*editor, Request({1}, "roles", {{"roles", {{"lift", {1}}}}}));
  Refused(*editor, Request({0, 0}, "add", {{"kind", "actuator"}}));
  Refused(*editor, Request({}, "add", {{"kind", "model"}, {"name", "a\" ) model("}}));
  Refused(*editor, Request({}, "add", {{"kind", "model"}, {"shape", {{"size", {"a", 0, 0}}}}}));
  EXPECT_FALSE(editor->is_modified());
}

}  // namespace
}  // namespace troupe
