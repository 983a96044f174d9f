// Variation: the values that one `vary` entry of a test can draw; and cases: lists of draws.
//
// A value is JSON text from the beginning to the end: what is drawn, printed in --case, written into the scenario and
// compared are the same bytes, so that a case that is pasted from a report is the case that ran. Random numbers are
// therefore cut to six digits when they are drawn, not when they are shown; of a number that this would move out of its
// bounds more are kept. A draw is a function of its key and counter
// (troupe/random.h).
//
// Immutable after Read; errors are at the place in the test's file.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/json_tree.h"
#include "testing/cases/value_path.h"
#include "troupe/interval.h"
#include "troupe/result.h"

namespace troupe {

// The draws of one case, in the order of the test's `vary`; the draws of shrinking follow.
using TestCase = std::vector<DrawnValue>;

// "seed=17,spawn[0].count=5": the text of --case.
std::string CaseText(const TestCase& draws);
// Reads such a text. A value is JSON, or a word without quotes, commas and brackets, which is a string.
Result<TestCase> ParseCase(std::string_view text);
// The value of a draw as a number; of anything else 0.
double NumberIn(const std::string& json);

class Variation {
 public:
  // Reads an array of values, or {"values": [...]}, {"range": [from, to, step]}, {"uniform": [from, to]},
  // {"normal": [mean, deviation], "within": [from, to]}. The error names the place.
  static Result<Variation> Read(const JsonTree& tree, const JsonNode& entry, ValuePath path);
  // With one value only.
  static Variation Of(ValuePath path, std::string value);

  const std::string& path() const { return path_.text(); }
  const ValuePath& value_path() const { return path_; }
  const SourceLocation& where() const { return where_; }

  // The number of values; 0: a draw of uniform or normal numbers.
  std::uint64_t size() const;
  // The value number `index`. REQUIRES: index < size()
  std::string At(std::uint64_t index) const;
  // A random value: a function of `key`, two numbers.
  std::string Draw(std::uint64_t key, std::uint64_t counter) const;
  // The numbers that a draw can have are within these; nothing if it can be something else.
  std::optional<Interval> NumberBounds() const;
  // Whether a draw can have this value.
  bool Contains(const std::string& value) const;
  // Values that a draw can have and that are simpler than `value`, the simplest first: earlier in a list, nearer to
  // the lower end of a range, of fewer digits.
  std::vector<std::string> SimplerThan(const std::string& value) const;
  // A value near to `value`; `amount` in (0, 1]: how far, as a part of all values.
  std::string Near(const std::string& value, double amount, std::uint64_t key, std::uint64_t counter) const;
  // "one of 5, 20, 50", "1 to 200", "uniform in 0.1 to 2": for messages and reports.
  std::string Describe() const;

 private:
  enum class Kind : std::uint8_t { kValues, kRange, kUniform, kNormal };

  explicit Variation(ValuePath path) : path_(std::move(path)) {}
  std::string NumberText(double number) const;

  ValuePath path_;
  SourceLocation where_;
  Kind kind_ = Kind::kValues;
  std::vector<std::string> values_;  // kValues: JSON
  double from_ = 0.0;                // kRange, kUniform, and the bounds of kNormal
  double to_ = 0.0;
  double step_ = 1.0;  // kRange
  double mean_ = 0.0;  // kNormal
  double deviation_ = 0.0;
};

}  // namespace troupe
