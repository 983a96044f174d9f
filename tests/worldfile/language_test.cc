// The language: comments, line ends, defines, includes, and the warnings about them.
#include "tests/worldfile/world_folder.h"
#include "troupe/pose.h"
#include "worldfile/map/map_yaml.h"
#include "worldfile/stage/stage_world.h"

namespace troupe {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

WorldTree Parse(const std::string& text, const ParseOptions& options = {}) {
  Result<WorldTree> tree = ParseStageText(text, "w.world", options);
  if (!tree.ok()) {
    ADD_FAILURE() << tree.error().ToString();
    return {};
  }
  return std::move(tree).value();
}

double NumberOf(const WorldNode& node, const std::string& name) {
  const Property* property = node.Find(name);
  return property == nullptr ? -1.0 : std::get<Value::Number>(property->value.content).value;
}

TEST(Language, ReadsPropertiesOfTheWorldAnywhere) {
  const WorldTree tree = Parse("a 1 # comment ( [ \"\nmodel( )\nb \"text\" c [1 \"two\" 3] # the end");
  EXPECT_EQ(NumberOf(tree.world, "a"), 1.0);
  EXPECT_EQ(std::get<std::string>(tree.world.Find("b")->value.content), "text");
  EXPECT_EQ(std::get<std::vector<Value::Scalar>>(tree.world.Find("c")->value.content).size(), 3u);
  EXPECT_EQ(tree.world.children.size(), 1u);
}

TEST(Language, NumbersHaveSignsAndPoints) {
  const WorldTree tree = Parse("a -0.5 b +2 c .25 d 3.\n");
  EXPECT_EQ(NumberOf(tree.world, "a"), -0.5);
  EXPECT_EQ(NumberOf(tree.world, "b"), 2.0);
  EXPECT_EQ(NumberOf(tree.world, "c"), 0.25);
  EXPECT_EQ(NumberOf(tree.world, "d"), 3.0);
}

TEST(Language, AllLineEndsCountAsOneLine) {
  for (const char* end : {"\n", "\r", "\r\n", "\n\r"}) {
    const WorldTree tree = Parse(std::string("a 1") + end + end + "b 2" + end);
    EXPECT_EQ(tree.world.Find("b")->where.line, 3);
    EXPECT_EQ(tree.world.Find("b")->where.column, 1);
    EXPECT_EQ(tree.world.Find("b")->value.where.column, 3);
  }
}

TEST(Language, OpeningBracketMayBeOnALaterLine) {
  const WorldTree tree = Parse("define rob position # a robot\n\n(\n)\nrob # here\n\n(\n)\n");
  ASSERT_EQ(tree.world.children.size(), 1u);
  EXPECT_EQ(tree.world.children[0].type, "position");
  EXPECT_THAT(tree.world.children[0].macros, ElementsAre("rob"));
}

TEST(Language, ByteOrderMarkIsSkipped) {
  EXPECT_EQ(NumberOf(Parse("\xef\xbb\xbf"
                           "a 1")
                         .world,
                     "a"),
            1.0);
}

TEST(Language, LongTokensAreRead) {
  const std::string name(5000, 'n');
  EXPECT_EQ(NumberOf(Parse(name + " 1 # " + name).world, name), 1.0);
}

TEST(Language, LaterPropertyReplacesEarlierOne) {
  const WorldTree tree = Parse("define m model( a 1 b 1 c 1 )\ndefine n m( b 2 c 2 )\nn( c 3 c 4 )\n");
  const WorldNode& node = tree.world.children[0];
  EXPECT_EQ(NumberOf(node, "a"), 1.0);
  EXPECT_EQ(NumberOf(node, "b"), 2.0);
  EXPECT_EQ(NumberOf(node, "c"), 4.0);
  EXPECT_EQ(node.properties.size(), 3u);
  EXPECT_THAT(node.macros, ElementsAre("n", "m"));
}

TEST(Language, ChildrenOfMacrosAreKeptAndPrecedeTheInstances) {
  const WorldTree tree = Parse("define m model( model( a 1 ) )\ndefine n m( model( a 2 ) )\nn( model( a 3 ) )\n");
  const WorldNode& node = tree.world.children[0];
  ASSERT_EQ(node.children.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(NumberOf(node.children[i], "a"), static_cast<double>(i + 1));
}

TEST(Language, MacrosMayBeUsedInsideOthersInAnyOrderOfDefines) {
  const WorldTree tree =
      Parse("define rob base( eye( a 1 ) )\ndefine base position( )\ndefine eye ranger( )\nrob( )\n");
  EXPECT_EQ(tree.world.children[0].type, "position");
  EXPECT_EQ(tree.world.children[0].children[0].type, "ranger");
}

TEST(Language, MacroMayContainItsBaseType) {
  const WorldTree tree = Parse("define part model( )\ndefine whole part( part( ) )\nwhole( part( whole( ) ) )\n");
  ASSERT_EQ(tree.world.children[0].children.size(), 2u);
  EXPECT_EQ(tree.world.children[0].children[1].children.size(), 1u);
}

TEST(Language, FirstDefineOfANameCounts) {
  const WorldTree tree = Parse("define m model( a 1 )\ndefine m model( a 2 )\nm( )\n");
  EXPECT_EQ(NumberOf(tree.world.children[0], "a"), 1.0);
  ASSERT_EQ(tree.warnings.size(), 1u);
  EXPECT_EQ(tree.warnings[0].ToString(),
            "w.world:2:8: warning: macro 'm' is already defined at w.world:1; this definition is ignored");
}

TEST(Language, RepeatedPropertyIsNamed) {
  const WorldTree tree = Parse("model( a 1\n a 2 )\n");
  ASSERT_EQ(tree.warnings.size(), 1u);
  EXPECT_EQ(tree.warnings[0].ToString(), "w.world:1:8: warning: property 'a' is given again at line 2, which counts");
}

TEST(Language, IncludesAreSplicedInAnywhere) {
  const std::map<std::string, std::string> files = {{"a.inc", "a 1"}, {"b.inc", "b 2\n"}, {"c.inc", ""}};
  ParseOptions options;
  options.memory_files = &files;
  const WorldTree tree =
      Parse("include \"a.inc\"\nmodel(\n include \"b.inc\"\n c 3\n)\ninclude \"c.inc\"\ninclude \"b.inc\"", options);
  EXPECT_EQ(NumberOf(tree.world, "a"), 1.0);
  EXPECT_EQ(NumberOf(tree.world, "b"), 2.0);
  EXPECT_EQ(NumberOf(tree.world.children[0], "b"), 2.0);
  EXPECT_EQ(NumberOf(tree.world.children[0], "c"), 3.0);
  EXPECT_EQ(tree.world.Find("b")->where.file, "b.inc");
  EXPECT_THAT(tree.files, ElementsAre("w.world", "a.inc", "b.inc", "c.inc", "b.inc"));
}

TEST(Language, RestOfTheLineOfAnIncludeIsIgnored) {
  const std::map<std::string, std::string> files = {{"a.inc", "a 1\n"}};
  ParseOptions options;
  options.memory_files = &files;
  EXPECT_THAT(Parse("include \"a.inc\" # a comment\n", options).warnings, IsEmpty());
  const WorldTree tree = Parse("include \"a.inc\" b 2\nc 3\n", options);
  EXPECT_EQ(tree.world.Find("b"), nullptr);
  EXPECT_EQ(NumberOf(tree.world, "c"), 3.0);
  ASSERT_EQ(tree.warnings.size(), 1u);
  EXPECT_EQ(tree.warnings[0].ToString(), "w.world:1:9: warning: the text after an include on its line is ignored");
}

TEST(Language, IncludesAreFoundBesideTheTopFileThenBesideTheNamingFileThenInStagepath) {
  const WorldFolder folder;
  folder.Write("sub/one.inc", "include \"two.inc\"\ninclude \"three.inc\"\ninclude \"else/four.inc\"\n");
  folder.Write("two.inc", "two 1\n");
  folder.Write("sub/two.inc", "two 2\n");
  folder.Write("sub/three.inc", "three 3\n");
  folder.Write("library/four.inc", "four 4\n");
  folder.Write("w.world", "include \"sub/one.inc\"\n");
  ASSERT_EQ(setenv("STAGEPATH", ("/nowhere:" + folder.Path("library")).c_str(), 1), 0);
  const Result<WorldTree> tree = ParseStageWorld(folder.Path("w.world"));
  unsetenv("STAGEPATH");
  ASSERT_TRUE(tree.ok()) << tree.error().ToString();
  EXPECT_EQ(NumberOf(tree.value().world, "two"), 1.0);
  EXPECT_EQ(NumberOf(tree.value().world, "three"), 3.0);
  EXPECT_EQ(NumberOf(tree.value().world, "four"), 4.0);
}

TEST(Language, CommentThatIsNotUtf8IsAWarning) {
  const WorldTree tree = Parse("a 1\n# S\xe3o Paulo\n");
  ASSERT_EQ(tree.warnings.size(), 1u);
  EXPECT_EQ(tree.warnings[0].ToString(), "w.world:2:4: warning: a comment is not UTF-8");
}

TEST(Language, InstantiateEqualsTheNodeOfAFile) {
  const WorldTree tree = Parse("define rob position( a 1 ranger( ) )\n");
  const Result<WorldNode> made = Instantiate(tree, "rob", {"s.json", 3, 4});
  ASSERT_TRUE(made.ok());
  EXPECT_EQ(made.value().type, "position");
  EXPECT_EQ(NumberOf(made.value(), "a"), 1.0);
  EXPECT_EQ(made.value().children.size(), 1u);
  EXPECT_EQ(made.value().where.line, 3);
  EXPECT_EQ(Instantiate(tree, "position", {}).value().type, "position");
}

// ROS maps.

const char kYaml[] =
    "image: map.pgm\nresolution: 0.5\norigin: [-1.0, 2.0, 0.0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n";

const Shape& ShapeOf(const LoadedWorld& loaded) {
  return loaded.world.shape(loaded.world.models[0].shape);
}

// map.pgm: upper row 0 127 255, lower row 205 0 254.
TEST(MapYaml, IsOneStaticModelWithTheImagesLowerLeftCornerAtTheOrigin) {
  const WorldFolder folder;
  folder.Write("m.yaml", kYaml);
  const LoadedWorld loaded = folder.Load("m.yaml");
  ASSERT_EQ(loaded.world.models.size(), 1u);
  EXPECT_EQ(loaded.world.models[0].name, "map");
  EXPECT_EQ(loaded.world.models[0].X_PM, (Pose{-1, 2, 0, 0}));
  EXPECT_THAT(ShapeOf(loaded).rectangles, ElementsAre(Rectangle{0.5, 0, 1, 0.5}, Rectangle{0, 0.5, 0.5, 1}));
  EXPECT_EQ(ShapeOf(loaded).rectangles_z, (ZRange{0.0, 2.0}));
  EXPECT_EQ(loaded.map_width, 3);
  EXPECT_THAT(loaded.files, ElementsAre(folder.Path("m.yaml"), folder.Path("map.pgm")));
  EXPECT_THAT(loaded.warnings, IsEmpty());
}

TEST(MapYaml, ThresholdIsAProbability) {
  const WorldFolder folder;
  folder.Write("m.yaml", std::string(kYaml) + "mode: scale\nwall_height: 1\nfrobnicate: 3\n");
  LoadedWorld loaded = folder.Load("m.yaml");
  EXPECT_EQ(ShapeOf(loaded).rectangles.size(), 2u);
  EXPECT_EQ(ShapeOf(loaded).rectangles_z, (ZRange{0.0, 1.0}));
  ASSERT_EQ(loaded.warnings.size(), 1u);
  EXPECT_EQ(loaded.warnings[0].message, "key 'frobnicate' of a ROS map has no effect");
  EXPECT_EQ(loaded.warnings[0].where.line, 9);

  std::string yaml = kYaml;
  yaml.replace(yaml.find("0.65"), 4, "0.50");  // 127 is a probability of 0.502
  folder.Write("m.yaml", yaml);
  loaded = folder.Load("m.yaml");
  EXPECT_THAT(ShapeOf(loaded).rectangles, ElementsAre(Rectangle{0.5, 0, 1, 0.5}, Rectangle{0, 0.5, 1, 1}));
}

// The warnings of the map with `from` replaced by `to`, which has `occupied` rectangles.
void ExpectWarnings(const std::string& from, const std::string& to, const std::vector<std::string>& messages,
                    std::size_t occupied = 2) {
  SCOPED_TRACE(to);
  const WorldFolder folder;
  std::string yaml = kYaml;
  yaml.replace(yaml.find(from), from.size(), to);
  folder.Write("m.yaml", yaml);
  const LoadedWorld loaded = folder.Load("m.yaml");
  std::vector<std::string> found;
  for (const Warning& warning : loaded.warnings) found.push_back(warning.message);
  EXPECT_EQ(found, messages);
  EXPECT_EQ(ShapeOf(loaded).rectangles.size(), occupied);
}

TEST(MapYaml, WhatMapServerReadsLoadsWithAWarning) {
  ExpectWarnings("free_thresh: 0.196", "free_thresh: 0.9",
                 {"found a free_thresh of 0.9 above the occupied_thresh of 0.65, expected at most that; pixels from "
                  "occupied_thresh on are occupied, as in map_server"});
  ExpectWarnings("free_thresh: 0.196\n", "", {"found no key 'free_thresh', expected it; it has no effect here"});
  ExpectWarnings("occupied_thresh: 0.65", "occupied_thresh: 65",
                 {"found 65 for 'occupied_thresh', expected 0 to 1; it is compared as it is"}, 0);
  ExpectWarnings("negate: 0", "negate: 2", {"found '2' for 'negate', expected 0 or 1; 1 is used"});
  ExpectWarnings("negate: 0", "negate: False", {});
  ExpectWarnings("negate: 0", "negate: 0\nimage: other.pgm",
                 {"found key 'image' twice, expected it once; the first one counts"});
  ExpectWarnings("0.0]", "0.0, 0.0]", {"found 4 values for 'origin', expected [x, y, yaw]; the rest is ignored"});
  ExpectWarnings("0.0]", "-nan]", {"found '-nan' for the yaw of 'origin', expected a number; 0 is used"});
  ExpectWarnings("resolution: 0.5", "resolution: +0.5\nmode: Trinary", {});
  ExpectWarnings(
      "image:", "# K\374che\nimage:", {"found a byte that is not UTF-8, expected UTF-8 text; it is left out"});
}

TEST(MapYaml, AnImageOfAnotherMachineIsLookedForBesideTheFile) {
  const WorldFolder folder;
  std::string yaml = kYaml;
  yaml.replace(yaml.find("map.pgm"), 7, "/home/of/another/map.pgm");
  folder.Write("m.yaml", yaml);
  const LoadedWorld loaded = folder.Load("m.yaml");
  EXPECT_EQ(ShapeOf(loaded).rectangles.size(), 2u);
  ASSERT_EQ(loaded.warnings.size(), 1u);
  EXPECT_EQ(
      loaded.warnings[0].message,
      "found no image '/home/of/another/map.pgm'; the one beside this file is used, '" + folder.Path("map.pgm") + "'");
  EXPECT_EQ(loaded.warnings[0].where.line, 1);
  yaml.replace(yaml.find("map.pgm"), 7, "mop.pgm");
  folder.Write("m.yaml", yaml);
  EXPECT_THAT(folder.ErrorOf("m.yaml"), testing::HasSubstr("bitmap '/home/of/another/mop.pgm': cannot read the image"));
}

TEST(MapYaml, KeepsItsGrid) {
  const WorldFolder folder;
  folder.Write("m.yaml", kYaml);
  EXPECT_EQ(folder.Load("m.yaml").world.models[0].map, (MapGrid{3, 2, 0.5}));
  EXPECT_EQ(folder.LoadText("model( map_yaml \"m.yaml\" origin [1 0 0 0] )\nmodel( )").world.models[0].map, MapGrid());
  EXPECT_EQ(folder.LoadText("model( )").world.models[0].map, MapGrid());
}

TEST(MapYaml, NegateTurnsBlackAndWhiteRound) {
  const WorldFolder folder;
  std::string yaml = kYaml;
  yaml.replace(yaml.find("negate: 0"), 9, "negate: 1");
  folder.Write("m.yaml", yaml);
  EXPECT_THAT(ShapeOf(folder.Load("m.yaml")).rectangles,
              ElementsAre(Rectangle{0, 0, 0.5, 0.5}, Rectangle{1, 0, 1.5, 1}));
}

TEST(MapYaml, RawValuesArePercentAndAbove100Unknown) {
  const WorldFolder folder;
  folder.Write("map.pgm", "P2 4 1 255\n0 64 65 100\n");
  folder.Write("m.yaml", std::string(kYaml) + "mode: raw\n");
  EXPECT_THAT(ShapeOf(folder.Load("m.yaml")).rectangles, ElementsAre(Rectangle{1, 0, 2, 0.5}));
}

TEST(MapYaml, OriginMayBeTurned) {
  const WorldFolder folder;
  std::string yaml = kYaml;
  yaml.replace(yaml.find("2.0, 0.0"), 8, "2.0, 0.5");
  folder.Write("m.yaml", yaml);
  EXPECT_EQ(folder.Load("m.yaml").world.models[0].X_PM, (Pose{-1, 2, 0, 0.5}));
}

TEST(MapYaml, MayBeNamedInAWorldFile) {
  const WorldFolder folder;
  folder.Write("maps/m.yaml", kYaml);
  folder.Write("maps/map.pgm", "P2 1 1 255\n0\n");
  const LoadedWorld loaded = folder.LoadText("model( map_yaml \"maps/m.yaml\" )\nposition( )\n");
  EXPECT_EQ(loaded.world.models[0].X_PM, (Pose{-1, 2, 0, 0}));
  EXPECT_THAT(ShapeOf(loaded).rectangles, ElementsAre(Rectangle{0, 0, 0.5, 0.5}));
  EXPECT_EQ(loaded.world.robots.size(), 1u);
}

}  // namespace
}  // namespace troupe
