// Command lines, as lists of words.
#pragma once

#include <sstream>
#include <string>
#include <vector>

namespace troupe::test {

// The words of a line. Each word "%" stands for the next of `values`, whatever that contains.
inline std::vector<std::string> Words(const std::string& line, const std::vector<std::string>& values = {}) {
  std::vector<std::string> words;
  std::istringstream text(line);
  auto value = values.begin();
  for (std::string word; text >> word;) words.push_back(word == "%" ? *value++ : word);
  return words;
}

inline std::vector<std::string> operator+(std::vector<std::string> words, const std::vector<std::string>& more) {
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

}  // namespace troupe::test
