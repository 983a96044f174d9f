// The worlds of simulated runs: small, but with contacts, so that the order of the robots counts.
#pragma once

#include <cstddef>
#include <memory>
#include <string>

#include "troupe/world_description.h"

namespace troupe::faults {

// The shared library of counting_controller.cc.
inline constexpr const char* kCountingController = TROUPE_COUNTING_CONTROLLER;

// `robots` robots "r0", "r1", ... that drive into each other and a box. `memory`: some have a controller that
// remembers.
WorldDescription RunWorld(std::size_t robots, bool memory);
// For `load`: other robots in another order.
std::shared_ptr<const WorldDescription> OtherWorld(bool memory);
// For `spawn` of "scout", a robot, or "crate", an object.
std::shared_ptr<const WorldDescription> WorldToSpawn(const std::string& source, bool memory);

}  // namespace troupe::faults
