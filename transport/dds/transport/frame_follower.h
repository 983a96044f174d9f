// FrameFollower: rebuilds the states of a run from its frames on the wire, most of which have only the changes since
// the frame before. Not thread-safe.
#pragma once

#include "idl/frame.h"
#include "transport/protocol/messages.h"
#include "troupe/result.h"

namespace troupe::dds {

class FrameFollower {
 public:
  // Brings frame() up to this one. A frame that is older, or has the changes since a missing frame, has no effect. The
  // error is that of a frame that breaks the contract of idl/frame.idl; frame() is then unknown.
  Status Read(const troupe_wire_Frame& wire);

  // The newest frame that could be read, with its whole state. REQUIRES: known().
  const FrameMessage& frame() const { return frame_; }
  bool known() const { return known_; }
  // A later frame than frame() was seen, but could not be read. Only a whole frame helps.
  bool has_gap() const { return has_gap_; }

  void Reset() { *this = FrameFollower(); }

 private:
  FrameMessage frame_;
  bool known_ = false;
  bool has_gap_ = false;
};

}  // namespace troupe::dds
