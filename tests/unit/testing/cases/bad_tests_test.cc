// Wrong tests: one line for each, with its place.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "testing/cases/case_run.h"
#include "testing/cases/test_file.h"
#include "tests/support/files.h"

namespace troupe {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

struct BadTest {
  const char* name;
  std::string text;   // ' stands for "
  std::string error;  // its begin, behind the file's name
};

std::string Quoted(std::string text) {
  for (char& c : text) c = c == '\'' ? '"' : c;
  return text;
}

// A test with these keys on its second line.
std::string With(const std::string& keys) {
  return Quoted("{'ticks': 5, 'expect': ['tick < 100'],\n" + keys + "}");
}

// A test with this expectation in its second line, from column 3.
std::string Expecting(const std::string& text) {
  return "{\"ticks\": 5, \"robots\": [{\"name\": \"anna\", \"model\": \"position\", \"pose\": [0, 0, 0]}], \"expect\": "
         "[\n  \"" +
         text + "\"]}";
}

class BadTests : public testing::TestWithParam<BadTest> {};

// Its error is bad input, with which the program ends with status 2.
std::string ErrorOf(const std::string& text) {
  const test::TemporaryFolder folder;
  folder.Write("scenario.json", "{\"spawn\": [], \"robots\": [{\"name\": \"anna\", \"model\": \"position\"}]}");
  const std::string path = folder.Write("t.test.json", text);
  std::string error;
  const Result<TestFile> test = TestFile::Read(path);
  if (!test.ok()) {
    EXPECT_EQ(test.error().code, ErrorCode::kBadInput);
    error = test.error().ToString();
  } else if (const Status status = CaseWorlds(test.value()).Check(test.value().design().At(0)); !status.ok()) {
    EXPECT_EQ(status.error().code, ErrorCode::kBadInput);
    error = status.error().ToString();
  }
  return error.starts_with(path) ? error.substr(path.size()) : error;
}

TEST_P(BadTests, EndWithTheirPlace) {
  const std::string error = ErrorOf(GetParam().text);
  EXPECT_THAT(error, StartsWith(GetParam().error));
  EXPECT_THAT(error, testing::AnyOf(HasSubstr("expected"), HasSubstr("No such file")));
  EXPECT_EQ(error.find('\n'), std::string::npos);
}

const BadTest kBadTests[] = {
    {"Empty", "", ":1:1: error: "},
    {"NoObject", "[1]", ":1:1: error: found an array of 1"},
    {"NoClauses", Quoted("{'ticks': 5}"), ":1:1: error: found none of 'expect', 'cover' and 'metrics'"},
    {"NoTicks", Quoted("{'expect': ['tick < 9']}"), ": error: found no 'ticks'"},
    {"UnknownKey", With("'varry': {}"), ":2:1: error: found the key 'varry'"},
    {"VaryIsAList", With("'vary': []"), ":2:9: error: found an empty array"},
    {"VaryANumber", With("'vary': {'seed': 3}"), ":2:18: error: found the number 3"},
    {"VaryWithoutKind", With("'vary': {'seed': {}}"), ":2:18: error: found none of 'values'"},
    {"VaryTwoKinds", With("'vary': {'seed': {'values': [1], 'range': [1, 2]}}"), ":2:18: error: found several of"},
    {"VaryUnknownKind", With("'vary': {'seed': {'choose': [1]}}"), ":2:19: error: found the key 'choose'"},
    {"NoValues", With("'vary': {'seed': []}"), ":2:18: error: found no value"},
    {"RangeOfOne", With("'vary': {'seed': {'range': [1]}}"), ":2:28: error: found an array of 1"},
    {"RangeUpsideDown", With("'vary': {'seed': {'range': [9, 1]}}"), ":2:32: error: found 1, expected at least 9"},
    {"RangeOfTexts", With("'vary': {'seed': {'range': ['a', 'b']}}"), ":2:29: error: found the string 'a'"},
    {"StepOfZero", With("'vary': {'seed': {'range': [1, 9, 0]}}"), ":2:35: error: found the step 0"},
    {"HugeRange", With("'vary': {'seed': {'range': [0, 1e12]}}"), ":2:28: error: found a range of more than"},
    {"UniformOfThree", With("'vary': {'seed': {'uniform': [1, 2, 3]}}"), ":2:30: error: found 3 numbers"},
    {"UniformUpsideDown", With("'vary': {'seed': {'uniform': [2, 1]}}"), ":2:34: error: found 1, expected at least 2"},
    {"NegativeDeviation", With("'vary': {'seed': {'normal': [2, -1]}}"), ":2:33: error: found the deviation -1"},
    {"WithinOfARange", With("'vary': {'seed': {'range': [1, 2], 'within': [1, 2]}}"),
     ":2:46: error: found 'within' without"},
    {"EmptyPath", With("'vary': {'': [1]}"), ":2:10: error: found the end in the path"},
    {"OpenPath", With("'vary': {'spawn[0': [1]}"), ":2:10: error: found the end in the path"},
    {"PathToNothing", With("'vary': {'spawn[0].count': [1]}"), ":2:10: error: found the path 'spawn[0].count', but"},
    {"PathThroughANumber", With("'vary': {'ticks.x': [1]}"),
     ":2:10: error: found the path 'ticks.x', but 'ticks' is the number 5"},
    {"PathTwice", With("'vary': {'seed': [1], 'seed': [2]}"), ":2:"},
    {"PathInsideAnother", With("'robots': [{'name': 'a'}], 'vary': {'robots[0].name': [1], 'robots[0]': [2]}"),
     ":2:60: error: found the path 'robots[0]', a value that 'robots[0].name' varies too"},
    {"DesignOfAnotherName", With("'design': 'all'"), ":2:11: error: found 'all', expected 'product'"},
    {"DesignOfNoCases", With("'design': {'random': 0}"), ":2:22: error: found the number 0"},
    {"DesignWithoutNumber", With("'design': {'seed': 1}"), ":2:11: error: found no 'random'"},
    {"TooManyCases", With("'vary': {'seed': {'range': [1, 1e8]}}"), ":2:9: error: found more than 10000000"},
    {"NoCaseLeft", With("'vary': {'seed': [1, 2]}, 'where': ['seed > 5']"),
     ":2:9: error: found constraints that no case"},
    {"WhereOfAnUnknownName", With("'vary': {'seed': [1]}, 'where': ['sead > 5']"),
     ":2:35: error: found the name 'sead', expected one of those in 'vary'; did you mean 'seed'?"},
    {"WhereEnds", With("'vary': {'seed': [1]}, 'where': ['seed >']"), ":2:41: error: found the end"},
    {"WhereIsANumber", With("'vary': {'seed': [1]}, 'where': ['3 + 4']"),
     ":2:37: error: found a number, expected a condition"},
    {"WhereComparesKinds", With("'where': ['3 == \\'a\\'']"), ":2:"},
    {"WhereOpenParenthesis", With("'vary': {'seed': [1]}, 'where': ['(seed > 1']"),
     ":2:44: error: found the end, expected ')'"},
    {"WhereGoesOn", With("'vary': {'seed': [1]}, 'where': ['seed > 1 2']"),
     ":2:44: error: found a number, expected an operator or the end"},
    {"WhereAddsConditions", With("'vary': {'seed': [1]}, 'where': ['(seed > 1) + 2 > 3']"),
     ":2:41: error: found a condition, expected a number"},
    {"WhereHasTime", With("'vary': {'seed': [1]}, 'where': ['always seed > 1']"),
     ":2:35: error: found 'always', expected a condition of names in 'vary'"},
    {"WhereHasAUnit", With("'vary': {'seed': [1]}, 'where': ['seed > 1 m']"), ":2:42: error: found the unit 'm'"},
    {"ScenarioIsMissing", With("'scenario': 'none.json'"), ":2:13: error: "},
    {"ScenarioWithModels", With("'scenario': 'scenario.json', 'models': []"),
     ":2:30: error: found the key 'models' in a test of another"},
    {"ExpectIsText", Quoted("{'ticks': 5, 'expect': 'tick < 3'}"), ":1:24: error: found the string 'tick < 3'"},
    {"ExpectWithoutThat", Quoted("{'ticks': 5, 'expect': [{'name': 'a'}]}"), ":1:25: error: found no 'that'"},
    {"ExpectTwice", Quoted("{'ticks': 5, 'expect': ['tick < 3', 'tick < 3']}"),
     ":1:37: error: found the name 'tick < 3' again"},
    {"MetricIsANumber", With("'metrics': {'a': 3}"), ":2:18: error: found the number 3"},
    {"HeatIsAText", With("'heat': 'robots'"), ":2:9: error: found the string 'robots', expected an array of the heat"},
    {"HeatOfNothing", With("'heat': []"), ":2:9: error: found an empty array"},
    {"HeatOfAnotherKind", With("'heat': ['robots', 'doors']"),
     ":2:20: error: found the string 'doors', expected 'robots', 'people' or 'waits'"},
    {"HeatTwice", With("'heat': ['robots', 'waits', 'robots']"),
     ":2:29: error: found 'robots' again, expected each map once"},
    {"HeatWithoutKinds", With("'heat': {'cell': 1}"), ":2:9: error: found no 'of'"},
    {"HeatOfHugeCells", With("'heat': {'of': ['waits'], 'cell': 101}"),
     ":2:35: error: found the number 101, expected a side of cells from 0.05 to 100 m"},
    {"HeatWithAnotherKey", With("'heat': {'of': ['waits'], 'cel': 1}"), ":2:27: error: found the key 'cel'"},
    {"ControllerIsUnknown", With("'controller': 'none', 'robots': [{'name': 'r', 'model': 'position'}]"), ""},
    // The language, as far as it needs a world; its own tests have the others.
    {"EmptyExpectation", Expecting(" "), ":2:"},
    {"UnknownSignal", Expecting("forall r: always sped(r) < 1"), ":2:21: error: "},
    {"UnknownRobot", Expecting("always speed(bert) < 1 m/s"), ":2:17: error: "},
    {"LengthAgainstTime", Expecting("forall r: always x(r) < 3 s"), ":2:"},
    {"SpeedAgainstLength", Expecting("forall r: always speed(r) < 3 m"), ":2:"},
    {"UnknownPlace", Expecting("forall r: eventually at(r, dock)"), ":2:31: error: "},
    {"UnknownRegion", Expecting("forall r: always in(r, hall)"), ":2:27: error: "},
    {"OpenInterval", Expecting("forall r: eventually[0 s stalled(r)"), ":2:"},
    {"IntervalUpsideDown", Expecting("forall r: eventually[3 s, 1 s] stalled(r)"), ":2:"},
    {"IntervalOfMetres", Expecting("forall r: eventually[0 m, 1 m] stalled(r)"), ":2:"},
    {"UnknownUnit", Expecting("forall r: always x(r) < 3 miles"), ":2:"},
    {"NumberAlone", Expecting("3"), ":2:"},
    {"WithoutAQuantifier", Expecting("always stalled(r)"), ":2:"},
    {"TooManyArguments", Expecting("forall r: always speed(r, r) < 1 m/s"), ":2:"},
    {"UnclosedParenthesis", Expecting("forall r: always (stalled(r)"), ":2:"},
    {"BehindEscapes", Expecting("forall r in \\\"ann*\\\": always sped(r) < 1"), ":2:33: error: "},
    {"MetricOfWhatIsNone", With("'metrics': {'a': 'time of'}"), ":2:"},
};

INSTANTIATE_TEST_SUITE_P(Tests, BadTests, testing::ValuesIn(kBadTests),
                         [](const auto& test) { return std::string(test.param.name); });

TEST(TestFile, CasesHaveTheDrawsOfTheCommandLine) {
  const test::TemporaryFolder folder;
  const std::string path = folder.Write(
      "t.test.json",
      Quoted("{'ticks': 5, 'expect': ['tick < 9'], 'vary': {'seed': {'range': [1, 9]}, 'speed': [1, 2]}}"));
  const TestFile test = TestFile::Read(path, {{"seed", "4"}, {"ticks", "3"}}).value();
  ASSERT_EQ(test.design().size(), 2U);
  EXPECT_EQ(CaseText(test.design().At(0)), "seed=4,speed=1,ticks=3");
  EXPECT_THAT(test.TextOf(test.design().At(1)).value(), HasSubstr("\"ticks\": 3"));
  EXPECT_THAT(TestFile::Read(path, {{"seed", "10"}}).error().message,
              HasSubstr("--case: found '10' as 'seed', expected 1 to 9"));
}

TEST(TestFile, RobotsThatAreLeftOutLeaveTheOthersAtTheirPlaces) {
  const test::TemporaryFolder folder;
  const std::string path =
      folder.Write("t.test.json", Quoted("{'ticks': 5, 'expect': ['tick < 9'], 'spawn': [{'model': 'position', "
                                         "'count': 6, 'region': [-4, -4, 4, 4]}]}"));
  const TestFile test = TestFile::Read(path).value();
  const CaseWorlds worlds(test);
  const WorldDescription all = worlds.Load({}).value().world;
  const WorldDescription some = worlds.Load({{"without", R"(["position0","position3"])"}}).value().world;
  ASSERT_EQ(some.robots.size(), 4U);
  for (const RobotDescription& robot : some.robots) {
    const RobotDescription& same = all.robot(FindRobot(all, robot.name).value());
    EXPECT_EQ(some.model(robot.root).X_PM.x, all.model(same.root).X_PM.x) << robot.name;
    EXPECT_EQ(some.model(robot.root).X_PM.heading, all.model(same.root).X_PM.heading) << robot.name;
  }
  EXPECT_THAT(worlds.Load({{"without", R"(["position7"])"}}).error().message,
              HasSubstr("found no robot or model 'position7' to leave out"));
}

}  // namespace
}  // namespace troupe
