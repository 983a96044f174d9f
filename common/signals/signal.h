// Signal: a quantity of the things of one kind, as users know it: in expectations, tables, plots and Python. It is a
// function of a world and a state, so that it is known of every state of a run, live or recorded.
//
// Each field of a row of the state is a signal (state_tables.h); derived_signals.cc has those that follow from fields.
//
// Numbers for all: a truth is 0 or 1, a text the place among its possible values, so that plots, expectations and
// tables need one function; NaN for "none". Signals are a pure function of the state: no signal remembers.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "troupe/world_state.h"

namespace troupe {

class Things;

// A state and the world that it belongs to.
struct SignalView {
  const Things& things;  // of `world`
  const WorldDescription& world;
  const WorldState& state;
};

// A thing has no number of that signal.
inline constexpr double kNoNumber = std::numeric_limits<double>::quiet_NaN();

enum class ValueType : std::uint8_t { kNumber, kTruth, kText };

struct Signal {
  std::string name;           // lower case, words separated by '_'; unique among the signals of a kind
  std::string unit;           // of kFieldUnits; empty: none
  std::string documentation;  // one line, without a capital and a full stop
  ValueType type = ValueType::kNumber;
  // The number of a row: 0 or 1 of a truth, the place among its possible values of a text. kNoNumber: it has none.
  std::function<double(const SignalView& view, std::size_t row)> number;
  // Of a text alone. Empty: it has none.
  std::function<std::string(const SignalView& view, std::size_t row)> text = {};
  // The texts that it can have in a world; none: any.
  std::function<std::vector<std::string>(const WorldDescription& world)> possible = {};
};

}  // namespace troupe
