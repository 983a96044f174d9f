// CHECK(condition): a broken contract between parts of the program. It prints the place and aborts, in every build
// type. Never for the input of a user or a peer: that is a Result (result.h) or an event.
#pragma once

namespace troupe {

[[noreturn]] void CheckFailed(const char* condition, const char* file, int line);

}  // namespace troupe

#define TROUPE_CHECK(condition) ((condition) ? (void)0 : ::troupe::CheckFailed(#condition, __FILE__, __LINE__))
