// CHECK(condition): a broken contract between parts of the program. It prints where and aborts, in every build type.
// Never for what a user typed or a peer sent: that is Result (result.h) or an event.
#pragma once

namespace troupe {

[[noreturn]] void CheckFailed(const char* condition, const char* file, int line);

}  // namespace troupe

#define TROUPE_CHECK(condition) ((condition) ? (void)0 : ::troupe::CheckFailed(#condition, __FILE__, __LINE__))
