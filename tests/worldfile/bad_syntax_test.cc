// Texts that the lexer, the parser and the defines refuse.
#include <gtest/gtest.h>

#include "tests/worldfile/world_folder.h"

namespace troupe {
namespace {

struct BadSyntax {
  std::string text;
  std::string where;  // in w.world, unless it names another file
  std::string what;
};

const BadSyntax kBadSyntaxs[] = {
    {"model( pose [0,0,0,0] )", "1:15", "found ',', expected a name, a value or a bracket"},
    {"model { }", "1:7", "found '{', expected a name, a value or a bracket"},
    {"_model( )", "1:1", "found '_', expected a name, a value or a bracket"},
    {"interval_sim 1e2", "1:14", "found '1e2', expected a plain decimal number (without exponent or unit)"},
    {"model( size [1m 1 1] )", "1:14", "found '1m', expected a plain decimal number (without exponent or unit)"},
    {"name \"abc\nmodel( )", "1:6", "found a string that does not end on its line, expected '\"' after 'abc'"},
    {"name \"abc", "1:6", "found a string that does not end on its line, expected '\"' after 'abc'"},
    {"model( )\n\377\376", "2:1", "found '\\xff', expected a name, a value or a bracket"},
    {std::string("model( )\n \000", 11), "2:2", "found '\\x00', expected a name, a value or a bracket"},
    {std::string("# ab\000c\n", 7), "1:5", "found a NUL byte, expected text"},
    {std::string("name \"a\000b\"", 10), "1:8", "found a NUL byte, expected text"},
    {"model( pose[1 2 0 0] )", "1:8", "found 'pose[1', expected a blank before '[', or an index as in 'point[0]'"},
    {"model( block( points 3 point[] [0 0] ) )", "1:24",
     "found 'point[]', expected a blank before '[', or an index as in 'point[0]'"},
    {"model( ) / model( )", "1:10", "found '/', expected a name, a value or a bracket"},
    {"model( ) )", "1:10", "found ')', expected a property or a model"},
    {"model(\n  color \"red\"\n", "3:1", "found the end of the file, expected ')' to close 'model' of line 1"},
    {"model(\n  color\n  size [1 1 1]\n)", "2:8",
     "found the end of the line, expected a number, a string in quotes, '[' or '(' after 'color'"},
    {"model( color\n \"red\" )", "1:13",
     "found the end of the line, expected a number, a string in quotes, '[' or '(' after 'color'"},
    {"model( alwayson true )", "1:17",
     "found 'true', expected a number, a string in quotes, '[' or '(' after 'alwayson'"},
    {"model( 5 )", "1:8", "found number '5', expected a property, a model or ')'"},
    {"model( pose [0 0\n 0 0] )", "1:17",
     "found the end of the line, expected a number, a string in quotes, or ']' on the line of its '['"},
    {"model( pose [0 0 # x\n 0 0] )", "1:21",
     "found the end of the line, expected a number, a string in quotes, or ']' on the line of its '['"},
    {"model( pose [[0 0] 0 0] )", "1:14",
     "found '[', expected a number, a string in quotes, or ']' on the line of its '['"},
    {"model( pose [0 0 0 0 )", "1:22",
     "found ')', expected a number, a string in quotes, or ']' on the line of its '['"},
    {"model( pose [zero 0 0 0] )", "1:14",
     "found 'zero', expected a number, a string in quotes, or ']' on the line of its '['"},
    {"model( ] )", "1:8", "found ']', expected a property, a model or ')'"},
    {"define ( )", "1:8", "found '(', expected the name of a macro after 'define'"},
    {"define robot ( )", "1:14", "found '(', expected the model type that 'robot' is made from"},
    {"define robot position\n", "2:1", "found the end of the file, expected '(' to open the body of macro 'robot'"},
    {"model( define a model( ) )", "1:8", "found 'define' inside 'model', expected it at the top level"},
    {"define robot position(\n color \"red\"\n", "3:1",
     "found the end of the file, expected ')' to close 'robot' of line 1"},
    {"include\n", "1:8", "found the end of the line, expected a file name in quotes after 'include'"},
    {"include 5\n", "1:9", "found number '5', expected a file name in quotes after 'include'"},
    {"include \"missing.inc\"\n", "1:9",
     "cannot read 'missing.inc' (No such file or directory), expected a readable file"},
    {"include \"loop.inc\"\n", "back.inc:1:9",
     "found an include of 'loop.inc' inside itself, expected no include loop"},
    {"\ninclude \"w.world\"\n", "2:9", "found an include of 'w.world' inside itself, expected no include loop"},
    {"\n\ninclude \"bad.inc\"\n", "bad.inc:3:14",
     "found ')', expected a number, a string in quotes, '[' or '(' after 'color'"},
    {"include \"open.inc\"\nmodel( )\n", "open.inc:2:1",
     "found the end of the file, expected ')' to close 'model' of line 1"},
    {"model(\ninclude \"close.inc\"\n)\n", "close.inc:1:1", "found ')', expected a property or a model"},
    {"define a model(\n color \"red\"\n size [1 1 1]\n)\na( size [1 1] )\n", "5:9",
     "found 2 values for 'size', expected 3"},
    {"define model model( )\nmodel( )", "2:1", "found macro 'model' inside itself, expected no loop of defines"},
    {"define a b( )\ndefine b a( )\na( )", "3:1", "found macro 'a' inside itself, expected no loop of defines"},
    {"define a model( a( ) )\na( )", "1:17", "found macro 'a' inside itself, expected no loop of defines"},
};

TEST(BadSyntax, GivesOneLineWithThePlaceAndTheExpectedText) {
  WorldFolder folder;
  for (const BadSyntax& world : kBadSyntaxs) {
    folder.Write("w.world", world.text);
    const std::string file = world.where.find(".inc") == std::string::npos ? "w.world:" : "";
    EXPECT_EQ(folder.ErrorOf("w.world"), file + world.where + ": error: " + world.what) << world.text;
  }
}

std::string Repeat(const std::string& text, int count) {
  std::string result;
  for (int i = 0; i < count; ++i) result += text;
  return result;
}

TEST(BadSyntax, NumbersWithoutEndAreRefused) {
  WorldFolder folder;
  folder.Write("w.world", "interval_sim " + Repeat("9", 400));
  EXPECT_EQ(folder.ErrorOf("w.world"),
            "w.world:1:14: error: found '" + Repeat("9", 40) + "...', expected a number of fewer digits");
}

TEST(BadSyntax, NestingHasALimit) {
  WorldFolder folder;
  folder.Write("w.world", Repeat("model(", 100000));
  EXPECT_EQ(folder.ErrorOf("w.world"),
            "w.world:1:1201: error: found more than 200 models inside each other, expected fewer");
}

// m0 contains two m1, which contain two m2 each, and so on.
std::string MacroTower(int height, int children) {
  std::string text;
  for (int i = 0; i < height; ++i) {
    text +=
        "define m" + std::to_string(i) + " model(" + Repeat(" m" + std::to_string(i + 1) + "( )", children) + " )\n";
  }
  return text + "define m" + std::to_string(height) + " model( )\nm0( )\n";
}

TEST(BadSyntax, NestingByMacrosHasALimit) {
  WorldFolder folder;
  folder.Write("w.world", MacroTower(220, 1));
  EXPECT_EQ(folder.ErrorOf("w.world"),
            "w.world:200:20: error: found more than 200 models inside each other, expected fewer");
}

TEST(BadSyntax, ExpansionOfMacrosHasALimit) {
  WorldFolder folder;
  folder.Write("w.world", MacroTower(40, 2));
  EXPECT_EQ(
      folder.ErrorOf("w.world"),
      "w.world:20:26: error: found more than 4000000 models and properties once all defines are applied, expected "
      "fewer");
}

TEST(BadSyntax, AMacroIsAppliedWithTheDefinesBeforeItsUse) {
  const LoadedWorld loaded = WorldFolder().LoadText(
      "define a model( size [1 1 1] )\na( name \"x\" )\ndefine model position( )\na( name \"y\" pose [3 0 0 0] )\n");
  ASSERT_EQ(loaded.world.robots.size(), 1u);
  EXPECT_EQ(loaded.world.robots[0].name, "y");
}

TEST(BadSyntax, ExpansionOfIncludesHasALimit) {
  WorldFolder folder;
  for (int i = 0; i < 40; ++i) {
    const std::string next = "include \"" + std::to_string(i + 1) + ".inc\"\n";
    folder.Write(std::to_string(i) + ".inc", next + next);
  }
  folder.Write("40.inc", "");
  folder.Write("w.world", "include \"0.inc\"\n");
  EXPECT_THAT(folder.ErrorOf("w.world"), testing::HasSubstr("found too many includes, expected at most 5000 files"));
}

TEST(BadSyntax, MegabytesOfNonsenseAreRefusedAtOnce) {
  WorldFolder folder;
  folder.Write("w.world", std::string(100'000'000, 'x'));
  EXPECT_EQ(folder.ErrorOf("w.world"), "w.world: error: found 100000000 bytes in 'w.world', expected at most 64000000");
}

// Faults of ROS maps.

struct BadMap {
  std::string text;
  std::string where;
  std::string what;
};

const std::string kValidMap =
    "image: map.pgm\nresolution: 0.05\norigin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n";

// The valid map with another line for the key of `line`.
std::string MapWith(const std::string& line) {
  const std::size_t at = kValidMap.find(line.substr(0, line.find(':')));
  return std::string(kValidMap).replace(at, kValidMap.find('\n', at) - at, line);
}
std::string MapWithout(const std::string& key) {
  const std::size_t at = kValidMap.find(key);
  return std::string(kValidMap).erase(at, kValidMap.find('\n', at) + 1 - at);
}

const BadMap kBadMaps[] = {
    {"", "1:1", "found no YAML map, expected keys such as 'image'"},
    {"- 1\n- 2\n", "1:1", "found no YAML map, expected keys such as 'image'"},
    {"image: [1, 2\nresolution: 0.05\n", "2:11",
     "found text that is not YAML (end of sequence flow not found), expected YAML"},
    {"image:\011map.pgm\n\011resolution: 5\n", "2:1",
     "found text that is not YAML (illegal tab when looking for indentation), expected YAML"},
    {"[a, b]: 5\n", "1:1", "found a list as a key, expected a word"},
    {std::string("image: \"a\000\"\n", 12), "1:10", "found a byte that is not text, expected YAML"},
    {MapWithout("image"), "1:1", "found no key 'image' in a ROS map, expected it"},
    {MapWith("image: \"\""), "1:8", "found an empty image name, expected a file"},
    {MapWith("image: [1, 2]"), "1:8", "found a list for 'image', expected a text"},
    {MapWith("image: missing.pgm"), "1:8",
     "bitmap 'missing.pgm': cannot read the image (No such file or directory), expected a readable file"},
    {MapWith("image: text.png"), "1:8",
     "bitmap 'text.png': found an unknown image format, expected PNG, JPEG, BMP or PGM (P2 or P5)"},
    {MapWithout("resolution"), "1:1", "found no key 'resolution' in a ROS map, expected it"},
    {MapWith("resolution: fine"), "2:13", "found 'fine' for 'resolution', expected a number"},
    {MapWith("resolution: 0"), "2:13", "found 0 for 'resolution', expected 1e-06 to 1000000"},
    {MapWith("resolution: -0.05"), "2:13", "found -0.05 for 'resolution', expected 1e-06 to 1000000"},
    {MapWith("resolution: .nan"), "2:13", "found '.nan' for 'resolution', expected a number"},
    {MapWith("resolution: .inf"), "2:13", "found '.inf' for 'resolution', expected a number"},
    {MapWithout("origin"), "1:1", "found no key 'origin' in a ROS map, expected it"},
    {MapWith("origin: [0, 0]"), "3:9", "found no list of three for 'origin', expected [x, y, yaw]"},
    {MapWith("origin: 5"), "3:9", "found no list of three for 'origin', expected [x, y, yaw]"},
    {MapWith("origin: [0, 0, north]"), "3:16", "found 'north' for 'origin', expected a number"},
    {MapWith("origin: [.nan, 0, 0]"), "3:10", "found '.nan' for 'origin', expected a number"},
    {MapWith("origin: [1e300, 0, 0]"), "3:10", "found 1e+300 for 'origin', expected -1000000 to 1000000"},
    {MapWithout("negate"), "1:1", "found no key 'negate' in a ROS map, expected it"},
    {MapWithout("occupied_thresh"), "1:1", "found no key 'occupied_thresh' in a ROS map, expected it"},
    {kValidMap + "mode: fuzzy\n", "7:7", "found mode 'fuzzy', expected trinary, scale or raw"},
    {kValidMap + "wall_height: 0\n", "7:14", "found 0 for 'wall_height', expected 0.001 to 1000000"},
};

TEST(BadMapYaml, GivesOneLineWithThePlaceAndTheExpectedText) {
  WorldFolder folder;
  for (const BadMap& map : kBadMaps) {
    folder.Write("w.yaml", map.text);
    EXPECT_EQ(folder.ErrorOf("w.yaml"), "w.yaml:" + map.where + ": error: " + map.what) << map.text;
  }
}

TEST(BadMapYaml, NestingHasALimit) {
  WorldFolder folder;
  folder.Write("w.yaml", "image: " + std::string(100000, '[') + "\n");
  EXPECT_THAT(folder.ErrorOf("w.yaml"), testing::HasSubstr("found text nested too deeply"));
}

}  // namespace
}  // namespace troupe
