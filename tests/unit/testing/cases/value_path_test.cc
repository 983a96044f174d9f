// Paths of values in scenarios, texts with other values, and cases as texts.
#include "testing/cases/value_path.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>

#include "common/base/json_tree.h"
#include "testing/cases/test_file.h"
#include "testing/cases/variation.h"
#include "tests/support/files.h"

namespace troupe {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr const char* kScenario = R"({
  "seed": 3,
  "spawn": [{"model": "scout", "count": 5}],
  "robots": [
    {"name": "anna", "controller": {"name": "wander", "parameters": {}}}
  ]
})";

std::string With(const std::vector<DrawnValue>& draws) {
  const Result<std::string> text = ScenarioText::Parse(kScenario, "s.json").value().With(draws);
  return text.ok() ? text.value() : text.error().message;
}

TEST(ValuePath, ReplacesValuesAndLeavesAllOtherBytes) {
  std::string expected = kScenario;
  expected.replace(expected.find("3,"), 1, "17");
  expected.replace(expected.find("5}"), 1, "20");
  EXPECT_EQ(With({{"spawn[0].count", "20"}, {"seed", "17"}}), expected);
}

TEST(ValuePath, AddsAKeyThatAnObjectLacks) {
  EXPECT_THAT(With({{"robots[anna].controller.parameters.speed", "0.5"}}),
              HasSubstr("\"parameters\": {\"speed\": 0.5}"));
  EXPECT_THAT(With({{"ticks", "9"}, {"without", "[\"anna\"]"}}),
              HasSubstr("{\"ticks\": 9, \"without\": [\"anna\"], \n"));
}

TEST(ValuePath, SaysWhichPartOfAPathIsMissing) {
  EXPECT_THAT(With({{"spawn[1].count", "1"}}), HasSubstr("'spawn' has 1 element"));
  EXPECT_THAT(With({{"robots[ana].pose", "1"}}),
              HasSubstr("no object with the name 'ana', expected that of one; did you mean 'anna'?"));
  EXPECT_THAT(With({{"sead.x", "1"}}), HasSubstr("has no key 'sead', expected one that it has; did you mean 'seed'?"));
  EXPECT_THAT(With({{"seed.x", "1"}}), HasSubstr("'seed' is the number 3, expected an object"));
  EXPECT_THAT(With({{"seed[0]", "1"}}), HasSubstr("'seed' is the number 3, expected an array"));
}

TEST(ValuePath, RefusesTextsThatAreNone) {
  for (const auto& [text, column] : std::vector<std::pair<std::string, int>>{
           {"", 1}, {".seed", 1}, {"spawn[", 7}, {"spawn[]", 7}, {"spawn[0]count", 9}, {"spawn..count", 7}}) {
    const Result<ValuePath> path = ValuePath::Parse(text);
    ASSERT_FALSE(path.ok()) << text;
    EXPECT_EQ(path.error().where.column, column) << text;
  }
}

TEST(ValuePath, OverlapsWithThePathsInsideIt) {
  const auto path = [](const char* text) { return ValuePath::Parse(text).value(); };
  EXPECT_TRUE(path("spawn[0]").Overlaps(path("spawn[0].count")));
  EXPECT_FALSE(path("spawn[1].count").Overlaps(path("spawn[0].count")));
}

TEST(ScenarioText, NamesFilesByAbsolutePaths) {
  const std::string text = R"({"world": "a.world", "include": ["/b.inc"], "controller": "wander",
    "robots": [{"controller": {"name": "own.so"}, "properties": {"bitmap": "c.png"}}, {"controller": "p.py:Patrol"}]})";
  EXPECT_EQ(ScenarioText::Parse(text, "s.json").value().WithAbsolutePaths("/folder/s.json"),
            R"({"world": "/folder/a.world", "include": ["/b.inc"], "controller": "wander",
    "robots": [{"controller": {"name": "/folder/own.so"}, "properties": {"bitmap": "/folder/c.png"}}, {"controller": "/folder/p.py:Patrol"}]})");
}

