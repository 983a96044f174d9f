#include "worldfile/edit/written_model.h"

#include <nlohmann/json.hpp>

#include "worldfile/edit/text_change.h"
#include "worldfile/stage/stage_tree.h"
#include "worldfile/text/quote.h"

namespace troupe {
namespace {

constexpr std::size_t kLongLine = 110;  // bytes

std::string ToStage(const WrittenScalar& scalar) {
  if (const auto* number = std::get_if<WrittenNumber>(&scalar)) return number->text;
  return '"' + std::get<std::string>(scalar) + '"';
}

// Stage's numbers may begin with a point or a plus.
std::string ToJson(const WrittenScalar& scalar) {
  if (const auto* number = std::get_if<WrittenNumber>(&scalar)) {
    std::string text = number->text;
    if (text.starts_with('+')) text.erase(0, 1);
    if (text.starts_with('.')) text.insert(0, "0");
    if (text.starts_with("-.")) text.insert(1, "0");
    if (text.ends_with('.')) text.pop_back();
    if (nlohmann::json::accept(text)) return text;
    return PlainNumber(std::strtod(number->text.c_str(), nullptr), 6);
  }
  return nlohmann::json(std::get<std::string>(scalar)).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

template <typename Write>
std::string Joined(const std::vector<WrittenScalar>& tuple, const char* separator, Write write) {
  std::string text = "[";
  for (const WrittenScalar& scalar : tuple) {
    if (text.size() > 1) text += separator;
    text += write(scalar);
  }
  return text + "]";
}

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

WrittenValue Number(double value, int decimals) {
  return {WrittenScalar(WrittenNumber{PlainNumber(value, decimals)})};
}

WrittenValue Text(std::string text) {
  return {WrittenScalar(std::move(text))};
}

WrittenValue Tuple(const std::vector<double>& numbers, int decimals) {
  std::vector<WrittenScalar> tuple;
  for (const double number : numbers) tuple.emplace_back(WrittenNumber{PlainNumber(number, decimals)});
  return {std::move(tuple)};
}

Result<WrittenValue> ReadValueText(const std::string& text) {
  const std::string line = "value " + text;
  const Result<StageTree> tree = ParseStage(line, "");
  const bool is_one = tree.ok() && tree.value().statements.size() == 1 &&
                      tree.value().statements[0].kind == StatementKind::kProperty &&
                      text.find_first_of("#\r\n") == std::string::npos;
  if (!is_one) {
    return Error{{}, "found " + Quoted(text) + ", expected a number, a text in double quotes, or several in [ ]"};
  }
  const auto scalar = [&](const TextSpan& span) -> WrittenScalar {
    std::string word(span.Of(line));
    if (word.front() == '"') return word.substr(1, word.size() - 2);
    return WrittenNumber{std::move(word)};
  };
  const Statement& statement = tree.value().statements[0];
  if (line[statement.value.begin] != '[') return WrittenValue{scalar(statement.value)};
  std::vector<WrittenScalar> tuple;
  for (const StageElement& element : statement.elements) tuple.push_back(scalar(element.span));
  return WrittenValue{std::move(tuple)};
}

std::string ToStage(const WrittenValue& value) {
  if (const auto* scalar = std::get_if<WrittenScalar>(&value.content)) return ToStage(*scalar);
  return Joined(std::get<1>(value.content), " ", [](const WrittenScalar& each) { return ToStage(each); });
}

std::string ToStage(const Value& value) {
  const auto scalar = [](const Value::Scalar& each) -> WrittenScalar {
    if (const auto* number = std::get_if<Value::Number>(&each)) return WrittenNumber{number->text};
    return std::get<std::string>(each);
  };
  if (const auto* number = std::get_if<Value::Number>(&value.content)) return number->text;
  if (const auto* text = std::get_if<std::string>(&value.content)) return ToStage(WrittenScalar(*text));
  std::vector<WrittenScalar> tuple;
  for (const Value::Scalar& each : std::get<std::vector<Value::Scalar>>(value.content)) tuple.push_back(scalar(each));
  return ToStage(WrittenValue{std::move(tuple)});
}

std::string ToJson(const WrittenValue& value) {
  if (const auto* scalar = std::get_if<WrittenScalar>(&value.content)) return ToJson(*scalar);
  return Joined(std::get<1>(value.content), ", ", [](const WrittenScalar& each) { return ToJson(each); });
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

std::string ToStage(const WrittenModel& model, const std::string& indent, const std::string& end_of_line) {
  std::string line = model.type + "(";
  for (const auto& [name, value] : model.properties) line += " " + name + " " + ToStage(value);
  line += " )";
  const bool is_short = model.children.empty() && indent.size() + line.size() <= kLongLine;
  if (is_short || model.type == "block") return line;
  return model.type + end_of_line + BodyLines(model, indent, end_of_line);
}

std::string ToDefine(const WrittenModel& model, const std::string& name, const std::string& end_of_line) {
  return "define " + name + " " + model.type + end_of_line + BodyLines(model, "", end_of_line);
}

std::string ToScenarioEntry(const WrittenModel& model) {
  std::string text = "{";
  const auto add = [&](const std::string& key, const std::string& value) {
    text += (text.size() > 1 ? ", " : "") + ToJson(WrittenScalar(key)) + ": " + value;
  };
  std::string properties;
  for (const auto& [name, value] : model.properties) {
    if (name == "name") add(name, ToJson(value));
  }
  add("model", ToJson(WrittenScalar(model.type)));
  for (const auto& [name, value] : model.properties) {
    if (name == "pose" && model.type != "sensor") add(name, ToJson(value));
    if (name == "name" || (name == "pose" && model.type != "sensor")) continue;
    properties += (properties.empty() ? "" : ", ") + ToJson(WrittenScalar(name)) + ": " + ToJson(value);
  }
  if (!properties.empty()) add("properties", "{" + properties + "}");
  std::string children;
  for (const WrittenModel& child : model.children) children += (children.empty() ? "" : ", ") + ToScenarioEntry(child);
  if (!children.empty()) add("children", "[" + children + "]");
  return text + "}";
}

}  // namespace troupe
