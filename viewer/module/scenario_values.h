// The values of a scenario that the reader of a page can change: numbers and flags that it states.
//
// Only values that are in the text: a default has no place in it, and would need the schema. Values are changed in the
// text (ScenarioText), so a changed scenario is loaded and checked as if the reader had written it.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "common/base/json_tree.h"

namespace troupe {

// [{"of": the robot, the rule or the scenario, "name", "path": as ValuePath, "value"}, ...], in the order of the text:
// numbers of robots, numbers of ticks, and the numbers and flags among the parameters of controllers. `root`: of the
// scenario.
nlohmann::json ChangeableValues(const JsonNode& root);

}  // namespace troupe