TEST(ScenarioText, NamesTheFilesThatALoadFinds) {
  const test::TemporaryFolder folder;
  folder.Write("models/shared.inc", "");
  folder.Write("models/map.yaml", "");
  folder.Write("test/own.inc", "");
  const char* const before = std::getenv("STAGEPATH");
  const std::string restored = before != nullptr ? before : "";
  setenv("STAGEPATH", (folder / "models").c_str(), 1);
  const std::string text =
      R"({"include": ["own.inc", "shared.inc", "none.inc"], "models": [{"properties": {"map_yaml": "map.yaml"}}]})";
  const std::string absolute = ScenarioText::Parse(text, "s.json").value().WithAbsolutePaths(folder / "test/s.json");
  setenv("STAGEPATH", restored.c_str(), 1);
  EXPECT_EQ(absolute, R"({"include": [")" + (folder / "test/own.inc") + R"(", ")" + (folder / "models/shared.inc") +
                          R"(", ")" + (folder / "test/none.inc") + R"("], "models": [{"properties": {"map_yaml": ")" +
                          (folder / "models/map.yaml") + R"("}}]})");
}

TEST(FileNames, AreDifferentForTestsOfOneName) {
  EXPECT_THAT(FileNamesOf({"dock.test.json"}), ElementsAre("dock"));
  EXPECT_THAT(FileNamesOf({"hall/dock.test.json", "./yard/dock.test.json", "yard/gate.json"}),
              ElementsAre("hall-dock", "yard-dock", "gate"));
  EXPECT_THAT(FileNamesOf({"/a/b/x.test.json", "/c/b/x.test.json", "x.test.json"}), ElementsAre("a-b-x", "c-b-x", "x"));
  EXPECT_THAT(FileNamesOf({"a/x.json", "a/./x.json", "ä/x y.json", "b/x y.json"}),
              ElementsAre("a-x", "a-x-2", "__-x_y", "b-x_y"));
}

TEST(CaseText, IsReadAsItWasWritten) {
  const TestCase draws = {
      {"seed", "17"}, {"robots[a].pose", "[1,2,90]"}, {"without", R"(["r1","r,2"])"}, {"controller", "\"wander\""}};
  const Result<TestCase> read = ParseCase(CaseText(draws));
  ASSERT_TRUE(read.ok()) << read.error().message;
  EXPECT_EQ(read.value(), draws);
  EXPECT_THAT(ParseCase("controller=wander").value(), ElementsAre(DrawnValue{"controller", "\"wander\""}));
}

// Names of robots are the user's, and what is printed repeats the case.
TEST(CaseText, KnowsPathsWithAnyNamesAndKeys) {
  for (const auto& [path, written] :
       std::vector<std::pair<std::string, std::string>>{{"robots[a=b].pose", "robots[a=b].pose"},
                                                        {"robots[a,b].pose", "robots[a,b].pose"},
                                                        {R"(robots["a]=b"].pose)", R"(robots["a]=b"].pose)"},
                                                        {R"(robots["0"].pose)", R"(robots["0"].pose)"},
                                                        {"parameters.x=y", R"(parameters."x=y")"},
                                                        {R"(parameters."x.y".z)", R"(parameters."x.y".z)"}}) {
    const ValuePath parsed = ValuePath::Parse(path).value();
    EXPECT_EQ(parsed.text(), written);
    const TestCase draws = {{parsed.text(), "\"u=v\""}, {"seed", "1"}};
    const Result<TestCase> read = ParseCase(CaseText(draws));
    ASSERT_TRUE(read.ok()) << read.error().message;
    EXPECT_EQ(read.value(), draws);
    EXPECT_TRUE(ValuePath::Parse(read.value().front().path).value() == parsed);
  }
  EXPECT_TRUE(ValuePath::Parse(R"(robots["anna"].pose)").value() == ValuePath::Parse("robots[anna].pose").value());
  EXPECT_FALSE(ValuePath::Parse(R"(robots["0"])").value() == ValuePath::Parse("robots[0]").value());
  EXPECT_THAT(ParseCase("a=x=y").value(), ElementsAre(DrawnValue{"a", "\"x=y\""}));
}

