// Worlds of other formats are edited by a scenario beside them, and models of Gazebo and ROS are in the palette.
#include "viewer/editor/edit_target.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "tests/support/files.h"
#include "tests/unit/viewer/editor/edited_world.h"
#include "worldfile/load_world.h"

namespace troupe {
namespace {

using Json = nlohmann::json;

class EditTargetTest : public testing::Test {
 protected:
  EditTargetTest() {
    const std::string worlds = std::string(std::getenv("TROUPE_SOURCE_DIR")) + "/worlds/";
    for (const char* const file : {"gazebo/yard.sdf", "gazebo/rover.urdf", "sites/hotel.building.yaml"}) {
      const std::filesystem::path from(worlds + file);
      std::filesystem::copy_file(from, folder_ / from.filename().string());
    }
  }

  test::TemporaryFolder folder_;
};

Json RowOf(const Json& palette, const std::string& name) {
  const Json& models = palette["models"];
  const auto found = std::find_if(models.begin(), models.end(), [&](const Json& row) { return row["name"] == name; });
  EXPECT_NE(found, models.end()) << name;
  return found != models.end() ? *found : Json();
}

TEST_F(EditTargetTest, FilesOfTheseLanguagesAreEditedThemselves) {
  for (const char* const name : {"new.world", "new.inc", "new.json"}) {
    const std::string path = folder_ / name;
    EXPECT_EQ(TargetOf(path).value().path, path);
  }
  EXPECT_EQ(TargetOf(folder_ / "new.json").value().kind, EditedKind::kScenario);
  EXPECT_EQ(TargetOf(folder_ / "new.sdf").error().message,
            "found no such file, expected a world, .inc (models) or .json (scenario); .world, .inc and .json may be "
            "new");
  EXPECT_EQ(TargetOf(folder_.Write("a.txt", "")).error().message.find("found a file ending in '.txt'"), 0U);
}

TEST_F(EditTargetTest, AWorldOfAnotherFormatHasAScenarioBesideIt) {
  const EditTarget hotel = TargetOf(folder_ / "hotel.building.yaml").value();
  EXPECT_EQ(hotel.path, folder_ / "hotel.json");
  EXPECT_EQ(Json::parse(hotel.initial), Json({{"world", "hotel.building.yaml"}}));
  const std::string cells = folder_.Write("cells.map", "type octile\nheight 1\nwidth 2\nmap\n..\n");
  EXPECT_EQ(TargetOf(cells).value().path, folder_ / "cells.json");
  const std::string layout =
      folder_.Write("hall.json", R"({"metaInformation": {"lifVersion": "1.0.0"}, "layouts": []})");
  EXPECT_EQ(TargetOf(layout).value().path, folder_ / "hall.scenario.json");
  folder_.Write("yard.json", R"({"world": "hotel.building.yaml"})");
  const Error other = TargetOf(folder_ / "yard.sdf").error();
  EXPECT_EQ(other.where.file, folder_ / "yard.json");
  EXPECT_EQ(other.message.find("found a file that is no scenario of"), 0U) << other.message;
}

TEST_F(EditTargetTest, EditsOfAGazeboWorldAreThoseOfItsScenario) {
  const std::string before = folder_.Read("yard.sdf");
  {
    const auto editor = OpenedEditor(folder_ / "yard.sdf");
    EXPECT_EQ(editor->path(), folder_ / "yard.json");
    ASSERT_NE(editor->world(), nullptr);
    const auto& entities = editor->world()->entities;
    const auto model = std::find_if(entities.begin(), entities.end(), [](const auto& e) { return e.type == "model"; });
    ASSERT_NE(model, entities.end());
    const std::string name = model->name;
    const Status moved = editor->SetPose(name, {3.0, -2.0, 0.0, 0.0});
    ASSERT_TRUE(moved.ok()) << moved.error().ToString();
    ASSERT_TRUE(editor->Add("rover.urdf", {0.5, -4.0, 0.0, 0.0}).ok());
    Applied(*editor, {{"op", "save"}});
  }
  EXPECT_EQ(folder_.Read("yard.sdf"), before);
  const Result<LoadedWorld> loaded = LoadWorld(folder_ / "yard.json");
  ASSERT_TRUE(loaded.ok()) << loaded.error().ToString();
  const auto& robots = loaded.value().world.robots;
  EXPECT_TRUE(std::any_of(robots.begin(), robots.end(), [](const auto& robot) { return robot.name == "rover1"; }));
  EXPECT_EQ(OpenedEditor(folder_ / "yard.sdf")->text(), folder_.Read("yard.json"));
}

TEST_F(EditTargetTest, RobotsOfFilesAreInThePaletteOfScenariosAndWorlds) {
  std::filesystem::create_directory(folder_ / "robots");
  std::filesystem::copy_file(folder_ / "rover.urdf", folder_ / "robots/second.urdf");
  folder_.Write("broken.urdf", "<robot name=\"");
  const auto scenario = OpenedEditor(folder_ / "new.json");
  const Json palette = Applied(*scenario, {{"op", "palette"}});
  const Json rover = RowOf(palette, "rover.urdf");
  EXPECT_EQ(rover["type"], "position");
  EXPECT_EQ(rover["library"], "files");
  EXPECT_FALSE(rover["picture"].empty());
  RowOf(palette, "robots/second.urdf");
  EXPECT_EQ(palette.dump().find("broken.urdf"), std::string::npos);
  EXPECT_EQ(scenario->Add("robots/second.urdf", {1.0, 2.0, 0.0, 0.0}).value(), "second1");
  EXPECT_EQ(scenario->Add("robots/second.urdf", {3.0, 2.0, 0.0, 0.0}).value(), "second2");
  const Json robots = Json::parse(scenario->text())["robots"];
  EXPECT_EQ(robots[0], Json({{"model", "robots/second.urdf"}, {"name", "second1"}, {"pose", {1, 2, 0}}}));

  const auto world = OpenedEditor(folder_ / "new.world");
  EXPECT_EQ(world->Add("rover.urdf", {1.0, 2.0, 0.0, 0.0}).value(), "rover1");
  EXPECT_NE(world->text().find("model_file \"rover.urdf\""), std::string::npos) << world->text();
  ASSERT_EQ(world->world()->loaded.world.robots.size(), 1U);
}

}  // namespace
}  // namespace troupe
