#include "transport/dds/transport/observer_protocol.h"

#include <utility>

namespace troupe::dds {

bool ObserverProtocol::OnEnd(RunId run) {
  if (world_editions_.erase(run) == 0) return false;
  if (follower_.known() && follower_.frame().run == run) follower_.Reset();
  return world_editions_.empty();
}

Status ObserverProtocol::OnFrame(const troupe_wire_Frame& frame) {
  return follower_.Read(frame);
}

Status ObserverProtocol::OnWholeFrame(const troupe_wire_Frame& frame) {
  requested_at_.reset();
  Status malformed = follower_.Read(frame);
  if (std::exchange(again_, false)) returned_.reset();
  return malformed;
}

const FrameMessage* ObserverProtocol::Next() {
  if (!follower_.known()) return nullptr;
  const FrameMessage& frame = follower_.frame();
  const auto world = world_editions_.find(frame.run);
  if (world == world_editions_.end() || world->second != frame.world_edition) return nullptr;
  const FrameKey key(frame.run, frame.edition, frame.state.tick, frame.paused, frame.last);
  if (returned_ == key) return nullptr;
  returned_ = key;
  return &frame;
}

bool ObserverProtocol::IsBehind() const {
  if (follower_.has_gap() || !follower_.known()) return true;
  const FrameMessage& frame = follower_.frame();
  if (!world_editions_.contains(frame.run)) return true;
  return status_ && status_->run == frame.run &&
         std::tie(status_->edition, status_->tick) > std::tie(frame.edition, frame.state.tick);
}

bool ObserverProtocol::MayRequest(double now) {
  if (world_editions_.empty()) return false;
  if (requested_at_ && now < *requested_at_ + kRequestPeriod) return false;
  requested_at_ = now;
  return true;
}

}  // namespace troupe::dds
