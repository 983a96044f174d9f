// The results in the responses of simulation_interfaces.
#pragma once

#include <cstdint>
#include <string>

#include "ros/connection/simulation_types.h"
#include "transport/dds/binding/wire.h"
#include "transport/protocol/messages.h"

namespace troupe {

// The codes of simulation_interfaces/msg/Result.
enum class ResultCode : std::uint8_t {
  kUnsupported = 0,
  kOk = 1,
  kNotFound = 2,
  kIncorrectState = 3,
  kOperationFailed = 4,
};

// Of the services about the loaded world.
inline constexpr std::uint8_t kNoWorldLoaded = 101;

// `code`: of ResultCode, or one that a service adds, from 101 on.
inline simulation_interfaces_msg_dds__Result_ MakeResult(std::uint8_t code, const std::string& problem,
                                                         dds::WireArena& arena) {
  return {code, arena.Copy(problem)};
}
inline simulation_interfaces_msg_dds__Result_ MakeResult(ResultCode code, const std::string& problem,
                                                         dds::WireArena& arena) {
  return MakeResult(static_cast<std::uint8_t>(code), problem, arena);
}

inline ResultCode CodeOf(const ControlReply& reply) {
  return reply.done ? ResultCode::kOk : ResultCode::kOperationFailed;
}
inline simulation_interfaces_msg_dds__Result_ MakeResult(const ControlReply& reply, dds::WireArena& arena) {
  return MakeResult(CodeOf(reply), reply.problem, arena);
}

}  // namespace troupe
