#include "transport/dds/transport/frame_stream.h"

namespace troupe::dds {
namespace {

// Ticks between whole frames, for listeners that send no requests.
constexpr Tick kWholePeriod = 100;

// A frame is sent to the observers as a whole at most once in this time (s). An observer that has not received it
// resends its request later than that.
constexpr double kWholeFrameInterval = 0.02;

bool HaveSameSizes(const WorldState& a, const WorldState& b) {
  return a.robots.size() == b.robots.size() && a.joints.size() == b.joints.size() &&
         a.grippers.size() == b.grippers.size() && a.objects.size() == b.objects.size() &&
         a.stores.size() == b.stores.size() && a.imus.size() == b.imus.size() && a.lights.size() == b.lights.size() &&
         a.cameras.size() == b.cameras.size();
}

}  // namespace

const WorldState* FrameStream::BaseOf(const FrameMessage& frame) const {
  // Every agent that answered the frame of the tick before has its state. To the others this frame is resent, whole.
  const bool follows = sent_ && frame.run == sent_->run && frame.edition == sent_->edition &&
                       frame.state.tick == sent_->state.tick + 1 && HaveSameSizes(frame.state, sent_->state);
  const bool whole = !follows || frame.paused || frame.last || frame.state.tick % kWholePeriod == 0;
  return whole ? nullptr : &sent_->state;
}

void FrameStream::Sent(const FrameMessage& frame) {
  sent_ = frame;
  sent_whole_at_.reset();
}

const FrameMessage* FrameStream::AnswerRequest(double now) {
  if (!sent_ || (sent_whole_at_ && now < *sent_whole_at_ + kWholeFrameInterval)) return nullptr;
  sent_whole_at_ = now;
  return &*sent_;
}

}  // namespace troupe::dds
