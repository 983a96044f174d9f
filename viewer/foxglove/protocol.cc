#include "viewer/foxglove/protocol.h"

#include <array>
#include <cmath>

#include "common/base/bytes.h"
#include "common/base/json_reader.h"

namespace troupe::foxglove {
namespace {

constexpr std::size_t kMaxSubscriptions = 1000;  // in a message

// A request of the page, offered as a service.
struct Service {
  const char* name;
  const char* command;
  const char* request;  // JSON schema
};

constexpr const char* kNothing = R"({"type":"object","properties":{}})";
// The services by their ids, from 1.
constexpr std::array<Service, 7> kServices = {
    {{"/pause", "pause", kNothing},
     {"/play", "play", kNothing},
     {"/step", "step", R"({"type":"object","properties":{"ticks":{"type":"integer","minimum":1}}})"},
     {"/reset", "reset", kNothing},
     {"/speed", "speed", R"({"type":"object","properties":{"speed":{"type":"number"}}})"},
     {"/spawn", "spawn",
      R"({"type":"object","properties":{"source":{"type":"string"},"pose":{"type":"array","items":{"type":"number"}}}})"},
     {"/delete", "delete", R"({"type":"object","properties":{"name":{"type":"string"}}})"}}};
constexpr const char* kResponse =
    R"({"type":"object","properties":{"done":{"type":"boolean"},"state":{"type":"string"},"tick":{"type":"integer"}}})";

enum ServerOpcode : std::uint8_t { kData = 1, kTime = 2, kServiceResponse = 3, kPlaybackState = 5 };
enum ClientOpcode : std::uint8_t { kClientData = 1, kServiceCall = 2, kPlaybackControl = 3 };

Error MalformedMessage(const char* expected) {
  return {{}, std::string("found a malformed message of a client, expected ") + expected};
}

ClientMessage ReadSubscribe(const JsonReader& object) {
  Subscribe subscribe;
  const std::optional<JsonReader> list = object.Find("subscriptions");
  if (!list) object.FailWithout("subscriptions", "a list");
  for (const JsonReader& each : list ? list->Items(kMaxSubscriptions) : std::vector<JsonReader>()) {
    subscribe.subscriptions.push_back({each.Get<std::uint32_t>("id"), each.Get<std::uint32_t>("channelId")});
  }
  return subscribe;
}

ClientMessage ReadUnsubscribe(const JsonReader& object) {
  Unsubscribe unsubscribe{object.Get<std::vector<std::uint32_t>>("subscriptionIds")};
  if (unsubscribe.ids.size() > kMaxSubscriptions) object.Fail("fewer subscriptions");
  return unsubscribe;
}

// An unknown service is no error of the protocol: it is answered with a failure.
Result<ClientMessage> ParseServiceCall(ByteReader reader) {
  ServiceCall call;
  call.service = reader.Read<std::uint32_t>();
  call.call = reader.Read<std::uint32_t>();
  const std::string encoding = reader.ReadText();
  if (!reader.ok()) return MalformedMessage("a whole service call");
  if (encoding == "json" && call.service >= 1 && call.service <= kServices.size()) {
    call.command = kServices[call.service - 1].command;
  }
  call.json = reader.ReadRest();
  return ClientMessage(std::move(call));
}

// Layout: command u8, speed f32, has a seek time u8, time u64, request id as text.
Result<ClientMessage> ParsePlaybackControl(ByteReader reader) {
  PlaybackControl control;
  const auto command = reader.Read<std::uint8_t>();
  control.play = command == 0;
  control.speed = reader.Read<float>();
  const bool seeks = reader.Read<std::uint8_t>() != 0;
  const auto time = reader.Read<Time>();
  if (seeks) control.seek = time;
  control.request = reader.ReadText();
  if (!reader.ok() || command > 1 || !(std::isfinite(control.speed) && control.speed >= 0.0F)) {
    return MalformedMessage("a whole playback control request");
  }
  return ClientMessage(std::move(control));
}

}  // namespace

// A recording can be played and not changed, a run can be changed and not played.
std::string ServerInfoText(const std::string& name, const std::optional<PlaybackRange>& range) {
  Json text = {{"op", "serverInfo"},
               {"name", name},
               {"capabilities", Json::array({"time"})},
               {"supportedEncodings", Json::array({"json"})},
               {"metadata", Json::object()}};
  if (range) {
    text["capabilities"].push_back("rangedPlayback");
    text["dataStartTime"] = TimeOf(range->begin);
    text["dataEndTime"] = TimeOf(range->end);
  } else {
    text["capabilities"].push_back("services");
  }
  return Dump(text);
}

std::string AdvertiseText(const std::vector<Channel>& channels) {
  Json list = Json::array();
  for (const Channel& channel : channels) {
    list.push_back({{"id", channel.id},
                    {"topic", channel.topic},
                    {"encoding", "json"},
                    {"schemaName", SchemaName(channel)},
                    {"schemaEncoding", "jsonschema"},
                    {"schema", Schema(channel)}});
  }
  return Dump({{"op", "advertise"}, {"channels", std::move(list)}});
}

std::string UnadvertiseText(const std::vector<Channel>& channels) {
  Json ids = Json::array();
  for (const Channel& channel : channels) ids.push_back(channel.id);
  return Dump({{"op", "unadvertise"}, {"channelIds", std::move(ids)}});
}

std::string AdvertiseServicesText() {
  Json list = Json::array();
  for (std::size_t i = 0; i < kServices.size(); ++i) {
    const Service& service = kServices[i];
    const std::string type = std::string("troupe") + service.name;
    const auto part = [](const std::string& name, const char* schema) {
      return Json{{"encoding", "json"}, {"schemaName", name}, {"schemaEncoding", "jsonschema"}, {"schema", schema}};
    };
    list.push_back({{"id", i + 1},
                    {"name", service.name},
                    {"type", type},
                    {"request", part(type + "_request", service.request)},
                    {"response", part(type + "_response", kResponse)}});
  }
  return Dump({{"op", "advertiseServices"}, {"services", std::move(list)}});
}

std::string ServiceFailureText(std::uint32_t service, std::uint32_t call, const std::string& problem) {
  return Dump({{"op", "serviceCallFailure"}, {"serviceId", service}, {"callId", call}, {"message", problem}});
}

// Layout: opcode u8, subscription u32, time u64, content.
std::string DataMessage(std::uint32_t subscription, Time time, std::string_view content) {
  std::string bytes;
  ByteWriter writer(bytes);
  bytes.reserve(13 + content.size());
  writer.Write(std::uint8_t{kData});
  writer.Write(subscription);
  writer.Write(time);
  writer.WriteBytes(content);
  return bytes;
}

std::string TimeMessage(Time time) {
  std::string bytes;
  ByteWriter writer(bytes);
  writer.Write(std::uint8_t{kTime});
  writer.Write(time);
  return bytes;
}

std::string ServiceResponse(std::uint32_t service, std::uint32_t call, std::string_view json) {
  std::string bytes;
  ByteWriter writer(bytes);
  writer.Write(std::uint8_t{kServiceResponse});
  writer.Write(service);
  writer.Write(call);
  writer.WriteText("json");
  writer.WriteBytes(json);
  return bytes;
}

std::string PlaybackStateMessage(PlaybackStatus status, Time time, float speed, bool did_seek,
                                 const std::string& request) {
  std::string bytes;
  ByteWriter writer(bytes);
  writer.Write(std::uint8_t{kPlaybackState});
  writer.Write(static_cast<std::uint8_t>(status));
  writer.Write(time);
  writer.Write(speed);
  writer.Write(static_cast<std::uint8_t>(did_seek ? 1 : 0));
  writer.WriteText(request);
  return bytes;
}

// Operations beyond those are optional parts of the protocol.
Result<ClientMessage> ParseText(std::string_view text) {
  const JsonReader object = JsonReader::OfText(text);
  const auto op = object.Get<std::string>("op");
  ClientMessage message = Ignored();
  if (op == "subscribe") message = ReadSubscribe(object);
  if (op == "unsubscribe") message = ReadUnsubscribe(object);
  if (!object.ok()) return object.status().error();
  return message;
}

Result<ClientMessage> ParseBinary(std::string_view bytes) {
  ByteReader reader(bytes);
  switch (reader.Read<std::uint8_t>()) {
    case kServiceCall:
      return ParseServiceCall(reader);
    case kPlaybackControl:
      return ParsePlaybackControl(reader);
    case kClientData:
      if (reader.ok()) return ClientMessage(Ignored());
      [[fallthrough]];
    default:
      return MalformedMessage("a binary message of the protocol");
  }
}

}  // namespace troupe::foxglove
