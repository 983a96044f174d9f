#include "viewer/gateway/foxglove_client.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace troupe {
namespace {

constexpr auto kStatePeriod = std::chrono::milliseconds(30);  // between two states

bool IsWarning(EventType type) {
  return type == EventType::kLeft || type == EventType::kProposalRejected || type == EventType::kBlocked ||
         type == EventType::kStallBegan || type == EventType::kUnstable;
}

std::string TextOf(const NumberedEvent& numbered) {
  std::string text = ToString(numbered.event.type);
  for (const std::string& name : {numbered.names.robot, numbered.names.object, numbered.names.other}) {
    if (!name.empty()) text += " " + name;
  }
  const std::string& detail = numbered.event.detail;
  return detail.empty() ? text : text + ": " + detail;
}

}  // namespace

FoxgloveClient::FoxgloveClient(const std::string& name, const std::optional<PastStates::Range>& range)
    : name_(name), range_(range) {}

double FoxgloveClient::IntervalOf(const ShownState& shown) const {
  return shown.world->scene->world().interval_seconds();
}

void FoxgloveClient::Send(std::string content, bool is_text) {
  if (out_.size() < kMostWaiting) out_.push_back({std::make_shared<const std::string>(std::move(content)), is_text});
}

bool FoxgloveClient::NeedsMessage(const ShownState& shown) const {
  if (!out_.empty()) return true;
  if (shown.world == nullptr) return !introduced_ && !range_;
  return !introduced_ || shown.world->number != world_ ||
         (shown.version != version_ && Clock::now() - sent_at_ >= kStatePeriod);
}

std::optional<WebMessage> FoxgloveClient::Next(const ShownState& shown, const std::deque<NumberedEvent>& events) {
  if (out_.empty() && NeedsMessage(shown)) {
    if (!introduced_) {
      introduced_ = true;
      std::optional<foxglove::PlaybackRange> range;
      if (range_) range = {0, static_cast<foxglove::Time>(static_cast<double>(range_->last) * IntervalOf(shown) * 1e9)};
      Send(foxglove::ServerInfoText(name_, range), true);
      if (!range_) Send(foxglove::AdvertiseServicesText(), true);
    } else if (shown.world->number != world_) {
      ChangeWorld(shown);
    } else {
      SendState(shown, events);
    }
  }
  if (out_.empty()) return std::nullopt;
  WebMessage message = std::move(out_.front());
  out_.pop_front();
  return message;
}

void FoxgloveClient::ChangeWorld(const ShownState& shown) {
  std::vector<foxglove::Channel> before;
  for (const auto& [id, channel] : channels_) before.push_back(channel);
  if (!before.empty()) Send(foxglove::UnadvertiseText(before), true);
  channels_.clear();
  subscriptions_.clear();
  sent_once_.clear();
  suites_.clear();
  bodies_.emplace(*shown.world->scene);
  std::vector<foxglove::Channel> channels = foxglove::ChannelsOf(shown.world->scene->world());
  for (foxglove::Channel& channel : channels) {
    channel.id = next_channel_++;
    channels_.emplace(channel.id, channel);
  }
  Send(foxglove::AdvertiseText(channels), true);
  world_ = shown.world->number;
}

void FoxgloveClient::Apply(const foxglove::ClientMessage& message, const ShownState& shown) {
  if (const auto* subscribe = std::get_if<foxglove::Subscribe>(&message)) {
    for (const auto& [id, channel] : subscribe->subscriptions) {
      if (channels_.contains(channel)) subscriptions_[id] = channel;
    }
    version_ = 0;  // of no state: the present one is sent again
  } else if (const auto* unsubscribe = std::get_if<foxglove::Unsubscribe>(&message)) {
    for (const std::uint32_t id : unsubscribe->ids) {
      subscriptions_.erase(id);
      sent_once_.erase(id);
    }
  } else if (const auto* playback = std::get_if<foxglove::PlaybackControl>(&message); playback != nullptr && range_) {
    if (shown.world == nullptr) return;
    if (playback->seek) {
      const double last = static_cast<double>(range_->last);
      position_ = std::clamp(static_cast<double>(*playback->seek) / 1e9 / IntervalOf(shown), 0.0, last);
      position_new_ = true;
    }
    playing_ = playback->play;
    speed_ = playback->speed;
    advanced_at_ = Clock::now();
    SendPlaybackState(shown, playback->seek.has_value(), playback->request);
  }
}

