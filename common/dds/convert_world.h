// WorldDescription between its values and idl/world.idl.
#pragma once

#include "common/base/result.h"
#include "common/dds/wire.h"
#include "common/model/world_description.h"
#include "idl/world.h"

namespace troupe::dds {

// Good while the description and the arena live.
troupe_wire_World ToWire(const WorldDescription& world, WireArena& arena);

// An error when the peer sent what breaks the contract of idl/world.idl; `world` is then of no use.
Status FromWire(const troupe_wire_World& wire, WorldDescription& world);

}  // namespace troupe::dds
