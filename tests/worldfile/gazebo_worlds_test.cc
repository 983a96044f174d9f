// Worlds of SDF: shapes, frames, includes, states, what is refused; and runs in them.
#include <cstdlib>

#include "tests/worldfile/gazebo_files.h"
#include "troupe/simulation.h"

namespace troupe {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

class GazeboWorlds : public testing::Test {
 protected:
  LoadedWorld Load(const std::string& content) {
    folder_.Write("w.sdf", SdfWorldText(content));
    return folder_.Load("w.sdf");
  }
  std::string ErrorOf(const std::string& content) {
    folder_.Write("w.sdf", SdfWorldText(content));
    return folder_.ErrorOf("w.sdf");
  }
  static std::vector<std::string> WarningsOf(const LoadedWorld& loaded) {
    std::vector<std::string> warnings;
    for (const Warning& warning : loaded.warnings) warnings.push_back(warning.message);
    return warnings;
  }

  WorldFolder folder_;
};

TEST_F(GazeboWorlds, UprightShapesAreExact) {
  const LoadedWorld loaded =
      Load(SdfModelText("box", "1 2 0.5 0 0 0", SdfBox("2 1 1")) +
           SdfModelText("turned", "5 0 0 0 0 1.5707963", SdfBox("2 1 1"), "0 0 0.5 0 0 0") +
           SdfModelText("lying", "0 5 0.5 1.5707963 0 0", SdfBox("2 1 4")) +
           SdfModelText("post", "-5 0 0.5 0 0 0", "<cylinder><radius>0.5</radius><length>1</length></cylinder>"));
  EXPECT_THAT(loaded.warnings, IsEmpty());
  EXPECT_EQ(loaded.world.name, "w");
  ExpectExtent(ExtentOf(loaded.world, "box"), {0, 1.5, 2, 2.5}, {0, 1});
  ExpectExtent(ExtentOf(loaded.world, "turned"), {4.5, -1, 5.5, 1}, {0, 1});
  ExpectExtent(ExtentOf(loaded.world, "lying"), {-1, 3, 1, 7}, {0, 1});
  // A polygon with the area of the circle.
  ExpectExtent(ExtentOf(loaded.world, "post"), {-5.5, -0.5, -4.5, 0.5}, {0, 1}, 0.0025);
  for (const char* name : {"box", "turned", "lying", "post"}) EXPECT_EQ(ExtentOf(loaded.world, name).blocks, 1U);
}

TEST_F(GazeboWorlds, TiltedAndRoundShapesAreBandsWithABound) {
  const LoadedWorld loaded =
      Load(SdfModelText("ramp", "0 0 0 0 -0.3 0", SdfBox("4 1 0.1")) +
           SdfModelText("ball", "5 5 0.5 0 0 0", "<sphere><radius>0.5</radius></sphere>") +
           SdfModelText("pill", "9 5 1 0 0 0", "<capsule><radius>0.2</radius><length>1</length></capsule>"));
  const Extent ball = ExtentOf(loaded.world, "ball");
  ExpectExtent(ball, {4.5, 4.5, 5.5, 5.5}, {0, 1}, 0.003);
  EXPECT_GT(ball.blocks, 4U);
  ExpectExtent(ExtentOf(loaded.world, "pill"), {8.8, 4.8, 9.2, 5.2}, {0.3, 1.7}, 0.003);
  EXPECT_GT(ExtentOf(loaded.world, "ramp").blocks, 4U);
  EXPECT_THAT(WarningsOf(loaded), Contains(AllOf(HasSubstr("a shape that is not upright in 'ramp'"),
                                                 HasSubstr("m larger than in Gazebo"))));
}

// The bound that a warning states is one: at any height, no point of a block is farther from the tilted box.
TEST_F(GazeboWorlds, BandsContainTheSolid) {
  const LoadedWorld loaded = Load(SdfModelText("slab", "0 0 2 0 0.5 0", SdfBox("2 1 0.4")));
  const ModelDescription& model = loaded.world.models[0];
  const std::vector<Block>& blocks = loaded.world.shape(model.shape).blocks;
  const double c = std::cos(0.5);
  const double s = std::sin(0.5);
  for (int i = 0; i <= 20; ++i) {
    for (int k = 0; k <= 8; ++k) {
      const double x = -0.99 + 1.98 * i / 20;
      const double z = -0.19 + 0.38 * k / 8;
      const Vec2 p(c * x + s * z, 0.1);
      const double height = -s * x + c * z;
      const bool is_inside = std::any_of(blocks.begin(), blocks.end(), [&](const Block& block) {
        return block.z.Contains(height) && troupe::Contains(block.outline, p);
      });
      EXPECT_TRUE(is_inside) << x << " " << z;
    }
  }
}

TEST_F(GazeboWorlds, PolylinesArePrisms) {
  const LoadedWorld loaded =
      Load(SdfModelText("l", "0 0 0 0 0 0",
                        "<polyline><point>0 0</point><point>2 0</point><point>2 1</point><point>1 "
                        "1</point><point>1 3</point><point>0 3</point><height>0.7</height></polyline>"));
  const Extent extent = ExtentOf(loaded.world, "l");
  ExpectExtent(extent, {0, 0, 2, 3}, {0, 0.7});
  EXPECT_EQ(loaded.world.shape(loaded.world.models[0].shape).blocks[0].outline.size(), 6U);
}

TEST_F(GazeboWorlds, FramesAreFollowed) {
  const LoadedWorld loaded = Load(
      "<frame name=\"corner\"><pose>10 0 0 0 0 1.5707963267948966</pose></frame>\n"
      "<model name=\"a\"><static>1</static><pose relative_to=\"corner\">1 0 0 0 0 0</pose>\n"
      "<frame name=\"top\"><pose>0 0 1 0 0 0</pose></frame>\n"
      "<link name=\"base\"><collision name=\"c\"><geometry>" +
      SdfBox("0.2 0.2 0.2") +
      "</geometry></collision></link>\n"
      "<link name=\"arm\"><pose relative_to=\"top\">2 0 0 0 0 0</pose><collision name=\"c\"><geometry>" +
      SdfBox("0.2 0.2 0.2") +
      "</geometry></collision></link></model>\n"
      "<model name=\"b\" placement_frame=\"arm\"><static>1</static><pose relative_to=\"a::arm\">0 0 0 0 0 0</pose>\n"
      "<link name=\"arm\"><pose>1 0 0 0 0 0</pose><collision name=\"c\"><geometry>" +
      SdfBox("0.2 0.2 0.2") + "</geometry></collision></link></model>\n");
  // a is at (10, 1), turned to the left; its arm 2 m ahead, 1 m up; b's link is there, too.
  ExpectExtent(ExtentOf(loaded.world, "a"), {9.9, 0.9, 10.1, 3.1}, {-0.1, 1.1});
  ExpectExtent(ExtentOf(loaded.world, "b"), {9.9, 2.9, 10.1, 3.1}, {0.9, 1.1});
}

TEST_F(GazeboWorlds, AStateReplacesPoses) {
  const LoadedWorld loaded =
      Load(SdfModelText("a", "1 1 0.5 0 0 0", SdfBox("1 1 1")) +
           "<state world_name=\"w\"><model name=\"a\"><pose>4 5 0.5 0 0 0</pose></model></state>");
  ExpectExtent(ExtentOf(loaded.world, "a"), {3.5, 4.5, 4.5, 5.5}, {0, 1});
}

TEST_F(GazeboWorlds, IncludesAreFoundBesideTheWorldAndOnThePath) {
  folder_.Write("models/table/model.config",
                "<model><sdf version=\"1.4\">old.sdf</sdf><sdf version=\"1.5\">new.sdf</sdf></model>");
  folder_.Write("models/table/new.sdf",
                "<sdf version=\"1.5\">" + SdfModelText("table", "0 0 0 0 0 0", SdfBox("1 2 1")) + "</sdf>");
  folder_.Write("elsewhere/chair/model.sdf",
                "<sdf version=\"1.5\">" + SdfModelText("chair", "0 0 0 0 0 0", SdfBox("0.4 0.4 1")) + "</sdf>");
  const std::string content =
      "<include><uri>model://sun</uri></include>"
      "<include><uri>https://fuel.gazebosim.org/1.0/OpenRobotics/models/Ground Plane</uri></include>"
      "<include><uri>https://fuel.gazebosim.org/1.0/OpenRobotics/models/Sun/2</uri></include><include><uri>model://"
      "table</uri><pose>1 0 0.5 0 0 0</pose></include>"
      "<include><uri>model://table</uri><name>second</name><pose>5 0 0.5 0 0 0</pose></include>"
      "<include><uri>model://chair</uri></include><include><uri>model://chair</uri></include>";
  EXPECT_THAT(ErrorOf(content), AllOf(HasSubstr("found no file for 'model://chair' in"), HasSubstr("--model-path")));
  setenv("GZ_SIM_RESOURCE_PATH", folder_.Path("elsewhere").c_str(), 1);
  const LoadedWorld loaded = Load(content);
  unsetenv("GZ_SIM_RESOURCE_PATH");
  ExpectExtent(ExtentOf(loaded.world, "table"), {0.5, -1, 1.5, 1}, {0, 1});
  ExpectExtent(ExtentOf(loaded.world, "second"), {4.5, -1, 5.5, 1}, {0, 1});
  EXPECT_EQ(ExtentOf(loaded.world, "chair").blocks, 1U);
  EXPECT_EQ(ExtentOf(loaded.world, "chair_0").blocks, 1U);
  EXPECT_THAT(loaded.files, SizeIs(4));
}

TEST_F(GazeboWorlds, NestedModelsArePartsOfTheModelAround) {
  const LoadedWorld loaded = Load(
      "<model name=\"shelf\"><static>1</static><pose>10 0 0 0 0 0</pose>" +
      SdfModelText("board", "0 0 1 0 0 0", SdfBox("1 1 0.2")) +
      "<link name=\"post\"><pose relative_to=\"board::link\">0 0 -0.6 0 0 0</pose><collision name=\"c\"><geometry>" +
      SdfBox("0.1 0.1 1") + "</geometry></collision></link></model>");
  EXPECT_THAT(loaded.world.models, SizeIs(1));
  ExpectExtent(ExtentOf(loaded.world, "shelf"), {9.5, -0.5, 10.5, 0.5}, {-0.1, 1.1});
}

TEST_F(GazeboWorlds, DynamicModelsAreObjectsAndVisualsAreSeenOnly) {
  const LoadedWorld loaded = Load(
      "<model name=\"crate\"><pose>3 0 0.25 0 0 0</pose><link name=\"link\"><inertial><mass>7</mass></inertial>"
      "<collision name=\"c\"><geometry>" +
      SdfBox("0.5 0.5 0.5") +
      "</geometry></collision>"
      "<visual name=\"v\"><geometry>" +
      SdfBox("0.5 0.5 0.5") +
      "</geometry><material><diffuse>0 0 1 1</diffuse></material></visual></link></model>"
      "<model name=\"sign\"><static>1</static><pose>6 0 0 0 0 0</pose><link name=\"link\"><visual "
      "name=\"v\"><geometry>" +
      SdfBox("1 1 1") + "</geometry></visual></link></model>");
  ASSERT_THAT(loaded.world.objects, SizeIs(1));
  const ModelDescription& crate = loaded.world.model(loaded.world.objects[0]);
  EXPECT_EQ(crate.name, "crate");
  EXPECT_EQ(crate.power.mass, 7.0);
  EXPECT_EQ(crate.color.b, 1.0);
  EXPECT_TRUE(crate.obstacle_return);
  EXPECT_FALSE(loaded.world.models[1].obstacle_return);
  EXPECT_THAT(WarningsOf(loaded), ElementsAre(HasSubstr("model 'sign' has no collision")));
}

TEST_F(GazeboWorlds, AWorldFileIsToldFromStagesByItsContent) {
  folder_.Write("gazebo.world",
                "<!-- classic -->\n" + SdfWorldText(SdfModelText("a", "0 0 0.5 0 0 0", SdfBox("1 1 1"))));
  EXPECT_THAT(folder_.Load("gazebo.world").world.models, SizeIs(1));
  EXPECT_THAT(folder_.LoadText("model( ) model( )").world.models, SizeIs(2));
}

struct BadSdf {
  std::string content;  // from line 4 of w.sdf on
  std::string message;
};

const BadSdf kBadSdfs[] = {
    {"<model name=\"a\">\n<pose>1 2 nan 0 0 0</pose></model>",
     "w.sdf:5:7: error: found 'nan' in 'pose', expected a number"},
    {"<model name=\"a\"><pose>1 2 3</pose></model>", "w.sdf:4:23: error: found 3 numbers in 'pose', expected 6"},
    {"<model name=\"a\"><pose>1e9 0 0 0 0 0</pose></model>",
     "w.sdf:4:23: error: found '1e9' in 'pose', expected a number up to 1000000"},
    {"<model><link name=\"b\"/></model>",
     "w.sdf:4:1: error: found a model without a name, expected the attribute 'name'"},
    {SdfModelText("a", "0 0 0 0 0 0", SdfBox("1 -1 1")),
     "w.sdf:4:134: error: found a 'box' of 1 x -1 x 1, expected lengths above 0"},
    {SdfModelText("a", "0 0 0 0 0 0", "<sphere><radius>0</radius></sphere>"),
     "w.sdf:4:150: error: found a 'radius' of 0, expected more than 0"},
    {"<model name=\"a\"><pose relative_to=\"b\">0 0 0 0 0 0</pose></model>",
     "w.sdf:4:1: error: found the frame 'b', expected a link, joint, model or frame beside it"},
    {"<frame name=\"f\"><pose relative_to=\"g\">0 0 0 0 0 0</pose></frame>\n"
     "<frame name=\"g\"><pose relative_to=\"f\">0 0 0 0 0 0</pose></frame>\n"
     "<model name=\"a\"><pose relative_to=\"g\">0 0 0 0 0 0</pose></model>",
     "w.sdf:5:1: error: found the frame 'g' relative to itself, expected no cycle"},
    {"<include>\n<uri>file://loop.sdf</uri></include>",
     "loop.sdf:1:36: error: found an include of 'file://loop.sdf' inside itself, expected no include loop"},
    {"<include><uri>https://fuel.example/table</uri></include>",
     "w.sdf:4:15: error: found 'https://fuel.example/table', which is on a server, expected a model of this machine: "
     "one that Gazebo has downloaded, or a folder of its name on --model-path"},
    {SdfModelText("a", "0 0 0 0 0 0", "<mesh><uri>cut.stl</uri></mesh>"),
     "cut.stl: error: found 84 bytes for 10000000 triangles, expected an STL file: 84 bytes and 50 for each triangle, "
     "or a text"},
    {SdfModelText("a", "0 0 0 0 0 0", "<mesh><uri>text.png</uri></mesh>"),
     "text.png: error: found a mesh that ends in '.png', expected .stl, .obj or .dae"},
    {SdfModelText("a", "0 0 0 0 0 0", "<mesh><uri>bad.obj</uri></mesh>"),
     "bad.obj:3:1: error: found the corner '3', expected one of the 2 points so far"},
};

TEST_F(GazeboWorlds, RefusesWhatHasNoMeaning) {
  std::string stl(84, ' ');
  stl.replace(80, 4, std::string("\x80\x96\x98\x00", 4));  // 10,000,000
  folder_.Write("cut.stl", stl);
  folder_.Write("bad.obj", "v 0 0 0\nv 1 0 0\nf 1 2 3\n");
  folder_.Write("loop.sdf", "<sdf><model name=\"a\"><include><uri>file://loop.sdf</uri></include></model></sdf>");
  for (const BadSdf& bad : kBadSdfs) EXPECT_EQ(ErrorOf(bad.content), bad.message);
}

// Each file includes the next one twice: 2^40 models.
TEST_F(GazeboWorlds, IncludesThatDoubleAreAnError) {
  for (int i = 0; i < 40; ++i) {
    const std::string next = "<include><uri>file://" + std::to_string(i + 1) + ".sdf</uri><name>";
    folder_.Write(std::to_string(i) + ".sdf",
                  "<sdf><model name=\"m\">" + next + "a</name></include>" + next + "b</name></include></model></sdf>");
  }
  folder_.Write("40.sdf", "<sdf><model name=\"m\"><link name=\"l\"/></model></sdf>");
  EXPECT_THAT(ErrorOf("<include><uri>file://0.sdf</uri></include>"), HasSubstr("found more than 20000 models"));
}

TEST_F(GazeboWorlds, AScenarioAddsRobotsToAWorldOfSdfAndSpawnsItsModels) {
  folder_.Write("w.sdf", SdfWorldText(SdfModelText("wall", "2 0 0.5 0 0 0", SdfBox("0.2 4 1"))));
  folder_.Write("crate.sdf",
                "<sdf version=\"1.9\"><model name=\"crate\"><link name=\"l\"><pose>0 0 0.1 0 0 0</pose>"
                "<collision name=\"c\"><geometry>" +
                    SdfBox("0.2 0.2 0.2") + "</geometry></collision></link></model></sdf>");
  folder_.Write("s.json", R"({"world": "w.sdf", "models": [{"model": "crate.sdf", "pose": [-1, 1, 0]}],
    "robots": [{"model": "position", "name": "r", "properties": {"size": [0.4, 0.4, 0.3]}, "children": [
      {"model": "ranger", "children": [{"model": "sensor", "properties": {"range": [0, 8]}}]}],
      "controller": {"name": "script", "parameters": {"steps": [{"velocity": [1, 0, 0], "seconds": 10}]}}}]})");
  const LoadedWorld loaded = folder_.Load("s.json");
  EXPECT_THAT(loaded.world.objects, SizeIs(1));
  ExpectExtent(ExtentOf(loaded.world, "crate0"), {-1.1, 0.9, -0.9, 1.1}, {0, 0.2});
}

