#include <string>
#include <type_traits>
#include <utility>
#include <variant>

#include "transport/dds/convert/convert.h"
#include "transport/dds/convert/structs.h"

namespace troupe::dds {
namespace {

template <std::size_t number>
using Request = std::variant_alternative_t<number, control::Request>;

template <std::size_t number>
constexpr bool HasParameters() {
  return kMemberCount < Request < number >>> 0;
}

// The sequence with the parameters of a type of requests: those follow each other in the order of the types.
template <std::size_t number, typename Wire>
auto& ParametersIn(Wire& wire) {
  constexpr std::size_t place = []<std::size_t... I>(std::index_sequence<I...>) {
    return (std::size_t{3} + ... + (HasParameters<I>() ? 1 : 0));
  }
  (std::make_index_sequence<number>());
  return std::get<place>(MembersOf(wire));
}

// Calls visit.operator()<number>() for the type of that number. False if there is none.
template <typename Visit>
bool VisitType(std::size_t type, const Visit& visit) {
  return [&]<std::size_t... I>(std::index_sequence<I...>) {
    return (... || (type == I && (visit.template operator()<I>(), true)));
  }
  (std::make_index_sequence<std::variant_size_v<control::Request>>());
}

}  // namespace

troupe_wire_Control ToWire(const ControlRequest& message, WireArena& arena) {
  troupe_wire_Control wire{};
  wire.client = message.client;
  wire.number = message.number;
  wire.request = static_cast<std::uint8_t>(message.request.index());
  VisitType(message.request.index(), [&]<std::size_t number>() {
    if constexpr (HasParameters<number>()) {
      auto* const parameters = arena.Fill(ParametersIn<number>(wire), 1);
      StructWriter(arena).Write(std::get<number>(message.request), *parameters);
    }
  });
  return wire;
}

// Parameters of other requests are left out; those of this one may be out of their bounds: CheckRequest.
Result<ControlRequest> FromWire(const troupe_wire_Control& wire) {
  ControlRequest message{wire.client, wire.number, {}};
  Status status;
  const bool is_known = VisitType(wire.request, [&]<std::size_t number>() {
    Request<number>& request = message.request.emplace<number>();
    if constexpr (HasParameters<number>()) {
      const auto parameters = Elements(ParametersIn<number>(wire));
      status = parameters.size() == 1 ? StructReader().Read(parameters.front(), request)
                                      : Status(Error{{}, "control request without its parameters, or with several"});
    }
  });
  if (!is_known) {
    return Error{{},
                 "control request " + std::to_string(wire.request) + ", expected 0 to " +
                     std::to_string(std::variant_size_v<control::Request> - 1)};
  }
  if (!status.ok()) return status.error();
  return message;
}

troupe_wire_ControlReply ToWire(const ControlReply& message, WireArena& arena) {
  return WriteStruct<troupe_wire_ControlReply>(message, arena);
}

Result<ControlReply> FromWire(const troupe_wire_ControlReply& wire) {
  return ReadStruct<ControlReply>(wire);
}

troupe_wire_RobotCommand ToWire(const RobotCommand& command, WireArena& arena) {
  return WriteStruct<troupe_wire_RobotCommand>(command, arena);
}

Result<RobotCommand> FromWire(const troupe_wire_RobotCommand& wire) {
  return ReadStruct<RobotCommand>(wire);
}

}  // namespace troupe::dds
