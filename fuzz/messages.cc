// Feed any bytes to the receivers of the types in idl/: from CDR to a sample, and by its converter to a message, which
// then has to return from its own bytes as it is.
#include "common/spatial/scene.h"
#include "fuzz/targets.h"
#include "fuzz/whole_sample.h"
#include "transport/dds/convert/convert.h"
#include "transport/wire/cdr.h"
#include "transport/wire/message_bytes.h"

namespace troupe::fuzz {
namespace {

// The message of the bytes; nothing if they are refused. Numbers that are not finite pass where the receiver checks
// them later, so messages are compared by their bytes.
template <typename Message, typename Wire>
std::optional<Message> Read(Bytes bytes) {
  Result<Message> message = wire::FromBytes<Message>(WholeSample<Wire>(bytes));
  if (!message.ok()) {
    Check(!message.error().message.empty());
    return std::nullopt;
  }
  // Reading and writing are inverse: what a receiver accepts it would pass on unchanged.
  const std::vector<std::byte> own = wire::ToBytes(message.value());
  const Result<Message> again = wire::FromBytes<Message>(own);
  Check(again.ok());
  Check(wire::ToBytes(again.value()) == own);
  return std::move(message).value();
}

FrameMessage FirstFrame() {
  FrameMessage frame;
  frame.run = 1;
  frame.state.tick = 7;
  frame.state.robots.resize(3);
  frame.state.joints.resize(2);
  frame.state.grippers.resize(1);
  frame.state.objects.resize(2);
  return frame;
}

}  // namespace

void Session(Bytes bytes) {
  if (const auto session = Read<SessionMessage, troupe_wire_Session>(bytes)) {
    Check(Validate(session->world).ok());
    static_cast<void>(Hash(session->world));
    const Scene scene(session->world);
    Check(scene.body_count() ==
          scene.world().robots.size() + scene.world().objects.size() + scene.world().people.size());
  }
}
void Join(Bytes bytes) {
  Read<JoinMessage, troupe_wire_Join>(bytes);
}
void Admissions(Bytes bytes) {
  Read<std::vector<AdmissionMessage>, troupe_wire_Admissions>(bytes);
}
void Frame(Bytes bytes) {
  Read<FrameMessage, troupe_wire_Frame>(bytes);
}
void Changes(Bytes bytes) {
  const auto sample = wire::FromCdr<troupe_wire_Frame>(WholeSample<troupe_wire_Frame>(bytes));
  if (!sample.ok()) return;
  FrameMessage frame = FirstFrame();
  if (!dds::CanRead(sample.value().data(), frame)) return;
  if (const troupe::Status malformed = dds::FromWire(sample.value().data(), frame); !malformed.ok()) {
    Check(!malformed.error().message.empty());
    Check(frame.state.robots.empty());
  }
}
void FrameRequest(Bytes bytes) {
  Read<troupe::FrameRequest, troupe_wire_FrameRequest>(bytes);
}
void History(Bytes bytes) {
  Read<HistoryMessage, troupe_wire_History>(bytes);
}
void Proposal(Bytes bytes) {
  Read<ProposalMessage, troupe_wire_Proposal>(bytes);
}
void Control(Bytes bytes) {
  Read<ControlRequest, troupe_wire_Control>(bytes);
}
void ControlReply(Bytes bytes) {
  Read<troupe::ControlReply, troupe_wire_ControlReply>(bytes);
}
void Status(Bytes bytes) {
  Read<StatusMessage, troupe_wire_Status>(bytes);
}

}  // namespace troupe::fuzz
