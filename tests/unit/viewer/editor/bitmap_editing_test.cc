// Walls are drawn into images: in memory, undone with the text, and written beside the old files.
#include <gtest/gtest.h>

#include <algorithm>

#include "common/image/image_file.h"
#include "tests/support/files.h"
#include "tests/support/values.h"
#include "tests/unit/viewer/editor/edited_world.h"
#include "worldfile/load_world.h"

namespace troupe {
namespace {

using Json = nlohmann::json;

// A plan of 40 x 20 pixels, with a frame of one pixel that leaves two columns free at the right.
std::string FloorPlan() {
  GreyImage image{40, 20, std::vector<std::uint8_t>(40U * 20U, 255)};
  for (std::size_t y = 0; y < 20; ++y) {
    for (std::size_t x = 0; x < 38; ++x) {
      if (x == 0 || y == 0 || x == 37 || y == 19) image.values[y * 40 + x] = 100;
    }
  }
  return EncodeGreyPng(image).value();
}

const char* const kHouse = R"(model( name "house"  size [3.8 2 1]  bitmap "plan.png" )  # two rooms
position( name "r" pose [0 0 0 0] size [0.3 0.3 0.3] )
)";

Json Stroke(const std::string& tool, const Json& points, int width = 1, bool erase = false) {
  return {{"op", "draw_bitmap"}, {"name", "house"}, {"tool", tool},
          {"points", points},    {"width", width},  {"erase", erase}};
}

// The rectangles of the model's body in the world, as x0, y0, x1, y1.
std::vector<std::array<double, 4>> WallsOf(const WorldDescription& world, const std::string& name) {
  std::vector<std::array<double, 4>> walls;
  for (const ModelDescription& model : world.models) {
    if (model.name != name) continue;
    for (const Rectangle& r : world.shape(model.shape).rectangles) {
      walls.push_back({model.X_PM.x + r.min_x, model.X_PM.y + r.min_y, model.X_PM.x + r.max_x, model.X_PM.y + r.max_y});
    }
  }
  return walls;
}

bool IsWallAt(const WorldDescription& world, double x, double y, const std::string& name = "house") {
  const auto walls = WallsOf(world, name);
  return std::any_of(walls.begin(), walls.end(),
                     [&](const auto& r) { return r[0] < x && x < r[2] && r[1] < y && y < r[3]; });
}

struct House {
  test::TemporaryFolder folder;
  std::unique_ptr<Editor> editor;