TEST_F(GazeboWorlds, ModelsOfStageWorldsMayBeFiles) {
  folder_.Write("crate.sdf",
                "<sdf version=\"1.9\">" + SdfModelText("crate", "9 9 9 0 0 0", SdfBox("0.2 0.2 0.2")) + "</sdf>");
  const LoadedWorld loaded = folder_.LoadText(
      "define crate model( model_file \"crate.sdf\" )\ncrate( name \"a\" pose [1 0 0 0] color \"blue\" )\n"
      "model( name \"b\" model_file \"crate.sdf\" pose [2 0 0 0] )\n");
  EXPECT_THAT(loaded.warnings, IsEmpty());
  ExpectExtent(ExtentOf(loaded.world, "a"), {0.9, -0.1, 1.1, 0.1}, {-0.1, 0.1});
  ExpectExtent(ExtentOf(loaded.world, "b"), {1.9, -0.1, 2.1, 0.1}, {-0.1, 0.1});
  EXPECT_EQ(folder_.ErrorOf("w.world"), "");
  folder_.Write("w.world", "model( model_file \"none.sdf\" )\n");
  EXPECT_THAT(folder_.ErrorOf("w.world"), HasSubstr("w.world:1:19: error: cannot read 'none.sdf'"));
}

}  // namespace
}  // namespace troupe
