// Parts of models: their shapes, joints and grippers are edited with few bytes changed.
#include "viewer/editor/model_parts.h"

#include <gtest/gtest.h>

#include <numbers>

#include "tests/support/files.h"
#include "tests/unit/editor/edited_world.h"
#include "worldfile/load_world.h"

namespace troupe {
namespace {

using Json = nlohmann::json;

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
  Refused(*editor, Shape({2}, {{"paddle", {1, 1, 1}}}));
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
