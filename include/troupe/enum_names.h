// The names of the values of an enumeration, listed once, beside it, by a function that is found by its argument:
//
//   enum class LaneFacing : std::uint8_t { kAny, kForward, kBackward };
//   constexpr auto NamesOf(LaneFacing) {
//     return std::array{"any", "forward", "backward"};
//   }
//
// The values are 0, 1, ... in the order of the names, one for each: the list also says which values a peer may send.
// The names are those of files, command lines, messages and Python.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace troupe {

template <typename Value>
concept NamedEnum = std::is_enum_v<Value> && requires {
  NamesOf(Value());
};

// "unknown" for a number that is no value.
template <NamedEnum Value>
constexpr const char* NameOf(Value value) {
  constexpr auto kNames = NamesOf(Value());
  const auto index = static_cast<std::size_t>(value);
  return index < kNames.size() ? kNames[index] : "unknown";
}

template <NamedEnum Value>
constexpr std::optional<Value> FindByName(std::string_view name) {
  constexpr auto kNames = NamesOf(Value());
  for (std::size_t i = 0; i < kNames.size(); ++i) {
    if (name == kNames[i]) return static_cast<Value>(i);
  }
  return std::nullopt;
}

template <NamedEnum Value>
constexpr Value LastOf(Value) {
  return static_cast<Value>(NamesOf(Value()).size() - 1);
}

// In the order of the values.
template <NamedEnum Value>
std::vector<std::string> AllNames() {
  constexpr auto kNames = NamesOf(Value());
  return {kNames.begin(), kNames.end()};
}

// The words of Stage worlds for the values: their names, but for a type with words of its own beside it. Readers,
// writers and forms have them from here.
template <NamedEnum Value>
constexpr auto StageWordsOf(Value value) {
  return NamesOf(value);
}
// REQUIRES: a known value
template <NamedEnum Value>
constexpr const char* StageWordOf(Value value) {
  return StageWordsOf(Value())[static_cast<std::size_t>(value)];
}

}  // namespace troupe