TEST(CaseText, RefusesTextsThatAreNone) {
  for (const auto& [text, message] : std::vector<std::pair<std::string, std::string>>{
           {"seed", "column 1: found 'seed', expected NAME=VALUE"},
           {"seed=", "column 6: found no value of 'seed'"},
           {"seed=1,seed=2", "column 8: found 'seed' again"},
           {"seed=[1", "column 6: found '[1', expected a JSON value or a word"},
           {"spawn[=1", "expected ']'"},
           {"robots[\"a=1", "expected a JSON string"},
           {"seed=1,seed=\xff", "column 13: found the byte 0xff, expected UTF-8"},
           {std::string("seed=1\0x", 8), "column 7: found the byte 0x00, expected text"},
           {"robots[a]=1,robots[\"a\"]=1", "again"}}) {
    const Result<TestCase> read = ParseCase(text);
    ASSERT_FALSE(read.ok()) << text;
    EXPECT_THAT(read.error().message, HasSubstr(message));
  }
}

Variation VariationOf(const std::string& json) {
  const JsonTree tree = JsonTree::Parse("{\"x\": " + json + "}", "t").value();
  return Variation::Read(tree, tree.root().items[0], ValuePath::Parse("x").value()).value();
}

TEST(Variation, RangesHaveTheirNumbersWithoutRoundingErrors) {
  const Variation range = VariationOf("{\"range\": [0, 1, 0.1]}");
  ASSERT_EQ(range.size(), 11U);
  EXPECT_EQ(range.At(3), "0.3");
  EXPECT_TRUE(range.Contains("0.3"));
  EXPECT_FALSE(range.Contains("0.35"));
  EXPECT_FALSE(range.Contains("1.1"));
  EXPECT_EQ(VariationOf("{\"range\": [1, 200]}").At(199), "200");
}

TEST(Variation, DrawsAreWithinTheirBoundsAndRepeatable) {
  for (const char* const json : {"{\"uniform\": [-1, 2]}", "{\"normal\": [0, 5], \"within\": [-1, 2]}"}) {
    const Variation variation = VariationOf(json);
    double sum = 0.0;
    for (std::uint64_t key = 0; key < 1000; ++key) {
      const std::string draw = variation.Draw(key, 0);
      EXPECT_TRUE(variation.Contains(draw)) << draw;
      EXPECT_EQ(draw, variation.Draw(key, 0));
      sum += NumberIn(draw);
    }
    EXPECT_NEAR(sum / 1000.0, 0.5, 0.15) << json;
  }
}

TEST(Variation, DrawsHaveAsManyDigitsAsTheirBoundsNeed) {
  for (const char* const json : {"{\"uniform\": [0.1234567, 0.1234569]}", "{\"uniform\": [1234567.2, 1234567.4]}",
                                 "{\"uniform\": [0.30000000000000004, 0.30000000000000004]}",
                                 "{\"normal\": [0, 5], \"within\": [1.0000001, 1.0000002]}"}) {
    const Variation variation = VariationOf(json);
    for (std::uint64_t key = 0; key < 100; ++key) {
      const std::string draw = variation.Draw(key, 0);
      EXPECT_TRUE(variation.Contains(draw)) << draw;
      EXPECT_TRUE(variation.Contains(variation.Near(draw, 1.0, key, 0))) << draw;
    }
  }
  const Variation narrow = VariationOf("{\"uniform\": [0.1234567, 0.1234569]}");
  EXPECT_FALSE(narrow.Contains("0.123457"));
  EXPECT_FALSE(narrow.Contains("0.12345669"));
  EXPECT_LE(VariationOf("{\"uniform\": [0, 1]}").Draw(3, 0).size(), 12U) << "six digits";
}

TEST(Variation, SimplerValuesAreValuesThatADrawCanHave) {
  EXPECT_THAT(VariationOf("[20, 5, 50]").SimplerThan("50"), ElementsAre("5", "20"));
  EXPECT_THAT(VariationOf("{\"range\": [1, 100]}").SimplerThan("5"), ElementsAre("1", "3", "4"));
  for (const std::string& value : VariationOf("{\"uniform\": [0.3, 1.2]}").SimplerThan("0.712345")) {
    EXPECT_GE(NumberIn(value), 0.3);
    EXPECT_LT(value.size(), std::string("0.712345").size());
  }
  EXPECT_THAT(VariationOf("[\"a\", \"b\"]").SimplerThan("\"a\""), ElementsAre());
}

}  // namespace
}  // namespace troupe
