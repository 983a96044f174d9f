// Texts that the lexer, the parser and the defines refuse.
#include <gtest/gtest.h>

#include "tests/worldfile/world_folder.h"

namespace troupe {
namespace {

struct BadSyntax {
  const char* name;
  std::string text;
  const char* message;
};

const BadSyntax kBadSyntaxs[] = {
    {"comma", "model( pose [0,0,0,0] )", "w.world:1:15: error: found ',', expected a name, a value or a bracket"},
    {"braces", "model { }", "w.world:1:7: error: found '{', expected a name, a value or a bracket"},
    {"underscore at the start of a word", "_model( )",
     "w.world:1:1: error: found '_', expected a name, a value or a bracket"},
    {"exponent", "interval_sim 1e2",
     "w.world:1:14: error: found '1e2', expected a plain decimal number (without exponent or unit)"},
    {"number with a unit", "model( size [1m 1 1] )",
     "w.world:1:14: error: found '1m', expected a plain decimal number (without exponent or unit)"},
    {"string without end",
     "name \"abc\n"
     "model( )",
     "w.world:1:6: error: found a string that does not end on its line, expected '\"' after 'abc'"},
    {"string without end at the end of the file", "name \"abc",
     "w.world:1:6: error: found a string that does not end on its line, expected '\"' after 'abc'"},
    {"bytes that are not UTF-8 outside",
     "model( )\n"
     "\377\376",
     "w.world:2:1: error: found '\\xff', expected a name, a value or a bracket"},
    {"NUL byte",
     std::string("model( )\n"
                 " \000",
                 11),
     "w.world:2:2: error: found '\\x00', expected a name, a value or a bracket"},
    {"NUL byte in a comment", std::string("# ab\000c\n", 7), "w.world:1:5: error: found a NUL byte, expected text"},
    {"NUL byte in a string", std::string("name \"a\000b\"", 10), "w.world:1:8: error: found a NUL byte, expected text"},
    {"tuple without a blank before it", "model( pose[1 2 0 0] )",
     "w.world:1:8: error: found 'pose[1', expected a blank before '[', or an index as in 'point[0]'"},
    {"empty index", "model( block( points 3 point[] [0 0] ) )",
     "w.world:1:24: error: found 'point[]', expected a blank before '[', or an index as in 'point[0]'"},
    {"slash", "model( ) / model( )", "w.world:1:10: error: found '/', expected a name, a value or a bracket"},
    {"closing bracket too many", "model( ) )", "w.world:1:10: error: found ')', expected a property or a model"},
    {"closing bracket missing",
     "model(\n"
     "  color \"red\"\n",
     "w.world:3:1: error: found the end of the file, expected ')' to close 'model' of line 1"},
    {"property without value",
     "model(\n"
     "  color\n"
     "  size [1 1 1]\n"
     ")",
     "w.world:2:8: error: found the end of the line, expected a number, a string in quotes, '[' or '(' after 'color'"},
    {"value on the next line",
     "model( color\n"
     " \"red\" )",
     "w.world:1:13: error: found the end of the line, expected a number, a string in quotes, '[' or '(' after 'color'"},
    {"bare word as value", "model( alwayson true )",
     "w.world:1:17: error: found 'true', expected a number, a string in quotes, '[' or '(' after 'alwayson'"},
    {"value without property", "model( 5 )",
     "w.world:1:8: error: found number '5', expected a property, a model or ')'"},
    {"tuple over two lines",
     "model( pose [0 0\n"
     " 0 0] )",
     "w.world:1:17: error: found the end of the line, expected a number, a string in quotes, or ']' on the line of its "
     "'['"},
    {"tuple with a comment",
     "model( pose [0 0 # x\n"
     " 0 0] )",
     "w.world:1:21: error: found the end of the line, expected a number, a string in quotes, or ']' on the line of its "
     "'['"},
    {"nested tuples", "model( pose [[0 0] 0 0] )",
     "w.world:1:14: error: found '[', expected a number, a string in quotes, or ']' on the line of its '['"},
    {"tuple without end", "model( pose [0 0 0 0 )",
     "w.world:1:22: error: found ')', expected a number, a string in quotes, or ']' on the line of its '['"},
    {"word in a tuple", "model( pose [zero 0 0 0] )",
     "w.world:1:14: error: found 'zero', expected a number, a string in quotes, or ']' on the line of its '['"},
    {"closing tuple alone", "model( ] )", "w.world:1:8: error: found ']', expected a property, a model or ')'"},
    {"define without a name", "define ( )",
     "w.world:1:8: error: found '(', expected the name of a macro after 'define'"},
    {"define without a base", "define robot ( )",
     "w.world:1:14: error: found '(', expected the model type that 'robot' is made from"},
    {"define without a body", "define robot position\n",
     "w.world:2:1: error: found the end of the file, expected '(' to open the body of macro 'robot'"},
    {"define inside a model", "model( define a model( ) )",
     "w.world:1:8: error: found 'define' inside 'model', expected it at the top level"},
    {"define without end",
     "define robot position(\n"
     " color \"red\"\n",
     "w.world:3:1: error: found the end of the file, expected ')' to close 'robot' of line 1"},
    {"include without a name", "include\n",
     "w.world:1:8: error: found the end of the line, expected a file name in quotes after 'include'"},
    {"include of a number", "include 5\n",
     "w.world:1:9: error: found number '5', expected a file name in quotes after 'include'"},
    {"missing include", "include \"missing.inc\"\n",
     "w.world:1:9: error: cannot read 'missing.inc' (No such file or directory), expected a readable file"},
    {"include loop", "include \"loop.inc\"\n",
     "back.inc:1:9: error: found an include of 'loop.inc' inside itself, expected no include loop"},
    {"include of itself",
     "\n"
     "include \"w.world\"\n",
     "w.world:2:9: error: found an include of 'w.world' inside itself, expected no include loop"},
    {"error in an include",
     "\n"
     "\n"
     "include \"bad.inc\"\n",
     "bad.inc:3:14: error: found ')', expected a number, a string in quotes, '[' or '(' after 'color'"},
    {"unclosed include",
     "include \"open.inc\"\n"
     "model( )\n",
     "open.inc:2:1: error: found the end of the file, expected ')' to close 'model' of line 1"},
    {"include that closes the bracket of another file",
     "model(\n"
     "include \"close.inc\"\n"
     ")\n",
     "close.inc:1:1: error: found ')', expected a property or a model"},
    {"line numbers after a define",
     "define a model(\n"
     " color \"red\"\n"
     " size [1 1 1]\n"
     ")\n"
     "a( size [1 1] )\n",
     "w.world:5:9: error: found 2 values for 'size', expected 3"},
    {"macro made from itself",
     "define model model( )\n"
     "model( )",
     "w.world:2:1: error: found macro 'model' inside itself, expected no loop of defines"},
    {"macros made from each other",
     "define a b( )\n"
     "define b a( )\n"
     "a( )",
     "w.world:3:1: error: found macro 'a' inside itself, expected no loop of defines"},
    {"macro inside itself",
     "define a model( a( ) )\n"
     "a( )",
     "w.world:1:17: error: found macro 'a' inside itself, expected no loop of defines"},
};

TEST(BadSyntax, GivesOneLineWithThePlaceAndTheExpectedText) {
  WorldFolder folder;
  for (const BadSyntax& world : kBadSyntaxs) {
    folder.Write("w.world", world.text);
    EXPECT_EQ(folder.ErrorOf("w.world"), world.message) << world.name;
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
