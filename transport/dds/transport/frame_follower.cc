#include "transport/dds/transport/frame_follower.h"

#include <tuple>

#include "transport/dds/convert/convert_frame.h"

namespace troupe::dds {

Status FrameFollower::Read(const troupe_wire_Frame& wire) {
  if (known_ && wire.run == frame_.run) {
    const auto known = std::tie(frame_.edition, frame_.state.tick);
    const auto next = std::tie(wire.edition, wire.tick);
    if (next < known || (next == known && !wire.whole)) return {};
  }
  if (!CanRead(wire, frame_) || (!wire.whole && !known_)) {
    has_gap_ = true;
    return {};
  }
  Status malformed = FromWire(wire, frame_);
  known_ = malformed.ok();
  has_gap_ = !known_;
  return malformed;
}

}  // namespace troupe::dds
