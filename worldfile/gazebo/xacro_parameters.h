// The parameters of a macro of xacro: "name side:=1 radius:=^|0.1 *origin **extra".
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace troupe {

struct XacroParameter {
  std::string name;
  std::optional<std::string> otherwise;  // not yet evaluated
  bool inherits = false;                 // from the scope of the call
  int stars = 0;                         // 1: an element, 2: its content
};

// The words of a list, in which quotes and brackets keep blanks together.
std::vector<std::string> ParameterWords(const std::string& text);

XacroParameter ParameterOf(std::string word);

}  // namespace troupe
