// Foxglove's WebSocket protocol, version 1: the messages of server and client, without a connection. Numbers in binary
// messages are little-endian. docs/viewer.md names the parts that are served.
//
// Encoding and decoding only, so that tests and the fuzzer need no socket. A client is any program that can reach the
// port: each length and count is checked against the bytes that are there, and unknown operations are ignored, as the
// protocol asks.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "troupe/result.h"
#include "viewer/foxglove/messages.h"

namespace troupe::foxglove {

// Subprotocols that a client may name.
inline constexpr const char* kSubprotocols[] = {"foxglove.sdk.v1", "foxglove.websocket.v1"};

// Simulated time, ns.
struct PlaybackRange {
  Time begin = 0;
  Time end = 0;
};

// Texts of the server. `range`: of a recording.
std::string ServerInfoText(const std::string& name, const std::optional<PlaybackRange>& range);
std::string AdvertiseText(const std::vector<Channel>& channels);
std::string UnadvertiseText(const std::vector<Channel>& channels);
std::string AdvertiseServicesText();
std::string ServiceFailureText(std::uint32_t service, std::uint32_t call, const std::string& problem);

// Binary messages of the server.
std::string DataMessage(std::uint32_t subscription, Time time, std::string_view content);
std::string TimeMessage(Time time);
std::string ServiceResponse(std::uint32_t service, std::uint32_t call, std::string_view json);

enum class PlaybackStatus : std::uint8_t { kPlaying = 0, kPaused = 1, kBuffering = 2, kEnded = 3 };
std::string PlaybackStateMessage(PlaybackStatus status, Time time, float speed, bool did_seek,
                                 const std::string& request);

// Messages of the client.
// `id` is chosen by the client and repeated in each DataMessage.
struct Subscribe {
  struct One {
    std::uint32_t id = 0;
    std::uint32_t channel = 0;
  };
  std::vector<One> subscriptions;
};
struct Unsubscribe {
  std::vector<std::uint32_t> ids;
};
struct ServiceCall {
  std::uint32_t service = 0;
  std::uint32_t call = 0;
  std::string command;  // a command of the page (viewer/gateway/page_request.h); empty: an unknown service
  std::string json;     // of the request
};
struct PlaybackControl {
  bool play = false;
  float speed = 1.0F;
  std::optional<Time> seek = {};
  std::string request;
};
struct Ignored {};  // of a feature that is not served
using ClientMessage = std::variant<Subscribe, Unsubscribe, ServiceCall, PlaybackControl, Ignored>;

// Any bytes are safe. The error is a message that no client of the protocol sends.
Result<ClientMessage> ParseText(std::string_view text);
Result<ClientMessage> ParseBinary(std::string_view bytes);

}  // namespace troupe::foxglove
