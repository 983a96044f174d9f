#include "worldfile/edit/written_model.h"

#include <cstdlib>
#include <nlohmann/json.hpp>

#include "common/base/json.h"
#include "worldfile/edit/stage_edit.h"
#include "worldfile/stage/stage_world.h"
#include "worldfile/text/text_file.h"

namespace troupe {
namespace {

constexpr std::size_t kLongLine = 110;  // bytes

// Stage's numbers may begin with a point or a plus.
std::string ScalarToJson(const Value::Scalar& scalar) {
  const auto* const number = std::get_if<Value::Number>(&scalar);
  if (number == nullptr) return JsonText(nlohmann::json(std::get<std::string>(scalar)));
  std::string text = number->text;
  if (text.starts_with('+')) text.erase(0, 1);
  if (text.starts_with('.')) text.insert(0, "0");
  if (text.starts_with("-.")) text.insert(1, "0");
  if (text.ends_with('.')) text.pop_back();
  // The spelling of the file where JSON allows it; else its value (Stage accepts "007" and "1.2.3").
  return nlohmann::json::accept(text) ? text : PlainNumber(number->value, 6);
}

std::string Joined(const Value& value, const char* separator, std::string (*write)(const Value::Scalar&)) {
  if (const auto* number = std::get_if<Value::Number>(&value.content)) return write(*number);
  if (const auto* text = std::get_if<std::string>(&value.content)) return write(*text);
  std::string tuple = "[";
  for (const Value::Scalar& scalar : std::get<Value::Tuple>(value.content)) {
    if (tuple.size() > 1) tuple += separator;
    tuple += write(scalar);
  }
  return tuple + "]";
}

// Two blanks for each level, as in the files of Stage.
std::string BodyLines(const WrittenModel& model, const std::string& indent, const std::string& end_of_line) {
  std::string text = indent + "(" + end_of_line;
  for (const auto& [name, value] : model.properties) {
    text.append(indent).append("  ").append(name).append(" ").append(ToStage(value)).append(end_of_line);
  }
  for (const WrittenModel& child : model.children) {
    text.append(indent).append("  ").append(ToStage(child, indent + "  ", end_of_line)).append(end_of_line);
  }
  return text + indent + ")";
}

}  // namespace

Value::Number RoundedNumber(double value, int decimals) {
  std::string text = PlainNumber(value, decimals);
  return {std::strtod(text.c_str(), nullptr), std::move(text)};
}

Value Number(double value, int decimals) {
  return {RoundedNumber(value, decimals), {}};
}

Value Text(std::string text) {
  return {std::move(text), {}};
}

Value Tuple(const std::vector<double>& numbers, int decimals) {
  Value::Tuple tuple;
  for (const double number : numbers) tuple.emplace_back(RoundedNumber(number, decimals));
  return {std::move(tuple), {}};
}

// By the parser of files, as the value of a property: what the page sends is what a file may have. Line ends and
// comments would add statements.
Result<Value> ReadValueText(const std::string& text) {
  const Result<StageTree> tree = ParseStage("value " + text, "");
  const bool is_one = tree.ok() && tree.value().statements.size() == 1 &&
                      tree.value().statements[0].kind == StatementKind::kProperty &&
                      text.find_first_of("#\r\n") == std::string::npos;
  if (!is_one) {
    return Error{{}, "found " + Quoted(text) + ", expected a number, a text in double quotes, or several in [ ]"};
  }
  return ValueOf(tree.value(), tree.value().statements[0]);
}

std::string ToStage(const Value::Scalar& scalar) {
  if (const auto* number = std::get_if<Value::Number>(&scalar)) return number->text;
  return '"' + std::get<std::string>(scalar) + '"';
}

std::string ToStage(const Value& value) {
  return Joined(value, " ", [](const Value::Scalar& scalar) { return ToStage(scalar); });
}

std::string ToJson(const Value& value) {
  return Joined(value, ", ", ScalarToJson);
}

WrittenModel WrittenBlock(const std::vector<Vec2>& outline, double z_min, double z_max) {
  WrittenModel block{"block", {}, {}};
  block.Set("points", Number(static_cast<double>(outline.size())));
  for (std::size_t i = 0; i < outline.size(); ++i) {
    block.Set("point[" + std::to_string(i) + "]", Tuple({outline[i].x(), outline[i].y()}));
  }
  block.Set("z", Tuple({z_min, z_max}));
  return block;
}

// On one line where it is short enough to be read.
std::string ToStage(const WrittenModel& model, const std::string& indent, const std::string& end_of_line) {
  std::string line = model.type + "(";
  for (const auto& [name, value] : model.properties) line += " " + name + " " + ToStage(value);
  line += " )";
  const bool is_short = model.children.empty() && indent.size() + line.size() <= kLongLine;
  // Blocks are one line each, however long: the corners are one value of many parts.
  if (is_short || model.type == "block") return line;
  return model.type + end_of_line + BodyLines(model, indent, end_of_line);
}

std::string ToDefine(const WrittenModel& model, const std::string& name, const std::string& end_of_line) {
  return "define " + name + " " + model.type + end_of_line + BodyLines(model, "", end_of_line);
}

// `name`, `model` and `pose` are keys of an entry; all else is in `properties`. A sensor's pose is a property of the
// world file.
std::string ToScenarioEntry(const WrittenModel& model) {
  std::string text = "{";
  const auto add = [&](const std::string& key, const std::string& value) {
    text += (text.size() > 1 ? ", " : "") + ScalarToJson(key) + ": " + value;
  };
  std::string properties;
  for (const auto& [name, value] : model.properties) {
    if (name == "name") add(name, ToJson(value));
  }
  add("model", ScalarToJson(model.type));
  for (const auto& [name, value] : model.properties) {
    if (name == "pose" && model.type != "sensor") add(name, ToJson(value));
    if (name == "name" || (name == "pose" && model.type != "sensor")) continue;
    properties += (properties.empty() ? "" : ", ") + ScalarToJson(name) + ": " + ToJson(value);
  }
  if (!properties.empty()) add("properties", "{" + properties + "}");
  std::string children;
  for (const WrittenModel& child : model.children) children += (children.empty() ? "" : ", ") + ToScenarioEntry(child);
  if (!children.empty()) add("children", "[" + children + "]");
  return text + "}";
}

}  // namespace troupe
