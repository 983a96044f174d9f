// The language of expectations: what is accepted, how it is printed, and one clear error for each mistake.
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "testing/expectations/syntax.h"
#include "tests/support/small_world.h"
#include "troupe/expectation.h"

namespace troupe {
namespace {

// Robots anna (with a ranger), bob, scout1; a wall, a place "dock", a region "door".
class Fleet {
 public:
  Fleet() {
    const RobotId anna = world_.AddRobot("anna", {});
    world_.AddRanger(anna, {}, {OneRay()});
    world_.AddRobot("bob", {2.0, 0.0, 0.0, 0.0});
    world_.AddRobot("scout1", {4.0, 0.0, 0.0, 0.0});
    world_.AddBox("wall", 9.0, 0.0, 1.0, 9.0, {0.0, 1.0});
    world_.world().places.push_back({"dock", {}, {}, {1.0, 0.0, 0.0, 0.0}});
  }
  ExpectationScope scope() { return {world_.world(), std::span(&region_, 1)}; }

 private:
  SmallWorld world_;
  NamedRegion region_{"door", {{0.0, 0.0}, {1.0, 0.0}, {1.0, 1.0}, {0.0, 1.0}}};
};

std::string FormulaOf(const std::string& text) {
  Fleet fleet;
  const Result<Expectation> expectation = Expectation::Parse(text, fleet.scope());
  return expectation.ok() ? expectation.value().formula() : expectation.error().ToString();
}

TEST(ExpectationLanguageTest, PrintsFormulasInItsOwnSpelling) {
  const std::vector<std::pair<std::string, std::string>> cases{
      {"always(stalled(anna))", "always stalled(anna)"},
      {"forall r:always[0,10s]not stalled(r)", "forall r: always[0, 10 s] not stalled(r)"},
      {"x(anna)>1 and (y(bob)<2 or stalled(bob)) -> false", "x(anna) > 1 and (y(bob) < 2 or stalled(bob)) -> false"},
      {"x(anna) - (1 m - 2 m) > 0.5e1 m", "x(anna) - (1 m - 2 m) > 5 m"},
      {"-(x(anna) + 1) * 2 < 3", "-(x(anna) + 1) * 2 < 3"},
      {"stalled(anna) until [1 tick, end] stalled(bob)", "stalled(anna) until[1 ticks, end] stalled(bob)"},
      {"(forall r in 'scout*': stalled(r)) and true", "(forall r in \"scout*\": stalled(r)) and true"},
      {"forall o in objects: resting(o)", "forall o in objects: resting(o)"},
      {"always (forall d in doors: open(d) -> not closed(d))", "always (forall d in doors: open(d) -> not closed(d))"},
      {"exists p in people: level(p) == 'L1'", "exists p in people: level(p) == \"L1\""},
      {"forall s in sensors: always range(s) > 1 m", "forall s in sensors: always range(s) > 1 m"},
      {"range(anna, 'ranger:0') >= range('anna.ranger:0')", "range(anna, \"ranger:0\") >= range(\"anna.ranger:0\")"},
      {"forall l in levels: robots(l) + people(l) < 3", "forall l in levels: robots(l) + people(l) < 3"},
      {"forall l in lanes: robots(l) <= 1 or open(l)", "forall l in lanes: robots(l) <= 1 or open(l)"},
      {"level(anna) != \"L1\" or count(transmissions) > 0", "level(anna) != \"L1\" or count(transmissions) > 0"},
      {"not (stalled(anna) and stalled(bob))", "not (stalled(anna) and stalled(bob))"},
      {"always (forall a, b: distance(a, b) > 2 cm)", "always (forall a, b: distance(a, b) > 2 cm)"},
      {"in(anna, door) and at(anna, dock, 20 cm)", "in(anna, door) and at(anna, dock, 20 cm)"},
      {"hash != \"0123456789abcdef\"", "hash != \"0123456789abcdef\""},
      {"(min r: x(r)) > 10 % * (max r: x(r))", "(min r: x(r)) > 10% * (max r: x(r))"},
  };
  for (const auto& [text, formula] : cases) EXPECT_EQ(FormulaOf(text), formula) << text;
}

TEST(ExpectationLanguageTest, ShorthandsExpandToFormulas) {
  EXPECT_EQ(FormulaOf("reached(dock)"), "forall r: eventually at(r, dock)");
  EXPECT_EQ(FormulaOf("reached(dock, 300 s)"), "forall r: eventually[0 s, 300 s] at(r, dock)");
  EXPECT_EQ(FormulaOf("reached(dock, 300 s, 0.5 m)"), "forall r: eventually[0 s, 300 s] at(r, dock, 0.5 m)");
  EXPECT_EQ(FormulaOf("no_contact"), "forall a, b: always distance(a, b) > 1 mm");
  EXPECT_EQ(FormulaOf("no_contact(5 cm)"), "forall a, b: always distance(a, b) > 5 cm");
  EXPECT_EQ(FormulaOf("all_alive"), "forall r: always alive(r)");
  EXPECT_EQ(FormulaOf("within(door)"), "forall r: always in(r, door)");
  EXPECT_EQ(FormulaOf("state_hash('0123456789abcdef')"), "finally hash == \"0123456789abcdef\"");
  EXPECT_EQ(FormulaOf("no_contact and not all_alive"),
            "(forall a, b: always distance(a, b) > 1 mm) and not (forall r: always alive(r))");
}

struct Mistake {
  const char* text;
  int column;
  const char* message;  // a part of it
};

constexpr Mistake kMistakes[] = {
    {"", 1, "found the end, expected a signal"},
    {"   ", 4, "found the end"},
    {"always", 7, "found the end"},
    {"always stalled(anna) stalled(bob)", 22, "found 'stalled', expected an operator or the end"},
    {"(stalled(anna)", 15, "expected ')'"},
    {"stalled(anna", 13, "expected ')' or ','"},
    {"stalled(anna))", 14, "found ')'"},
    {"stalled()", 1, "found 0 arguments of 'stalled', expected stalled(robot)"},
    {"stalled(anna, bob)", 1, "found 2 arguments of 'stalled'"},
    {"staled(anna)", 1, "did you mean 'stalled'?"},
    {"stalled(ana)", 9, "did you mean 'anna'?"},
    {"forall robot: stalled(robt)", 23, "did you mean 'robot'?"},
    {"forall r stalled(r)", 10, "expected ':'"},
    {"forall: stalled(anna)", 7, "expected the name of a variable"},
    {"forall r, r: stalled(r)", 11, "each variable once"},
    {"forall a, b, c, d, e: stalled(a)", 20, "at most 4 variables"},
    {"forall r: stalled(anna)", 1, "the variable 'r' that is not used"},
    {"forall r in scout: stalled(r)", 13, "sensors, or names as a text"},
    {"forall r in \"scuot*\": stalled(r)", 13, "matches no robot"},
    {"forall o in objects \"can*\": resting(o)", 21, "matches no object"},
    {"forall r: r", 11, "found the variable 'r' alone"},
    {"forall r: resting(r)", 19, "which is a robot, expected an object"},
    {"at(anna, dok)", 10, "did you mean 'dock'?"},
    {"at(anna)", 1, "expected at(r, PLACE[, RADIUS])"},
    {"at(anna, dock, 5 s)", 16, "expected a length"},
    {"at(anna, dock, x(bob))", 16, "expected a length"},
    {"in(anna, doors)", 10, "did you mean 'door'?"},
    {"in(anna, dock)", 10, "expected a region (door)"},
    {"distance(anna, bob) > 10 s", 21, "found a length (m) compared with a time (s)"},
    {"distance(anna, bob) + 10 s > 3 m", 21, "found a length (m) added to a time (s)"},
    {"speed(anna) < 3 m", 13, "found a speed (m/s) compared with a length (m)"},
    {"heading(anna) < 3 m", 15, "found an angle (rad)"},
    {"x(anna) * x(bob) > 3 m", 18, "found a quantity in m^2 compared with a length"},
    {"max(x(anna), time) > 3", 1, "found a length (m) beside a time (s)"},
    {"sqrt(x(anna)) > 1", 1, "found the square root of a length"},
    {"always x(anna)", 8, "found a length (m), expected a condition"},
    {"x(anna)", 1, "found a length (m), expected a condition"},
    {"stalled(anna) > 1", 15, "found a condition compared with a number without unit"},
    {"stalled(anna) == stalled(bob)", 15, "found conditions compared"},
    {"-stalled(anna) > 1", 1, "found '-' before a condition"},
    {"stalled(anna) + 1 > 1", 15, "found '+' with a condition"},
    {"not x(anna)", 5, "expected a condition"},
    {"stalled(anna) and x(bob)", 19, "expected a condition"},
    {"1 < x(anna) < 3", 13, "expected 'and' between two"},
    {"x(anna) = 3", 9, "did you mean '=='?"},
    {"stalled(anna) & stalled(bob)", 15, "did you mean 'and'?"},
    {"stalled(anna) | stalled(bob)", 15, "did you mean 'or'?"},
    {"!stalled(anna)", 1, "did you mean 'not'?"},
    {"x(anna) > 3 metres", 13, "found unit 'metres'"},
    {"x(anna) > 3 mn", 13, "found unit 'mn'"},
    {"x(anna) > 1e999", 11, "too large"},
    {"x(anna) > .", 11, "found '.'"},
    {"turn_rate(anna) > 1", 1, "found 'turn_rate', expected its present name 'wz'"},
    {"open(anna)", 6, "which is a robot, expected a door, lift or lane"},
    {"forall d in doors: stalled(d)", 28, "which is a door, expected a robot"},
    {"count(roboots) > 1", 7, "found no event"},
    {"level(anna) == \"L9\"", 13, "expected one of L1"},
    {"level(anna) > \"L1\"", 13, "found texts compared"},
    {"level(anna) == 1", 13, "found a text compared with a number"},
    {"always[0, 10 m] stalled(anna)", 7, "found a length (m) in an interval"},
    {"always[10 s, 5 s] stalled(anna)", 7, "without a tick in it"},
    {"always[0.01 s, 0.02 s] stalled(anna)", 7, "without a tick in it (a tick is 0.1 s)"},
    {"always[0, 1.5 ticks] stalled(anna)", 7, "a part of a tick"},
    {"always[0 s 5 s] stalled(anna)", 12, "expected ','"},
    {"always[0 s, 5 s stalled(anna)", 17, "expected ']'"},
    {"always[x(anna), 5 s] stalled(anna)", 8, "expected a time"},
    {"always[0, 9e9 h] stalled(anna)", 7, "found an interval beyond"},
    {"x(anna) > always stalled(anna)", 11, "needs parentheses"},
    {"hash == \"12\"", 6, "expected 16 digits"},
    {"hash > \"0123456789abcdef\"", 6, "expected hash == "},
    {"\"anna\" == \"bob\"", 8, "found texts compared"},
    {"\"anna", 1, "found a text without an end"},
    {"always \"\"", 8, "found an empty text"},
    {"event(gript)", 7, "expected a type of event"},
    {"count(stalled(anna)) > 1", 7, "found no event"},
    {"position(anna, \"lift\") > 1", 16, "expected no part of robot anna, because it is without a joint"},
    {"position(anna, lift) > 1", 16, "expected the name of a joint in quotes"},
    {"joint(anna, \"lift\") > 1", 1, "found 'joint', expected its present name 'position'"},
    {"joint_speed(anna, \"lift\") > 1", 1, "found 'joint_speed', expected its present name 'velocity'"},
    {"due(anna, \"laser\")", 11, "expected a sensor of robot anna (ranger:0)"},
    {"type(\"anna.ranger:0\") == \"rangr\"", 23, "expected one of ranger, break_beam"},
    {"pressed(\"anna.ranger:0\")", 1, "found 'pressed' of sensor anna.ranger:0, which is no bumper"},
    {"range(\"anna.ranger:0\", \"laser\") > 1", 24, "expected it behind a robot"},
    {"range(bob) > 1", 1, "robot bob, which has no ranger"},
    {"range(anna, \"laser\") > 1", 13, "expected a ranger of robot anna (ranger:0)"},
    {"energy(anna) > 1", 1, "found 'energy' of robot anna, which has none"},
    {"reached()", 1, "found 0 arguments of 'reached'"},
    {"reached(dock, soon)", 15, "expected the TIME"},
    {"within(dok)", 8, "expected a region"},
    {"all_alive(anna)", 1, "found 1 arguments of 'all_alive'"},
    {"state_hash(12)", 1, "found"},
    {"distance(anna, nowhere) > 1", 16, "expected a variable, robot, object, person, model or place"},
    {"min r: x(r) > 1", 13, "expected a number for 'min'"},
};

TEST(ExpectationLanguageTest, EachMistakeIsOneClearErrorAtItsPlace) {
  Fleet fleet;
  EXPECT_GE(std::size(kMistakes), 60u);
  for (const Mistake& mistake : kMistakes) {
    const Result<Expectation> result = Expectation::Parse(mistake.text, fleet.scope());
    if (result.ok()) {
      ADD_FAILURE() << mistake.text << ": accepted as " << result.value().formula();
      continue;
    }
    const Error& error = result.error();
    EXPECT_EQ(error.where.line, 1) << mistake.text;
    EXPECT_EQ(error.where.column, mistake.column) << mistake.text << ": " << error.message;
    EXPECT_NE(error.message.find(mistake.message), std::string::npos) << mistake.text << ": " << error.message;
    EXPECT_EQ(error.code, ErrorCode::kBadInput);
    EXPECT_EQ(error.message.find('\n'), std::string::npos);
  }
}

TEST(ExpectationLanguageTest, MetricsHaveUnitsAndErrors) {
  Fleet fleet;
  const std::vector<std::pair<std::string, std::string>> units{
      {"time of first at(anna, dock)", "s"}, {"time of last at(r, dock)", "s"},
      {"min of distance(a, b)", "m"},        {"max of speed(r)", "m/s"},
      {"mean of x(r) * x(r)", "m^2"},        {"final of (count r: stalled(r))", ""},
      {"sum r: speed(r) / time", "m/s^2"},   {"max of abs(wz(anna))", "rad/s"}};
  for (const auto& [text, unit] : units) {
    const Result<Metric> metric = Metric::Parse(text, fleet.scope());
    ASSERT_TRUE(metric.ok()) << text << ": " << metric.error().ToString();
    EXPECT_EQ(metric.value().unit(), unit) << text;
  }
  for (const char* const text : {"time of x(anna)", "time of first x(anna)", "min of stalled(r)", "final of x(r)",
                                 "min of nothing(r)", "max of x(annna)"}) {
    EXPECT_FALSE(Metric::Parse(text, fleet.scope()).ok()) << text;
  }
}

TEST(ExpectationLanguageTest, TheTablesOfTheDocumentationAreThoseOfTheProgram) {
  const char* const source = std::getenv("TROUPE_SOURCE_DIR");
  if (source == nullptr) GTEST_SKIP() << "TROUPE_SOURCE_DIR is not set";
  std::ifstream file(std::string(source) + "/docs/testing.md");
  std::stringstream page;
  page << file.rdbuf();
  std::vector<LanguageEntry> entries = ListSignals();
  for (const LanguageEntry& entry : ListOperators()) entries.push_back(entry);
  for (const LanguageEntry& entry : entries) {
    const std::string row = "| `" + entry.usage + "` | " + entry.result + " | " + entry.meaning + " |\n";
    EXPECT_NE(page.str().find(row), std::string::npos) << row;
  }
  for (const LanguageEntry& entry : ListShorthands()) {
    const std::string row = "| `" + entry.usage + "` | `" + entry.result + "` | " + entry.meaning + " |\n";
    EXPECT_NE(page.str().find(row), std::string::npos) << row;
  }
}

}  // namespace
}  // namespace troupe
