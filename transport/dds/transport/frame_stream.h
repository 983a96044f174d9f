// FrameStream: the frames of a service as they travel: most as the changes since the frame before, some whole, and
// whole ones again for observers that have requested one. Without a clock: times are in s, of any clock that does not
// decrease. Not thread-safe.
#pragma once

#include <optional>

#include "transport/protocol/messages.h"

namespace troupe::dds {

class FrameStream {
 public:
  // The state that `frame` is to be sent as the changes of; null: it is to be sent whole. Valid until Sent.
  const WorldState* BaseOf(const FrameMessage& frame) const;
  void Sent(const FrameMessage& frame);

  // A request has arrived: the frame that is to be sent whole to the observers. Null if there is none, or it was sent
  // so recently that it will still arrive.
  const FrameMessage* AnswerRequest(double now);

 private:
  std::optional<FrameMessage> sent_;     // the newest
  std::optional<double> sent_whole_at_;  // to the observers; nothing: not yet
};

}  // namespace troupe::dds
