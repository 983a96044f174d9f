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
      "w.world:40:19: error: found more than 4000000 models and properties once all defines are applied, expected "
      "fewer");
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

}  // namespace
}  // namespace troupe
