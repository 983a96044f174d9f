// Intern: one copy of a value that many objects have each, as the rays of the robots of a swarm, so that a cache of
// the processor has it.
//
// A short list of weak pointers instead of a map: values need equality only, and a world has few different ones. A
// missed value costs memory, never a wrong result.
#pragma once

#include <cstddef>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "troupe/shared.h"

namespace troupe {

// The value, shared with the objects that got an equal one lately. Safe to call from several threads.
template <typename T>
Shared<T> Intern(T value) {
  constexpr std::size_t kMaxKnown = 16;  // a world has few kinds of robots
  static std::mutex mutex;
  static std::vector<std::weak_ptr<const T>> known;
  const std::scoped_lock lock(mutex);
  std::erase_if(known, [](const std::weak_ptr<const T>& one) { return one.expired(); });
  for (const std::weak_ptr<const T>& one : known) {
    if (std::shared_ptr<const T> shared = one.lock(); shared != nullptr && *shared == value) return shared;
  }
  const auto added = std::make_shared<const T>(std::move(value));
  if (known.size() == kMaxKnown) known.erase(known.begin());
  known.push_back(added);
  return added;
}

}  // namespace troupe
