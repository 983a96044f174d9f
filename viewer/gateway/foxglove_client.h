// FoxgloveClient: a viewer that speaks Foxglove's protocol (viewer/foxglove): its subscriptions, and the place at which
// it plays a recording.
//
// Unlike the page, such a client knows topics and not worlds: an edit that changes the world withdraws its channels and
// advertises new ones, with ids that are never used again, because a late subscription could otherwise get another
// topic. A client that does not read gets no further messages (kMaxWaiting), and delays no other.
//
// Playing a recording is done here and not by the client: its position advances with wall time times the chosen speed.
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/sensing/sensor_suite.h"
#include "viewer/foxglove/protocol.h"
#include "viewer/gateway/viewer.h"

namespace troupe {

class FoxgloveClient final : public Viewer {
 public:
  static constexpr std::size_t kMaxWaiting = 2000;  // messages; a client with more of them does not read

  // `spans`: of a recording; null: it is a run.
  FoxgloveClient(const ShownRun& run, const std::string& name, std::shared_ptr<const TimeSpans> spans)
      : Viewer(run), name_(name), spans_(std::move(spans)) {}

  Result<std::optional<PageRequest>> Receive(std::string_view message, bool is_text) override;
  void Answer(PageReply reply) override;
  bool NeedsMessage() const override;
  std::optional<WebMessage> Next() override;
  std::optional<std::uint64_t> PositionToShow() override;

 private:
  using Clock = std::chrono::steady_clock;

  struct Call {
    std::uint32_t service = 0;
    std::uint32_t call = 0;
  };

  // Another number is another state.
  std::uint64_t ShownVersion() const { return in_past_ ? shown()->position + 1 : run_.update; }
  foxglove::Time ShownTime() const;
  double Interval() const { return shown()->world->description().interval_seconds(); }
  void Send(std::string content, bool is_text);
  std::optional<PageRequest> RequestOf(const foxglove::ServiceCall& call);
  void Subscribe(const foxglove::Subscribe& subscribe);
  void Control(const foxglove::PlaybackControl& playback);
  // The server info is the first message, with the services of a run; then the channels of the world.
  void Introduce();
  // Withdraws the channels of the world before, and advertises those of the new one.
  void ChangeWorld();
  // All subscribed channels that the new state concerns.
  void SendState();
  void SendScan(std::uint32_t subscription, const foxglove::Channel& channel);
  void SendEvents(std::uint32_t subscription);
  void SendPlaybackState(bool did_seek, const std::string& request);

  const std::string name_;
  const std::shared_ptr<const TimeSpans> spans_;
  bool introduced_ = false;  // has the server info
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
  std::optional<Things> things_;

  bool playing_ = false;
  float speed_ = 1.0F;
  double position_ = 0.0;
  bool position_new_ = false;
  Clock::time_point advanced_at_;
};

}  // namespace troupe
