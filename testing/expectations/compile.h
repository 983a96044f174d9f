// From the syntax of an expectation to a program for one world: names are resolved, types and units checked.
#pragma once

#include <string_view>

#include "testing/expectations/program.h"
#include "troupe/expectation.h"
#include "troupe/result.h"

namespace troupe {

// Errors: expectation.h.
Result<MonitorProgram> CompileExpectation(std::string_view text, const ExpectationScope& scope);
Result<MonitorProgram> CompileMetric(std::string_view text, const ExpectationScope& scope);

}  // namespace troupe
