// TestFile: a test of a scenario, read and checked. A test is a scenario with more keys, or a *.test.json that names
// one; docs/testing.md describes both, configs/scenario.schema.json is the schema.
//
// Cases replace values in the text of the scenario (ScenarioText) rather than in a parsed world: what a case runs is a
// scenario that a user could have written, a failing case can be written as a scenario of its own, and errors have
// lines and columns of the file. Two variations must not overlap, or the order of replacement would count.
//
// Immutable after Read. Errors of Read are at a place of the test's file; an error in a clause is moved from its column
// in the formula to the column in the file (At).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/base/json_tree.h"
#include "common/picture/heat_map.h"
#include "testing/cases/case_design.h"
#include "testing/cases/value_path.h"
#include "troupe/result.h"

namespace troupe {

// An entry of "expect", "cover" or "metrics".
struct TestClause {
  std::string name;  // of an entry without one: its text
  std::string text;  // of the language of expectations
  TextSpan span;     // of the text in the file, with its quotes
};

// `heat`: the heat maps of a report.
struct TestHeat {
  std::vector<HeatKind> kinds;  // each once
  double cell = HeatMap::kDefaultCell;

  std::vector<HeatMap> EmptyMaps() const;
  bool operator==(const TestHeat&) const = default;
};

class TestFile {
 public:
  // `fixed`: draws of --case. One of a path in `vary` replaces its values, any other is added to `vary` with this
  // value. The error names the place in the file.
  static Result<TestFile> Read(const std::string& path, const TestCase& fixed = {});

  const std::string& path() const { return path_; }
  const std::string& name() const { return name_; }
  // The scenario whose values cases vary: the test itself, or the file that it names.
  const std::string& scenario_path() const { return scenario_path_; }
  const ScenarioText& scenario() const { return *scenario_; }
  const CaseDesign& design() const { return *design_; }
  const std::vector<TestClause>& expect() const { return expect_; }
  const std::vector<TestClause>& cover() const { return cover_; }
  const std::vector<TestClause>& metrics() const { return metrics_; }
  const TestHeat& heat() const { return heat_; }

  // The draws of a case and those that all cases have: what replaces values of the scenario.
  TestCase WithCommon(const TestCase& draws) const;
  // The scenario of a case, as a text of its own for the folder of `scenario_path`.
  Result<std::string> TextOf(const TestCase& draws) const;
  // An error whose column counts in the text of a clause, at its place in the file.
  Error At(const TestClause& clause, Error error) const;
  // Draws that the generator could have made: the constraints, and the values of each variation. Draws of other paths
  // may be anything.
  bool CanMake(const TestCase& draws) const;
  // The case of a text: the draws of all variations, in their order, and behind them values of other paths. Without
  // `ticks` and `without`, unless they are varied: these make a smaller case, which is only a part of one. Nothing: no
  // case of the test.
  std::optional<TestCase> WholeCase(const TestCase& draws) const;

 private:
  TestFile() = default;
  Status ReadClauses(const JsonTree& tree);
  Status ReadHeat(const JsonTree& tree);
  Status ReadDesign(const JsonTree& tree, const TestCase& fixed);
  // `vary`.
  Result<std::vector<Variation>> ReadVariations(const JsonTree& tree) const;
  // Gives the draws of --case to the variations of their paths, and adds variations for the other ones.
  Status FixDraws(const TestCase& fixed, std::vector<Variation>& variations) const;
  // `where`; `names`: the paths of all variations.
  Result<std::vector<Constraint>> ReadConstraints(const JsonTree& tree, const std::vector<std::string>& names) const;

  std::string path_;
  std::string text_;  // of the file
  std::string name_;
  std::string scenario_path_;
  std::optional<ScenarioText> scenario_;  // has a value, as the next one, once it is read
  std::optional<CaseDesign> design_;
  TestCase common_;
  std::vector<TestClause> expect_;
  std::vector<TestClause> cover_;
  std::vector<TestClause> metrics_;
  TestHeat heat_;
};

// The tests that a command line names, each once: files, and in folders all *.test.json, at any depth, by name.
Result<std::vector<std::string>> FindTests(const std::vector<std::string>& paths);

// Names for the files that a session makes of these tests, in their order: "dock" of dock.test.json, with the folders
// above it as far as another test has the same name: "hall-dock". All are different, and have letters, digits, '-' and
// '_' alone.
std::vector<std::string> FileNamesOf(const std::vector<std::string>& tests);

}  // namespace troupe
