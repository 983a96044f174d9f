// WorldDescription between its values and idl/world.idl.
#pragma once

#include "idl/world.h"
#include "transport/dds/binding/wire.h"
#include "troupe/result.h"
#include "troupe/world_description.h"

namespace troupe::dds {

// Valid while the description and the arena live.
troupe_wire_World ToWire(const WorldDescription& world, WireArena& arena);

// An error when the description breaks the contract of idl/world.idl.
Result<WorldDescription> FromWire(const troupe_wire_World& wire);

}  // namespace troupe::dds
