// From the text of an expectation to a program for one world: names are resolved, types and units checked, windows
// converted to ticks. The only entrance to the compiler (compiler.h is private to this folder).
//
// A program is bound to the world of its scope: the ids in it are rows of that world's tables, and windows are in its
// tick length. A world with another number of robots needs another compilation; a monitor refuses its ticks. All
// mistakes of a text are found here, so that a run never stops because of one: at run time only NaN remains, and it
// makes comparisons false.
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
