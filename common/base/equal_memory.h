// FindEqualMemory: large data that several processes compute alike, each for itself, can be held once for all of them.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <span>

namespace troupe {

// Memory with the same bytes that this process shares with others and that never changes, or null. A process that uses
// it instead of its own saves the memory, and finds it in the caches that the others have filled.
using FindEqualMemory = std::function<std::shared_ptr<const std::byte>(std::span<const std::byte> bytes)>;

}  // namespace troupe
