#include "viewer/editor/property_text.h"

#include <algorithm>
#include <cctype>

namespace troupe {
namespace {

std::string ScalarText(const Value::Scalar& scalar) {
  if (const auto* number = std::get_if<Value::Number>(&scalar)) return number->text;
  return '"' + std::get<std::string>(scalar) + '"';
}

}  // namespace

std::string ValueText(const Value& value) {
  if (const auto* number = std::get_if<Value::Number>(&value.content)) return number->text;
  if (const auto* text = std::get_if<std::string>(&value.content)) return '"' + *text + '"';
  std::string tuple = "[";
  for (const Value::Scalar& scalar : std::get<std::vector<Value::Scalar>>(value.content)) {
    tuple += (tuple.size() > 1 ? " " : "") + ScalarText(scalar);
  }
  return tuple + "]";
}

bool IsPropertyName(std::string_view name) {
  if (name.empty() || name.size() > 100 || std::isalpha(static_cast<unsigned char>(name[0])) == 0) return false;
  if (name == "include" || name == "define") return false;
  const std::size_t open = name.find('[');
  const std::string_view word = name.substr(0, open);
  const bool plain = std::all_of(word.begin(), word.end(), [](unsigned char c) {
    return std::isalnum(c) != 0 || c == '.' || c == '-' || c == '_';
  });
  if (open == std::string_view::npos || !plain) return plain;
  const std::string_view index = name.substr(open + 1, name.size() - open - 2);
  return name.back() == ']' && !index.empty() && index.size() < 5 &&
         std::all_of(index.begin(), index.end(), [](unsigned char c) { return std::isdigit(c) != 0; });
}

bool IsTypeName(std::string_view name) {
  return IsPropertyName(name) && name.find('[') == std::string_view::npos;
}

}  // namespace troupe
