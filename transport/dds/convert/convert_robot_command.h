// Commands to robots between messages and idl/robot_command.idl.
#pragma once

#include "idl/robot_command.h"
#include "transport/dds/binding/wire.h"
#include "troupe/result.h"
#include "troupe/robot_command.h"

namespace troupe::dds {

// The strings and sequences of the result live in the arena.
troupe_wire_RobotCommand ToWire(const RobotCommand& command, WireArena& arena);

// The error is a number that is not finite, or columns of different lengths. CheckRobotCommand compares with a world.
Result<RobotCommand> FromWire(const troupe_wire_RobotCommand& wire);

}  // namespace troupe::dds
