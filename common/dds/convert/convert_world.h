// WorldDescription between its values and idl/world.idl.
#pragma once

#include "common/base/result.h"
#include "common/dds/binding/wire.h"
#include "common/model/world_description.h"
#include "idl/world.h"

namespace troupe::dds {

// Valid while the description and the arena live.
troupe_wire_World ToWire(const WorldDescription& world, WireArena& arena);

// An error when the description breaks the contract of idl/world.idl.
Result<WorldDescription> FromWire(const troupe_wire_World& wire);

}  // namespace troupe::dds
