// Fail: the end of a command that has failed.
#pragma once

#include "troupe/result.h"

namespace troupe {

// Prints the error, and returns the exit status that follows from its code.
int Fail(const Error& error);

}  // namespace troupe
