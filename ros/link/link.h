// Link: the messages between a process with nodes in ROS, here called an agent, and the program ros-participant of its
// host, over a connected Unix socket. The two are of one build, which the first message states: so samples need no
// version of their own, and another build is refused at once. It has also the messages between that program and its
// side on Fast DDS, which uses kHello (with the GUID of the client in its calls), kMake of services, kRemove, kWrite,
// kSample and kServed.
//
// The agent chooses the id of what it makes: a node, an endpoint or a watch. All later messages about it have this id.
//
// A message is 12 bytes (length, kind, id) in the byte order of the host, and its content: a sample as CDR, or a short
// JSON text for rare messages. Add and Flush may be called from any thread and never wait: what the socket does not
// accept stays in memory, and `pending` lets the owner drop streams. Receive is for one thread. Only peers of the same
// user are accepted (SO_PEERCRED).
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <mutex>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "ros/connection/ros_connection.h"
#include "troupe/fields.h"
#include "troupe/result.h"

namespace troupe::ros {

enum class LinkKind : std::uint8_t {
  // To the participant.
  kHello,       // a HelloText; the first message
  kMake,        // a MadeText
  kRemove,      // what was made has ended
  kAnnounce,    // lists the agent's nodes and endpoints as they are now: each time the list of the whole host is sent
  kWrite,       // a sample of a writer, or a response of a service, as CDR
  kWriteAgain,  // of a writer: a sample of the tick that the agent has shown already, for late readers
  kShown,       // the answer to kShowAgain: the tick has been written again
  kSettle,      // the answer is kSettled, behind all that follows from what was sent before
  // Of a process whose ticks wait for ROS (TopicWatch).
  kArm,      // any text: the next message on each watched topic is to be told, unless that was done for this text
  kShow,     // the tick whose text is armed is published: nodes may know of it before kTell
  kCollect,  // performs all that the other agents of the domain have sent
  kTell,     // a std_msgs/Header as CDR: writes it with the topics behind its text that have had messages since kArm:
             // "/anna/scan:1 /tf:2"; the answer is kTold, perhaps after kHeld
  kAwait,    // before kTell: the ids of the watches that the tick waits for, 4 bytes each; or behind it: from now on
  // To the agent.
  kMatched,   // of a writer: a MatchedContent; of a reader: it needs another one for best-effort writers
  kSample,    // of a reader, or a request of a service, as CDR
  kRepeated,  // a request that an agent before had, which has ended without a response
  kMismatch,  // a line for the log of the run
  kArrived,   // of a watch: a message has arrived since the text was armed, which is the content; of kNothing: the text
              // of kArm
  kTimed,     // of a watch: a program that writes on the topic reads /clock; with the content kNotTimed: none does any
              // more
  kTold,      // of a writer: the sample of kTell that was written, as CDR
  kHeld,      // the tick of kTell is held back until nodes can receive it; the ids of watches without a program
  kCalling,   // of the tick of kTell: the ids of watches whose programs have called services, and wait for others
  kShowAgain,  // the tick is to be shown again, to all readers; the answer is kShown
  kSettled,    // the answer to kSettle
  // Of the side on Fast DDS.
  kServed,  // a ServedContent: of a service
};
inline constexpr LinkKind kLastLinkKind = LinkKind::kServed;

inline constexpr std::string_view kNotTimed = "0";  // the content of kTimed

inline constexpr std::uint32_t kNothing = 0xffffffff;  // the id of nothing that was made

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

// The content of kAwait, of kHeld and of kCalling.
std::vector<std::byte> ToBytes(const std::set<std::uint32_t>& ids);
// Any bytes are safe: the ids that fit in.
std::set<std::uint32_t> ToIds(std::span<const std::byte> bytes);

// The content of kMatched.
struct MatchedContent {
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
    return Deliver(receive) && open;
  }
  // The two halves of Receive: the bytes that have arrived, and the calls. A call may call the first of another Link,
  // and not of this one.
  bool ReadArrived();
  template <typename Function>
  bool Deliver(const Function& receive) {
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
    return true;
  }

 private:
  struct Header {
    std::uint32_t size = 0;  // of the content, in bytes
    std::uint32_t kind = 0;
    std::uint32_t id = 0;
  };

  void DropSent();

  const int descriptor_;
  mutable std::mutex mutex_;  // guards the two below
  std::vector<std::byte> output_;
  std::size_t sent_ = 0;             // bytes at its begin
  std::vector<std::byte> chunk_;     // of one read
  std::vector<std::byte> received_;  // not yet a whole message
};

// The texts of a Link: JSON of their fields.

// The first text of an agent.
struct HelloText {
  std::string version;
  std::uint32_t domain = 0;  // of its nodes and endpoints
  bool shows_ticks = false;  // it answers kShowAgain

  static constexpr auto Fields() {
    return std::tuple{
        Field{"version", &HelloText::version},
        Field{"domain", &HelloText::domain},
        Field{"shows_ticks", &HelloText::shows_ticks},
    };
  }
};

enum class MadeKind : std::uint8_t {
  kNode,
  kWriter,  // one of log lines is listed as a writer of all nodes of the agent
  kReader,
  kService,
  kWatch,  // of a topic, for messages of any type; or of a node that answers by this name
  // Of participants that have another distribution, and of another run in the domain (RosParticipant): this agent gets
  // the lines for the log.
  kDistributionWatch,
};
inline constexpr MadeKind kLastMadeKind = MadeKind::kDistributionWatch;

// The text of what an agent makes.
struct MadeText {
  MadeKind kind = MadeKind::kNode;
  std::uint32_t node = kNothing;  // of an endpoint: its id; kNothing: it is listed as one of no node
  std::string name = {};          // "/anna/robot" of a node, "/anna/robot/get_parameters" of a service; else of a topic
                                  // on DDS: "rt/anna/scan"
  std::string type = {};          // of an endpoint: its name on DDS; of requests
  std::string response_type = {};  // of a service
  TopicQos qos = {};               // of an endpoint
  Part part = Part::kOnlyReader;   // of a reader
  std::uint32_t domain = 0;        // of a service that Fast DDS serves

  static constexpr auto Fields() {
    return std::tuple{
        Field{"kind", &MadeText::kind},
        Field{"node", &MadeText::node},
        Field{"name", &MadeText::name},
        Field{"type", &MadeText::type},
        Field{"response_type", &MadeText::response_type},
        Field{"qos", &MadeText::qos},
        Field{"part", &MadeText::part},
        Field{"domain", &MadeText::domain},
    };
  }
};

std::string ToText(const HelloText& hello);
std::string ToText(const MadeText& made);
// Any text is safe.
Result<HelloText> ParseHello(std::string_view text);
Result<MadeText> ParseMade(std::string_view text);

// The names of Unix sockets that leave no file behind.

// Sockets with close-on-exec that do not wait. `name`: without a leading zero; at most 107 characters. The errors are
// for users.
Result<int> Bind(const std::string& name);  // no connection succeeds before listen()
Result<int> Connect(const std::string& name);
// Accepts a connection of a listening socket; -1: none is waiting, or it belongs to another user.
int Accept(int listening);

}  // namespace troupe::ros
