#include "transport/wire/message_bytes.h"

#include <type_traits>
#include <utility>

#include "transport/dds/convert/convert.h"
#include "transport/wire/cdr.h"

namespace troupe::wire {

template <typename Message>
std::vector<std::byte> ToBytes(const Message& message) {
  dds::WireArena arena;
  return ToCdr(dds::ToWire(message, arena));
}

template <typename Message>
Result<Message> FromBytes(std::span<const std::byte> bytes) {
  using Wire = decltype(dds::ToWire(std::declval<const Message&>(), std::declval<dds::WireArena&>()));
  const Result<Sample<Wire>> sample = FromCdr<Wire>(bytes);
  if (!sample.ok()) return sample.error();
  const Wire& wire = sample.value().data();
  if constexpr (requires(Message & message) { dds::FromWire(wire, message); }) {
    Message message;
    if constexpr (std::is_same_v<Message, FrameMessage>) {
      if (!wire.whole) return Error{{}, "bytes of a frame of changes, expected a whole one"};
    }
    if (Status malformed = dds::FromWire(wire, message); !malformed.ok()) return malformed.error();
    return message;
  } else {
    return dds::FromWire(wire);
  }
}

template std::vector<std::byte> ToBytes(const SessionMessage&);
template std::vector<std::byte> ToBytes(const JoinMessage&);
template std::vector<std::byte> ToBytes(const std::vector<AdmissionMessage>&);
template std::vector<std::byte> ToBytes(const FrameMessage&);
template std::vector<std::byte> ToBytes(const FrameRequest&);
template std::vector<std::byte> ToBytes(const HistoryMessage&);
template std::vector<std::byte> ToBytes(const ProposalMessage&);
template std::vector<std::byte> ToBytes(const ControlRequest&);
template std::vector<std::byte> ToBytes(const ControlReply&);
template std::vector<std::byte> ToBytes(const StatusMessage&);

template Result<SessionMessage> FromBytes(std::span<const std::byte>);
template Result<JoinMessage> FromBytes(std::span<const std::byte>);
template Result<std::vector<AdmissionMessage>> FromBytes(std::span<const std::byte>);
template Result<FrameMessage> FromBytes(std::span<const std::byte>);
template Result<FrameRequest> FromBytes(std::span<const std::byte>);
template Result<HistoryMessage> FromBytes(std::span<const std::byte>);
template Result<ProposalMessage> FromBytes(std::span<const std::byte>);
template Result<ControlRequest> FromBytes(std::span<const std::byte>);
template Result<ControlReply> FromBytes(std::span<const std::byte>);
template Result<StatusMessage> FromBytes(std::span<const std::byte>);

}  // namespace troupe::wire
