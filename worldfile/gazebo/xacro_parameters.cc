#include "worldfile/gazebo/xacro_parameters.h"

#include <utility>

namespace troupe {

std::vector<std::string> ParameterWords(const std::string& text) {
  std::vector<std::string> words;
  std::string word;
  char quote = 0;
  int brackets = 0;
  for (const char c : text) {
    const bool is_blank = c == ' ' || c == '\t' || c == '\n' || c == '\r';
    if (is_blank && quote == 0 && brackets == 0) {
      if (!word.empty()) words.push_back(std::exchange(word, ""));
      continue;
    }
    if (quote != 0) {
      if (c == quote) quote = 0;
    } else if (c == '\'' || c == '"') {
      quote = c;
    }
    brackets += c == '{' ? 1 : c == '}' ? -1 : 0;
    word += c;
  }
  if (!word.empty()) words.push_back(word);
  return words;
}

XacroParameter ParameterOf(std::string word) {
  XacroParameter parameter;
  while (word.starts_with('*')) {
    ++parameter.stars;
    word.erase(0, 1);
  }
  std::size_t sign = word.find(":=");
  std::size_t length = 2;
  if (sign == std::string::npos) {
    sign = word.find('=');
    length = 1;
  }
  parameter.name = word.substr(0, sign);
  if (sign == std::string::npos) return parameter;
  std::string text = word.substr(sign + length);
  if (text.starts_with('^')) {
    parameter.inherits = true;
    if (!text.starts_with("^|")) return parameter;
    text.erase(0, 2);
  }
  if (text.size() >= 2 && (text.front() == '\'' || text.front() == '"') && text.back() == text.front()) {
    text = text.substr(1, text.size() - 2);
  }
  parameter.otherwise = text;
  return parameter;
}

}  // namespace troupe
