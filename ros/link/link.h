// Link: the messages between a process with nodes in ROS, here called an agent, and the program ros-participant of its
// host, over a connected Unix socket. The two are of one build, which the first message states: so samples need no
// version of their own, and another build is refused at once. It has also the messages between that program and its
// side on Fast DDS, which uses kHello (with the GUID of the client in its calls), kMakeService (a ServiceText),
// kRemove, kRequest, kRespond and kServed.
//
// A message is 12 bytes (length, kind, id) in the byte order of the host, and its content: a sample as CDR, or a short
// JSON text for what is rare. Add and Flush may be called from any thread and never wait: what the socket does not
// accept stays in memory, and `pending` lets the owner drop streams. Receive is for one thread. Only peers of the same
// user are accepted (SO_PEERCRED).
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <mutex>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "ros/connection/ros_connection.h"
#include "troupe/result.h"

namespace troupe::ros {

enum class LinkKind : std::uint8_t {
  // To the participant. `id` is that of a node, or of an endpoint; the agent chooses both.
  kHello,         // a HelloText; the first message
  kAddNode,       // a NodeText
  kMakeWriter,    // an EndpointText, as those below
  kMakeReader,    //
  kMakeService,   //
  kStartService,  //
  kShareWriter,   // the number of a node, as text: lists the writer as one of this node, too
  kRemove,        // the endpoint has ended
  kAnnounce,
  kWatchDistributions,
  kWrite,    // a sample, as CDR
  kRespond,  // a response, as CDR
  // Of a process whose ticks wait for ROS (TopicWatch).
  kWatch,    // a topic's name on DDS
  kArm,      // any text: the next message on each watched topic is to be told, unless that was done for this text
  kCollect,  // performs all that the other agents of the domain have sent
  kTell,     // a std_msgs/Header as CDR: writes it with the topics as its text that have had messages since kArm or the
             // last one: "/anna/scan:1 /tf:2"; the answer is kTold
  // To the agent.
  kWanted,    // a WantedContent: of a writer
  kSample,    // of a reader, as CDR
  kMissed,    // a reader needs another one for best-effort writers
  kRequest,   // of a service, as CDR
  kRepeated,  // a request that an agent before had, which has ended without a response
  kMismatch,  // a line for the log of the run
  kArmed,     // the text of kArm
  kArrived,   // of a watch: a message has arrived since the text was armed, which is the content
  kTold,      // of a writer: the sample of kTell that was written, as CDR
  // Of the side on Fast DDS.
  kServed,  // a ServedContent: of a service
};
inline constexpr LinkKind kLastLinkKind = LinkKind::kServed;

struct LinkMessage {
  LinkKind kind;
  std::uint32_t id = 0;
  std::span<const std::byte> content;  // valid during the call
};

// The content of kServed: the GUIDs of the endpoints.
struct ServedContent {
  Guid reader{};
  Guid writer{};
};

// The content of kWanted.
struct WantedContent {
  bool wanted = false;  // the writer has a reader
  bool is_new = false;  // one has come
};

class Link {
 public:
  static constexpr std::size_t kMaxContent = std::size_t{64} << 20;

  // Owns the descriptor.
  explicit Link(int descriptor);
  ~Link();
  Link(const Link&) = delete;
  Link& operator=(const Link&) = delete;

  int descriptor() const { return descriptor_; }

  // Adds a message to those that Flush sends. REQUIRES: content is not larger than kMaxContent. From any thread, as
  // the two below.
  void Add(LinkKind kind, std::uint32_t id, std::span<const std::byte> content = {});
  // Sends as much as the socket takes, without waiting. False: the other side has gone.
  bool Flush();
  // Bytes that are still to be sent.
  std::size_t pending() const;

  // Calls receive(LinkMessage) for each message that has arrived, without waiting; of many, for some. False: the other
  // side has gone, or it has sent bytes that are no messages. From one thread at a time.
  template <typename Function>
  bool Receive(const Function& receive) {
    const bool open = ReadArrived();
    std::size_t at = 0;
    for (;;) {
      const std::size_t left = received_.size() - at;
      Header header;
      if (left < sizeof header) break;
      std::memcpy(&header, received_.data() + at, sizeof header);
      if (header.size > kMaxContent || header.kind > static_cast<std::uint32_t>(kLastLinkKind)) return false;
      if (left < sizeof header + header.size) break;
      receive(LinkMessage{static_cast<LinkKind>(header.kind), header.id,
                          std::span(received_).subspan(at + sizeof header, header.size)});
      at += sizeof header + header.size;
    }
    received_.erase(received_.begin(), received_.begin() + static_cast<std::ptrdiff_t>(at));
    return open;
  }

 private:
  struct Header {
    std::uint32_t size = 0;  // of the content, in bytes
    std::uint32_t kind = 0;
    std::uint32_t id = 0;
  };

  bool ReadArrived();
  void DropSent();

  const int descriptor_;
  mutable std::mutex mutex_;  // guards the two below
  std::vector<std::byte> output_;
  std::size_t sent_ = 0;             // bytes at its begin
  std::vector<std::byte> chunk_;     // of one read
  std::vector<std::byte> received_;  // not yet a whole message
};

// The texts of a Link that describe nodes and endpoints: JSON.

// The first text of an agent.
struct HelloText {
  std::string version;
  std::uint32_t domain = 0;  // of its nodes and endpoints
};

struct NodeText {
  std::string node_namespace;
  std::string name;
};

// The text of a writer, a reader or a service.
struct EndpointText {
  std::uint32_t node = 0;
  std::string name;           // of the topic on DDS, or of the service
  std::string type;           // its name on DDS; of requests
  std::string response_type;  // of a service
  TopicQos qos;
  Part part = Part::kOnlyReader;  // of a reader
};

// The text of a service that Fast DDS serves.
struct ServiceText {
  std::uint32_t domain = 0;
  std::string name;  // "/anna/robot/get_parameters"
  std::string request_type;
  std::string response_type;
};

std::string ToText(const HelloText& hello);
std::string ToText(const NodeText& node);
std::string ToText(const EndpointText& endpoint);
std::string ToText(const ServiceText& service);
// Any text is safe.
Result<HelloText> ParseHello(std::string_view text);
Result<NodeText> ParseNode(std::string_view text);
Result<EndpointText> ParseEndpoint(std::string_view text);
Result<ServiceText> ParseService(std::string_view text);

// The names of Unix sockets that leave no file behind.

// Sockets with close-on-exec that do not wait. `name`: without a leading zero; at most 107 characters. The errors are
// for people.
Result<int> Bind(const std::string& name);  // no connection succeeds before listen()
Result<int> Connect(const std::string& name);
// Accepts a connection of a listening socket; -1: none is waiting, or it belongs to another user.
int Accept(int listening);

}  // namespace troupe::ros
