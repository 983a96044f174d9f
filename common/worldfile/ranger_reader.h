// Reads what a `ranger` measures: its sensors and how often. Private to this folder.
#pragma once

#include "common/worldfile/build_context.h"

namespace troupe {

// The ranger of `reader`, without its name and model. `origin` is the body's pose in the model's frame.
RangerDescription ReadRanger(PropertyReader& reader, const Pose& origin, std::int64_t interval_ns);

}  // namespace troupe
