// ObserverProtocol: the part of an observer in the tick protocol: from sessions and frames on the wire to the frames of
// a run in their order, with requests for whole ones after a gap. Without threads and without a clock: times are in s,
// of any clock that does not decrease. Not thread-safe.
#pragma once

#include <map>
#include <optional>
#include <tuple>

#include "transport/dds/transport/frame_follower.h"
#include "transport/protocol/messages.h"
#include "troupe/result.h"

namespace troupe::dds {

class ObserverProtocol {
 public:
  // s. After this time without an answer a request is resent: it, or the frame, was lost, or the service did not know
  // this observer yet. Longer than the time for which a service ignores further requests.
  static constexpr double kRequestPeriod = 0.05;

  void OnSession(RunId run, Edition world_edition) { world_editions_[run] = world_edition; }
  void OnStatus(const StatusMessage& status) { status_ = status; }
  // The service of the run has ended. True if it was the last one.
  bool OnEnd(RunId run);
  // The error is that of a malformed frame, which has no further effect.
  Status OnFrame(const troupe_wire_Frame& frame);
  // The answer to a request, or to that of another observer.
  Status OnWholeFrame(const troupe_wire_Frame& frame);

  // The newest frame, once, as soon as its world is known; else null. Valid until the next call of a function above.
  const FrameMessage* Next();

  // The next whole frame shall be returned by Next, even if it was already.
  void AskAgain() { again_ = true; }
  bool has_gap() const { return follower_.has_gap(); }
  // Newer frames exist than the newest that is known.
  bool IsBehind() const;
  // Whether to send a request now: not without a service, nor while the last one may still be answered.
  bool MayRequest(double now);

 private:
  // Run, edition, tick, paused, last: two frames that agree in these are the same.
  using FrameKey = std::tuple<RunId, Edition, Tick, bool, bool>;

  std::map<RunId, Edition> world_editions_;  // of the newest session of each run that has a live service
  FrameFollower follower_;
  std::optional<FrameKey> returned_;     // the newest frame that Next has returned
  std::optional<StatusMessage> status_;  // the newest
  std::optional<double> requested_at_;   // nothing: no request is open
  bool again_ = false;
};

}  // namespace troupe::dds
