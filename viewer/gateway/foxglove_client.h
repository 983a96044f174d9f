// FoxgloveClient: a viewer that speaks Foxglove's protocol (viewer/foxglove): its subscriptions, the messages that wait
// for it, and the place at which it plays a recording.
//
// Threads: one.
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/sensing/sensor_suite.h"
#include "viewer/foxglove/protocol.h"
#include "viewer/gateway/past_state.h"
#include "viewer/gateway/past_states.h"
#include "viewer/gateway/web_server.h"

namespace troupe {

// The state that a client is shown.
struct ShownState {
  const ViewedWorld* world = nullptr;  // null: none yet
  const WorldState* state = nullptr;
  std::uint64_t version = 0;  // another number is another state
  foxglove::Time time = 0;
};

class FoxgloveClient {
 public:
  using Clock = std::chrono::steady_clock;

  static constexpr std::size_t kMostWaiting = 2000;  // messages; a client with more of them does not read

  // `range`: of a recording.
  FoxgloveClient(const std::string& name, const std::optional<PastStates::Range>& range);

  // Applies a subscription or a playback control; ignores a service call.
  void Apply(const foxglove::ClientMessage& message, const ShownState& shown);

  // The next message, if there is one.
  std::optional<WebMessage> Next(const ShownState& shown, const std::deque<NumberedEvent>& events);
  bool NeedsMessage(const ShownState& shown) const;

  void Send(std::string content, bool is_text);
  // Remembers a call until its reply, which the request with this number is given.
  void Expect(std::uint64_t request, const foxglove::ServiceCall& call) { calls_[request] = {call.service, call.call}; }
  void Reply(std::uint64_t request, bool done, const std::string& problem, const std::string& json);

  // The position to seek to now, while a recording plays or after a seek.
  std::optional<std::uint64_t> PositionToShow(Clock::time_point now, const ShownState& shown);

 private:
  struct Call {
    std::uint32_t service = 0;
    std::uint32_t call = 0;
  };

  void ChangeWorld(const ShownState& shown);
  void SendState(const ShownState& shown, const std::deque<NumberedEvent>& events);
  void SendScan(std::uint32_t subscription, const foxglove::Channel& channel, const ShownState& shown);
  void SendEvents(std::uint32_t subscription, const ShownState& shown, const std::deque<NumberedEvent>& events);
  void SendPlaybackState(const ShownState& shown, bool did_seek, const std::string& request);
  double IntervalOf(const ShownState& shown) const;

  const std::string name_;
  const std::optional<PastStates::Range> range_;
  bool introduced_ = false;  // has the server info
  std::deque<WebMessage> out_;
  std::uint32_t world_ = 0;  // number of the world whose channels it knows
  std::uint32_t next_channel_ = 1;
  std::map<std::uint32_t, foxglove::Channel> channels_;   // by id, never used twice
  std::map<std::uint32_t, std::uint32_t> subscriptions_;  // by their ids: the channel
  std::map<std::uint32_t, std::uint32_t> sent_once_;      // by subscription: the world of its scene or map
  std::uint64_t version_ = 0;                             // that was sent
  Clock::time_point sent_at_;
  std::uint64_t event_ = 0;  // number of the last one sent
  std::map<std::uint64_t, Call> calls_;
  std::map<RobotId, SensorSuite> suites_;  // of world_
  std::optional<BodyIndex> bodies_;

  bool playing_ = false;
  float speed_ = 1.0F;
  double position_ = 0.0;
  bool position_new_ = false;
  Clock::time_point advanced_at_;
};

}  // namespace troupe
