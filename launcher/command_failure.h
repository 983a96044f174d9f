// How a command ends that cannot do what it was asked.
#pragma once

#include "common/base/result.h"

namespace troupe {

// Tells the user, and returns the exit status.
int Fail(int exit_status, const Error& error);

}  // namespace troupe
