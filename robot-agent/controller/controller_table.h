// The built-in controllers and their parameters as a table, for help and for forms: docs/controllers.md describes them.
// A test compares it with what the controllers read.
//
// Users read these texts in help and forms: one sentence each. Defaults are texts,
// in JSON, because some are lists.
#pragma once

#include <span>
#include <string_view>

namespace troupe {

struct ParameterHelp {
  std::string_view name;
  std::string_view form;     // "number", "flag" (true or false), "json": any value, as `initial` or `help` shows it
  std::string_view unit;     // empty: none
  std::string_view initial;  // the default, or of a `needed` one an example, as JSON; empty: none
  double least = 0.0;        // of a number
  double most = 0.0;
  std::string_view help;
  bool needed = false;
};

struct ControllerHelp {
  std::string_view name;
  std::string_view help;
  std::span<const ParameterHelp> parameters;
};

// Sorted by name.
std::span<const ControllerHelp> ControllerTable();

}  // namespace troupe
