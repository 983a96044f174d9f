#include "transport/dds/convert/convert_frame_request.h"

namespace troupe::dds {

troupe_wire_FrameRequest ToWire(const FrameRequest& message, WireArena&) {
  return {message.observer};
}

Result<FrameRequest> FromWire(const troupe_wire_FrameRequest& wire) {
  FrameRequest message;
  message.observer = wire.observer;
  return message;
}

}  // namespace troupe::dds