  House() {
    folder.Write("plan.png", FloorPlan());
    editor = OpenedEditor(folder.Write("house.world", kHouse));
  }
  const WorldDescription& world() const { return editor->world()->loaded.world; }
};

TEST(BitmapEditingTest, WallsAreDrawnInMemoryAndUndone) {
  House house;
  const std::string image = house.folder.Read("plan.png");
  EXPECT_FALSE(IsWallAt(house.world(), 0.05, 0.0));
  Applied(*house.editor, Stroke("line", {{19, 0}, {19, 19}}));
  EXPECT_TRUE(IsWallAt(house.world(), 0.05, 0.0));
  EXPECT_EQ(house.editor->text(), kHouse);
  EXPECT_TRUE(house.editor->is_modified());
  EXPECT_EQ(house.folder.Read("plan.png"), image);
  // A door in it.
  Applied(*house.editor, Stroke("filled", {{19, 8}, {19, 11}}, 1, true));
  EXPECT_FALSE(IsWallAt(house.world(), 0.05, 0.0));
  EXPECT_TRUE(IsWallAt(house.world(), 0.05, 0.5));
  EXPECT_EQ(Applied(*house.editor, Stroke("filled", {{19, 8}, {19, 11}}, 1, true))["changed"], false);
  EXPECT_EQ(Applied(*house.editor, {{"op", "undo"}})["label"], "the erasure in plan.png");
  EXPECT_TRUE(IsWallAt(house.world(), 0.05, 0.0));
  Applied(*house.editor, {{"op", "undo"}});
  EXPECT_FALSE(house.editor->is_modified());
  EXPECT_FALSE(IsWallAt(house.world(), 0.05, 0.5));
  Applied(*house.editor, {{"op", "redo"}});
  Applied(*house.editor, {{"op", "save"}});
  EXPECT_FALSE(house.editor->is_modified());
  EXPECT_EQ(house.folder.Read("house.world"), kHouse);
  EXPECT_TRUE(IsWallAt(test::ValueOf(LoadWorld(house.folder / "house.world")).world, 0.05, 0.0));
  EXPECT_EQ(house.folder.size(), 2U);
  // Beyond the save, and back on the disk.
  Applied(*house.editor, {{"op", "undo"}});
  EXPECT_TRUE(house.editor->is_modified());
  Applied(*house.editor, {{"op", "save"}});
  EXPECT_EQ(ReadGreyPng(house.folder / "plan.png").value().values[5 * 40 + 37], 100);
  EXPECT_EQ(ReadGreyPng(house.folder / "plan.png").value().values[5 * 40 + 19], 255);
}

TEST(BitmapEditingTest, OtherWallsStayWhereTheyAre) {
  House house;
  const Json before = Applied(*house.editor, {{"op", "bitmaps"}})["bitmaps"][0];
  EXPECT_EQ(before["width"], 40);
  EXPECT_NEAR(before["pixel"][0].get<double>(), 0.1, 1e-9);
  EXPECT_NEAR(before["corner"][0].get<double>(), -1.9, 1e-9);
  EXPECT_NEAR(before["corner"][1].get<double>(), 1.0, 1e-9);
  // The box around the occupied pixels grows to the right, and shrinks at the left.
  Applied(*house.editor, Stroke("line", {{39, 5}, {39, 5}}));
  EXPECT_NE(house.editor->text().find("size [4 2 1]"), std::string::npos) << house.editor->text();
  EXPECT_NE(house.editor->text().find("origin [0.1 0 0 0] )  # two rooms"), std::string::npos);
  EXPECT_TRUE(IsWallAt(house.world(), -1.85, 0.0));
  EXPECT_TRUE(IsWallAt(house.world(), 1.85, 0.0));
  EXPECT_TRUE(IsWallAt(house.world(), 2.05, 0.45));
  Applied(*house.editor, Stroke("filled", {{0, 0}, {10, 19}}, 1, true));
  EXPECT_FALSE(IsWallAt(house.world(), -1.85, 0.0));
  EXPECT_TRUE(IsWallAt(house.world(), 1.85, 0.0));
  EXPECT_TRUE(IsWallAt(house.world(), 2.05, 0.45));
  Json after = Applied(*house.editor, {{"op", "bitmaps"}})["bitmaps"][0];
  for (int i = 0; i < 2; ++i) {
    EXPECT_NEAR(after["corner"][i].get<double>(), before["corner"][i].get<double>(), 1e-5);
    EXPECT_NEAR(after["pixel"][i].get<double>(), before["pixel"][i].get<double>(), 1e-6);
  }
  // Nothing is left, and the scale is that of the whole image.
  Applied(*house.editor, Stroke("filled", {{0, 0}, {39, 19}}, 1, true));
  after = Applied(*house.editor, {{"op", "bitmaps"}})["bitmaps"][0];
  EXPECT_NEAR(after["pixel"][0].get<double>(), 0.1, 1e-6);
  EXPECT_NEAR(after["corner"][0].get<double>(), -1.9, 1e-5);
  Applied(*house.editor, Stroke("line", {{19, 10}, {19, 10}}));
  EXPECT_TRUE(IsWallAt(house.world(), 0.05, -0.05));
}

TEST(BitmapEditingTest, ANewBitmapIsWrittenBesideTheFile) {
  House house;
  const Json create = {
      {"op", "create_bitmap"}, {"file", "yard.png"}, {"size", {6, 4, 1}}, {"pixel", 0.05}, {"pose", {10, 0, 0, 0}}};
  const std::string name = Applied(*house.editor, create)["name"];
  EXPECT_EQ(name, "yard1");
  Json stroke = Stroke("frame", {{0, 0}, {119, 79}}, 2);
  stroke["name"] = name;
  Applied(*house.editor, stroke);
  EXPECT_TRUE(IsWallAt(house.world(), 7.05, 0.0, name));
  EXPECT_FALSE(IsWallAt(house.world(), 7.15, 0.0, name));
  EXPECT_EQ(house.folder.size(), 2U);
  EXPECT_NE(Refused(*house.editor, create).find("in use"), std::string::npos);
  Applied(*house.editor, {{"op", "save"}});
  const GreyImage written = ReadGreyPng(house.folder / "yard.png").value();
  EXPECT_EQ(written.width, 120);
  EXPECT_EQ(written.height, 80);
  EXPECT_EQ(std::count(written.values.begin(), written.values.end(), 0), 2 * 2 * (120 + 80) - 16);
  // Without the model nothing of it is written.
  Applied(*house.editor, {{"op", "undo"}});
  Applied(*house.editor, {{"op", "undo"}});
  EXPECT_EQ(house.editor->text(), kHouse);
  Json other = create;
  other["file"] = "other.png";
  Applied(*house.editor, other);
  EXPECT_TRUE(house.editor->Remove("other1").ok());
  Applied(*house.editor, {{"op", "save"}});
  EXPECT_FALSE(std::filesystem::exists(house.folder / "other.png"));
}

TEST(BitmapEditingTest, AnImageThatHasChangedOnDiskIsKept) {
  House house;
  Applied(*house.editor, Stroke("line", {{19, 0}, {19, 19}}));
  house.folder.Write("plan.png", EncodeGreyPng({2, 1, {0, 0}}).value());
  const Result<Json> refused = Executed(*house.editor, {{"op", "save"}});
  ASSERT_FALSE(refused.ok());
  EXPECT_EQ(refused.error().code, ErrorCode::kNoRoom);
  EXPECT_NE(refused.error().ToString().find("plan.png"), std::string::npos);
  EXPECT_EQ(ReadGreyPng(house.folder / "plan.png").value().width, 2);
  Applied(*house.editor, {{"op", "reload"}});
  EXPECT_EQ(WallsOf(house.world(), "house").size(), 1U);
  EXPECT_FALSE(house.editor->is_modified());
  Applied(*house.editor, {{"op", "undo"}});
  EXPECT_TRUE(IsWallAt(house.world(), 0.05, 0.0));
  Applied(*house.editor, {{"op", "save"}});
  EXPECT_EQ(ReadGreyPng(house.folder / "plan.png").value().width, 40);
}

TEST(BitmapEditingTest, ForeignImagesAreRefusedWithTheReason) {
  const test::TemporaryFolder folder;
  const test::TemporaryFolder elsewhere;
  folder.Write("plan.png", FloorPlan());
  elsewhere.Write("far.png", FloorPlan());
  folder.Write("plan.pgm", "P2\n2 1\n255\n0 255\n");
  folder.Write("fake.png", "P2\n2 1\n255\n0 255\n");
  folder.Write("part.inc", "define hall model( bitmap \"plan.png\" size [4 2 1] )\nhall( name \"included\" )\n");
  const auto model = [](const std::string& name, const std::string& file, const std::string& more = "") {
    return "model( name \"" + name + "\" size [4 2 1] bitmap \"" + file + "\" " + more + ")\n";
  };
  const std::string text =
      "include \"part.inc\"\n" + model("pgm", "plan.pgm") + model("fake", "fake.png") +
      model("blocks", "plan.png", "block( points 3 point[0] [0 0] point[1] [1 0] point[2] [1 1] )") +
      model("far", elsewhere / "far.png") + "model( name \"box\" )\n" + model("house", "plan.png");
  const auto editor = OpenedEditor(folder.Write("all.world", text));
  const auto refusal = [&](const std::string& name) {
    Json stroke = Stroke("line", {{5, 5}, {9, 9}});
    stroke["name"] = name;
    return Refused(*editor, stroke);
  };
  EXPECT_NE(refusal("included").find("part.inc:2"), std::string::npos);
  EXPECT_NE(refusal("pgm").find(".png"), std::string::npos);
  EXPECT_NE(refusal("fake").find("another format"), std::string::npos);
  EXPECT_NE(refusal("blocks").find("blocks"), std::string::npos);
  EXPECT_NE(refusal("box").find("no bitmap"), std::string::npos);
  EXPECT_NE(refusal("nothing").find("nothing"), std::string::npos);
  // Within the box the included hall shares the new wall; beyond it that would have another scale.
  Applied(*editor, Stroke("line", {{5, 5}, {9, 9}}));
  EXPECT_NE(Refused(*editor, Stroke("line", {{39, 5}, {39, 5}})).find("included"), std::string::npos);
  // A file that was named at first may be written, one that is named later may not.
  Json far = Stroke("line", {{5, 5}, {9, 9}});
  far["name"] = "far";
  Applied(*editor, far);
  elsewhere.Write("later.png", FloorPlan());
  Applied(*editor, {{"op", "set_property"},
                    {"name", "far"},
                    {"property", "bitmap"},
                    {"value", '"' + (elsewhere / "later.png") + '"'}});
  EXPECT_NE(Refused(*editor, far).find("neither"), std::string::npos);
}

TEST(BitmapEditingTest, HostileRequestsAreRefused) {
  House house;
  Editor& editor = *house.editor;
  const Json point = {5, 5};
  for (const Json& points :
       {Json(7), Json::array(), Json({5, 5}), Json({{5}}), Json({{5, 5, 5}}), Json({{1.5, 2}}), Json({{"a", 1}}),
        Json({{1e9, 1}}), Json({{-2000000000, 1}}), Json(6000, point), Json({{18446744073709551615U, 0}})}) {
    Refused(editor, Stroke("line", points));
  }
  for (const int width : {0, -1, 501, 2000000000}) Refused(editor, Stroke("line", {point, point}, width));
  Json zigzag = Json::array();
  for (int i = 0; i < 5000; ++i) zigzag.push_back({i % 2 == 0 ? -100000 : 100000, i});
  Refused(editor, Stroke("line", zigzag, 500));
  Refused(editor, Stroke("line", zigzag, 5));
  Refused(editor, Stroke("frame", {point}));
  Refused(editor, Stroke("circle", {point, point}));
  Refused(editor, {{"op", "draw_bitmap"}, {"name", "house"}});
  EXPECT_TRUE(Executed(editor, Stroke("filled", {{-100000, -100000}, {100000, 100000}}, 500)).ok());
  Applied(editor, {{"op", "undo"}});
  const auto create = [](const Json& file, const Json& size = {6, 4, 1}, const Json& pixel = 0.05) {
    return Json{{"op", "create_bitmap"}, {"file", file}, {"size", size}, {"pixel", pixel}, {"pose", {0, 0, 0, 0}}};
  };
  for (const char* file : {"../a.png", "/tmp/a.png", "a/b.png", "a.pgm", ".png", ".a.png", "a\n.png", "", "a b.png",
                           "plan.png", "a\".png"}) {
    Refused(editor, create(file));
  }
  Refused(editor, create(7));
  for (const Json& size :
       {Json(7), Json({1, 1}), Json({-1, 1, 1}), Json({1, 1, 0}), Json({1e6, 1e6, 1}), Json({0, 0, 1})}) {
    Refused(editor, create("a.png", size));
  }
  for (const Json& pixel : {Json(0), Json(-1), Json(1e-9), Json("a"), Json(nullptr)}) {
    Refused(editor, create("a.png", {6, 4, 1}, pixel));
  }
  EXPECT_FALSE(editor.is_modified());
  EXPECT_EQ(house.folder.size(), 2U);
}

TEST(BitmapEditingTest, TheHistoryOfPixelsIsBounded) {
  House house;
  const Json create = {
      {"op", "create_bitmap"}, {"file", "yard.png"}, {"size", {100, 100, 1}}, {"pixel", 0.05}, {"pose", {0, 0, 0, 0}}};
  Applied(*house.editor, create);
  // Each stroke changes all of its 4 MB.
  for (int i = 0; i < 20; ++i) {
    Json stroke = Stroke("filled", {{0, 0}, {1999, 1999}}, 1, i % 2 == 1);
    stroke["name"] = "yard1";
    Applied(*house.editor, stroke);
  }
  int undone = 0;
  for (; Executed(*house.editor, {{"op", "undo"}}).ok(); ++undone) EXPECT_LT(undone, 20);
  EXPECT_GT(undone, 10);
  EXPECT_LT(undone, 17);
}

}  // namespace
}  // namespace troupe
