#include "common/base/json_writer.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "common/base/json.h"

namespace troupe {

JsonWriter& JsonWriter::Value(double number) {
  if (!std::isfinite(number)) return Null();
  char digits[32];
  const char* const end = std::to_chars(digits, digits + sizeof digits, number).ptr;
  return Raw({digits, static_cast<std::size_t>(end - digits)});
}

JsonWriter& JsonWriter::Value(std::span<const double> numbers) {
  constexpr std::size_t kUsualDigits = 20;
  text_.reserve(text_.size() + kUsualDigits * numbers.size());
  BeginList();
  for (const double number : numbers) Value(number);
  return EndList();
}

JsonWriter& JsonWriter::Value(std::string_view text) {
  const auto is_plain = [](char c) { return c >= ' ' && c <= '~' && c != '"' && c != '\\'; };
  if (!std::all_of(text.begin(), text.end(), is_plain)) return Raw(JsonText(nlohmann::json(text)));
  Separate();
  text_ += '"';
  text_ += text;
  text_ += '"';
  return *this;
}

}  // namespace troupe
