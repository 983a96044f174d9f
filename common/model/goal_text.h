// Texts by which a controller says how a goal of a user ended, and by which tools know it (EventType::kSaid).
#pragma once

namespace troupe {

// Followed by the point and the reason.
inline constexpr const char* kGaveUpGoal = "gave up the goal";

// The start of the line with the last words of a robot's controller in the signals of its report, before an object with
// the keys "tick" and "text".
inline constexpr const char* kSaidLine = "said";

}  // namespace troupe