void FoxgloveClient::SendPlaybackState(const ShownState& shown, bool did_seek, const std::string& request) {
  const bool ended = range_ && position_ >= static_cast<double>(range_->last);
  const auto status = playing_ ? (ended ? foxglove::PlaybackStatus::kEnded : foxglove::PlaybackStatus::kPlaying)
                               : foxglove::PlaybackStatus::kPaused;
  const auto time = static_cast<foxglove::Time>(std::llround(position_ * IntervalOf(shown) * 1e9));
  Send(foxglove::PlaybackStateMessage(status, time, speed_, did_seek, request), false);
}

std::optional<std::uint64_t> FoxgloveClient::PositionToShow(Clock::time_point now, const ShownState& shown) {
  if (!range_ || shown.world == nullptr) return std::nullopt;
  if (playing_) {
    const std::chrono::duration<double> passed = now - advanced_at_;
    advanced_at_ = now;
    const auto before = static_cast<std::uint64_t>(position_);
    position_ += static_cast<double>(speed_) * passed.count() / IntervalOf(shown);
    if (position_ >= static_cast<double>(range_->last)) {
      position_ = static_cast<double>(range_->last);
      SendPlaybackState(shown, false, {});
      playing_ = false;
    }
    position_new_ = position_new_ || static_cast<std::uint64_t>(position_) != before;
  }
  if (!std::exchange(position_new_, false)) return std::nullopt;
  return static_cast<std::uint64_t>(position_);
}

void FoxgloveClient::SendState(const ShownState& shown, const std::deque<NumberedEvent>& events) {
  version_ = shown.version;
  sent_at_ = Clock::now();
  Send(foxglove::TimeMessage(shown.time), false);
  const Scene& scene = *shown.world->scene;
  bool bodies_known = false;
  for (const auto& [subscription, id] : subscriptions_) {
    const foxglove::Channel& channel = channels_.at(id);
    const auto send = [&, number = subscription](const std::string& text) {
      Send(foxglove::DataMessage(number, shown.time, text), false);
    };
    switch (channel.kind) {
      case foxglove::ChannelKind::kScene:
      case foxglove::ChannelKind::kMap:
        if (std::exchange(sent_once_[subscription], world_) == world_) break;
        send(channel.kind == foxglove::ChannelKind::kScene ? foxglove::SceneText(scene, shown.time)
                                                           : foxglove::MapText(scene, shown.time));
        break;
      case foxglove::ChannelKind::kTransforms:
        send(foxglove::TransformsText(scene, *shown.state, shown.time));
        break;
      case foxglove::ChannelKind::kEvents:
        SendEvents(subscription, shown, events);
        break;
      case foxglove::ChannelKind::kScan:
        if (!std::exchange(bodies_known, true)) bodies_->Assign(*shown.state);
        SendScan(subscription, channel, shown);
        break;
    }
  }
}

void FoxgloveClient::SendScan(std::uint32_t subscription, const foxglove::Channel& channel, const ShownState& shown) {
  const Scene& scene = *shown.world->scene;
  SensorSuite& suite = suites_.try_emplace(channel.robot, scene, channel.robot).first->second;
  const RangerReading* const reading = suite.Measure(channel.sensor, {scene, *bodies_}, shown.state->tick).ranger();
  if (reading == nullptr || channel.scan >= reading->scans.size()) return;
  const std::string text = foxglove::ScanText(reading->scans[channel.scan], channel.frame, shown.time);
  Send(foxglove::DataMessage(subscription, shown.time, text), false);
}

void FoxgloveClient::SendEvents(std::uint32_t subscription, const ShownState& shown,
                                const std::deque<NumberedEvent>& events) {
  for (const NumberedEvent& event : events) {
    if (event.number <= event_) continue;
    event_ = event.number;
    const std::string text = foxglove::EventText(TextOf(event), IsWarning(event.event.type), shown.time);
    Send(foxglove::DataMessage(subscription, shown.time, text), false);
  }
}

void FoxgloveClient::Reply(std::uint64_t request, bool done, const std::string& problem, const std::string& json) {
  const auto known = calls_.find(request);
  if (known == calls_.end()) return;
  const Call call = known->second;
  calls_.erase(known);
  if (done) {
    Send(foxglove::ServiceResponse(call.service, call.call, json), false);
  } else {
    Send(foxglove::ServiceFailureText(call.service, call.call, problem), true);
  }
}

}  // namespace troupe
