#include "viewer/gateway/foxglove_client.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "common/base/json.h"

namespace troupe {
namespace {

constexpr auto kStatePeriod = std::chrono::milliseconds(30);  // between two states

bool IsWarning(EventType type) {
  return type == EventType::kLeft || type == EventType::kProposalRejected || type == EventType::kBlocked ||
         type == EventType::kStallBegan || type == EventType::kUnstable || type == EventType::kWaitBegan ||
         type == EventType::kNoWay;
}

std::string TextOf(const NumberedEvent& numbered) {
  std::string text = NameOf(numbered.event.type);
  for (const std::string& name : {numbered.names.robot, numbered.names.object, numbered.names.other}) {
    if (!name.empty()) text += " " + name;
  }
  const std::string& detail = numbered.event.detail;
  return detail.empty() ? text : text + ": " + detail;
}

}  // namespace

// A client of a recording has the time of its timeline, which never goes back.
foxglove::Time FoxgloveClient::ShownTime() const {
  const std::uint64_t count = in_past_ ? shown()->position : shown()->state->tick;
  return static_cast<foxglove::Time>(count) * static_cast<foxglove::Time>(shown()->world->description().interval_ns);
}

// Beyond the limit messages are dropped: the client does not read, and would otherwise fill the memory.
void FoxgloveClient::Send(std::string content, bool is_text) {
  if (waiting_.size() >= kMaxWaiting) return;
  waiting_.push_back({std::make_shared<const std::string>(std::move(content)), is_text});
}

// At most one state in kStatePeriod: JSON of all topics is larger than an update of the page.
bool FoxgloveClient::NeedsMessage() const {
  if (!waiting_.empty()) return true;
  if (shown() == nullptr) return !introduced_ && !spans_;
  return !introduced_ || shown()->world->number != world_ ||
         (ShownVersion() != version_ && Clock::now() - sent_at_ >= kStatePeriod);
}

std::optional<WebMessage> FoxgloveClient::Next() {
  if (waiting_.empty() && NeedsMessage()) {
    if (!introduced_) {
      Introduce();
    } else if (shown()->world->number != world_) {
      ChangeWorld();
    } else {
      SendState();
    }
  }
  return NextWaiting();
}

void FoxgloveClient::Introduce() {
  introduced_ = true;
  std::optional<foxglove::PlaybackRange> range;
  if (spans_) range = {0, static_cast<foxglove::Time>(static_cast<double>(spans_->last()) * Interval() * 1e9)};
  Send(foxglove::ServerInfoText(name_, range), true);
  if (!spans_) Send(foxglove::AdvertiseServicesText(), true);
}

// Suites and bodies are of the scene, and are made again.
void FoxgloveClient::ChangeWorld() {
  std::vector<foxglove::Channel> before;
  for (const auto& [id, channel] : channels_) before.push_back(channel);
  if (!before.empty()) Send(foxglove::UnadvertiseText(before), true);
  channels_.clear();
  subscriptions_.clear();
  sent_once_.clear();
  suites_.clear();
  const TimelineWorld& world = *shown()->world;
  bodies_.emplace(*world.scene);
  things_.emplace(world.description());
  std::vector<foxglove::Channel> channels = foxglove::ChannelsOf(world.description());
  for (foxglove::Channel& channel : channels) {
    channel.id = next_channel_++;
    channels_.emplace(channel.id, channel);
  }
  Send(foxglove::AdvertiseText(channels), true);
  world_ = world.number;
}

// A service call becomes a request for the gateway; the other messages concern this client alone.
Result<std::optional<PageRequest>> FoxgloveClient::Receive(std::string_view message, bool is_text) {
  const Result<foxglove::ClientMessage> parsed =
      is_text ? foxglove::ParseText(message) : foxglove::ParseBinary(message);
  if (!parsed.ok()) return parsed.error();
  std::optional<PageRequest> request;
  if (const auto* call = std::get_if<foxglove::ServiceCall>(&parsed.value())) {
    request = RequestOf(*call);
  } else if (const auto* subscribe = std::get_if<foxglove::Subscribe>(&parsed.value())) {
    Subscribe(*subscribe);
  } else if (const auto* unsubscribe = std::get_if<foxglove::Unsubscribe>(&parsed.value())) {
    for (const std::uint32_t id : unsubscribe->ids) {
      subscriptions_.erase(id);
      sent_once_.erase(id);
    }
  } else if (const auto* playback = std::get_if<foxglove::PlaybackControl>(&parsed.value())) {
    Control(*playback);
  }
  return request;
}

// A service is a request of the page.
std::optional<PageRequest> FoxgloveClient::RequestOf(const foxglove::ServiceCall& call) {
  calls_[call.call] = {call.service, call.call};
  Result<PageControl> control = ParseControl(call.call, call.command, call.json);
  if (control.ok()) return PageRequest(std::move(control).value());
  Answer(ReplyToControl(call.call, control.error()));
  return std::nullopt;
}

// A reply without a call is of a client that called twice with one id.
void FoxgloveClient::Answer(PageReply reply) {
  const auto known = calls_.find(reply.id);
  if (known == calls_.end()) return;
  const Call call = known->second;
  calls_.erase(known);
  if (reply.done) {
    Send(foxglove::ServiceResponse(call.service, call.call, reply.text), false);
  } else {
    Send(foxglove::ServiceFailureText(call.service, call.call, reply.problem), true);
  }
}

void FoxgloveClient::Subscribe(const foxglove::Subscribe& subscribe) {
  for (const auto& [id, channel] : subscribe.subscriptions) {
    if (channels_.contains(channel)) subscriptions_[id] = channel;
  }
  version_ = 0;  // of no state: the present one is sent again
}

// The position is set to the tick that contains the time.
void FoxgloveClient::Control(const foxglove::PlaybackControl& playback) {
  if (!spans_ || shown() == nullptr) return;
  if (playback.seek) {
    const double last = static_cast<double>(spans_->last());
    position_ = std::clamp(static_cast<double>(*playback.seek) / 1e9 / Interval(), 0.0, last);
    position_new_ = true;
  }
  playing_ = playback.play;
  speed_ = playback.speed;
  advanced_at_ = Clock::now();
  SendPlaybackState(playback.seek.has_value(), playback.request);
}

// The client shows its buttons by this message alone.
void FoxgloveClient::SendPlaybackState(bool did_seek, const std::string& request) {
  const bool ended = spans_ && position_ >= static_cast<double>(spans_->last());
  const auto status = playing_ ? (ended ? foxglove::PlaybackStatus::kEnded : foxglove::PlaybackStatus::kPlaying)
                               : foxglove::PlaybackStatus::kPaused;
  const auto time = static_cast<foxglove::Time>(std::llround(position_ * Interval() * 1e9));
  Send(foxglove::PlaybackStateMessage(status, time, speed_, did_seek, request), false);
}

// Called in each period; the position has a fraction, so that slow playing advances, too.
std::optional<std::uint64_t> FoxgloveClient::PositionToShow() {
  if (!spans_ || shown() == nullptr) return std::nullopt;
  if (playing_) {
    const Clock::time_point now = Clock::now();
    const std::chrono::duration<double> passed = now - advanced_at_;
    advanced_at_ = now;
    const auto before = static_cast<std::uint64_t>(position_);
    position_ += static_cast<double>(speed_) * passed.count() / Interval();
    if (position_ >= static_cast<double>(spans_->last())) {
      position_ = static_cast<double>(spans_->last());
      SendPlaybackState(false, {});
      playing_ = false;
    }
    position_new_ = position_new_ || static_cast<std::uint64_t>(position_) != before;
  }
  if (!std::exchange(position_new_, false)) return std::nullopt;
  return static_cast<std::uint64_t>(position_);
}

void FoxgloveClient::SendState() {
  version_ = ShownVersion();
  sent_at_ = Clock::now();
  const foxglove::Time time = ShownTime();
  Send(foxglove::TimeMessage(time), false);
  const Scene& scene = *shown()->world->scene;
  bool bodies_known = false;
  for (const auto& [subscription, id] : subscriptions_) {
    const foxglove::Channel& channel = channels_.at(id);
    const auto send = [&, number = subscription](const std::string& text) {
      Send(foxglove::DataMessage(number, time, text), false);
    };
    switch (channel.kind) {
      case foxglove::ChannelKind::kScene:
      case foxglove::ChannelKind::kMap:
        if (std::exchange(sent_once_[subscription], world_) == world_) break;
        send(channel.kind == foxglove::ChannelKind::kScene ? foxglove::SceneText(scene, time)
                                                           : foxglove::MapText(scene, time));
        break;
      case foxglove::ChannelKind::kTransforms:
        send(foxglove::TransformsText(scene, *shown()->state, time));
        break;
      case foxglove::ChannelKind::kEvents:
        SendEvents(subscription);
        break;
      case foxglove::ChannelKind::kScan:
        if (!std::exchange(bodies_known, true)) bodies_->Assign(*shown()->state);
        SendScan(subscription, channel);
        break;
      case foxglove::ChannelKind::kTable:
        send(foxglove::TableText(*channel.table, {*things_, scene.world(), *shown()->state}, time));
        break;
    }
  }
}

void FoxgloveClient::SendScan(std::uint32_t subscription, const foxglove::Channel& channel) {
  const Scene& scene = *shown()->world->scene;
  SensorSuite& suite = suites_.try_emplace(channel.robot, scene, channel.robot).first->second;
  const RangerReading* const reading = suite.Measure(channel.sensor, {scene, *bodies_}, shown()->state->tick).ranger();
  if (reading == nullptr || channel.scan >= reading->geometry->size()) return;
  const std::string text = foxglove::ScanText(reading->scan(channel.scan), channel.frame, ShownTime());
  Send(foxglove::DataMessage(subscription, ShownTime(), text), false);
}

void FoxgloveClient::SendEvents(std::uint32_t subscription) {
  const auto& events = run_.content.events;
  for (auto event = EventsAfter(events, event_); event != events.end(); ++event) {
    event_ = event->number;
    const std::string text = foxglove::EventText(TextOf(*event), IsWarning(event->event.type), ShownTime());
    Send(foxglove::DataMessage(subscription, ShownTime(), text), false);
  }
}

}  // namespace troupe
