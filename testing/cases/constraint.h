// Constraint: a condition that the draws of a case must meet, as `where` of a test has them: "spawn[0].count * 2 <= n".
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "testing/cases/variation.h"
#include "troupe/result.h"

namespace troupe {

class Constraint {
 public:
  // Names are the paths `names`; numbers, "texts" or 'texts', true and false; + - * /, comparisons, and, or, not. The
  // error's column counts from 1 in `text`.
  static Result<Constraint> Parse(std::string_view text, const std::vector<std::string>& names);

  // REQUIRES: `draws` begin with one for each name, in their order.
  bool Holds(const TestCase& draws) const;

 private:
  struct Parser;
  // Of texts only the equality counts.
  struct Value {
    double number = 0.0;
    std::string text;  // of a string
    bool is_text = false;
  };
  using Expression = std::function<Value(const TestCase& draws)>;

  explicit Constraint(Expression expression) : expression_(std::move(expression)) {}
  static Value ValueOf(const std::string& json);

  Expression expression_;
};

}  // namespace troupe
