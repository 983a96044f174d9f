// WrittenModel: a model to be added to a file, and its text in the two languages.
//
// Numbers are rounded when the value is made, not when it is written: what a form shows, what the file gets and what a
// later comparison reads are then the same number. Four decimals are 0.1 mm for metres and 0.4 mm at 200 m for degrees.
// No exponents: the Stage language has none.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "troupe/result.h"
#include "troupe/vec2.h"
#include "worldfile/stage/world_tree.h"

namespace troupe {

// Values to be written. Numbers are rounded to these decimals.
Value::Number RoundedNumber(double value, int decimals = 4);
Value Number(double value, int decimals = 4);
Value Text(std::string text);
Value Tuple(const std::vector<double>& numbers, int decimals = 4);

// One value of the Stage language, as a user types it. The error says what was found.
Result<Value> ReadValueText(const std::string& text);

// A number keeps the form in which it was read.
std::string ToStage(const Value::Scalar& scalar);
std::string ToStage(const Value& value);
std::string ToJson(const Value& value);

struct WrittenModel {
  std::string type;  // a type or a define, or "block", "sensor"
  std::vector<std::pair<std::string, Value>> properties;
  std::vector<WrittenModel> children;

  void Set(std::string name, Value value) { properties.emplace_back(std::move(name), std::move(value)); }
};

// A block with these corners, m, and heights.
WrittenModel WrittenBlock(const std::vector<Vec2>& outline, double z_min, double z_max);

// On one line if it is short. `indent`: of its first line, which the text does not begin with.
std::string ToStage(const WrittenModel& model, const std::string& indent, const std::string& end_of_line);
// `define NAME TYPE ( ... )`, always on several lines.
std::string ToDefine(const WrittenModel& model, const std::string& name, const std::string& end_of_line);

// An entry of "models", "robots" or "children" of a scenario, on one line: "name" and "pose" are members of their own,
// the pose in metres and degrees.
std::string ToScenarioEntry(const WrittenModel& model);

}  // namespace troupe
