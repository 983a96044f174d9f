// Connections: the clients of one MQTT broker (3.1.1) that a thread has, on libmosquitto, in one poll loop.
//
// Passive: everything happens inside the calls, on the thread that makes them, which has to call Wait again and again.
// A connection that cannot be made or is lost is tried again after 1 s, then after twice as long each time, at most
// 30 s, and subscribes again. A call may take up to 2 s where the broker's host does not answer.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "transport/mqtt/broker.h"
#include "troupe/result.h"

namespace troupe::mqtt {

struct Message {
  std::string topic;
  std::string payload = {};
  int qos = 0;
  bool retained = false;
};

struct ClientOptions {
  std::string id;                               // unique at the broker; empty: the broker gives one
  std::vector<std::string> subscriptions = {};  // filters of topics, with + and #
  int qos = 0;                                  // of the subscriptions
  std::optional<Message> will = {};             // that the broker publishes when the connection is lost
};

// What has happened to a client, by its number.
struct Connected {
  std::size_t client = 0;
};
struct Disconnected {
  std::size_t client = 0;
  std::string reason;          // one line
  bool was_connected = false;  // false: an attempt has failed
};
struct Received {
  std::size_t client = 0;
  Message message;
};
using Event = std::variant<Connected, Disconnected, Received>;

class Connections {
 public:
  // `wake`: a descriptor that ends Wait when it is readable (WakeEvent); -1: none. Throws std::system_error without
  // resources.
  explicit Connections(Broker broker, int wake = -1);
  ~Connections();  // without Close the broker publishes the wills
  Connections(const Connections&) = delete;
  Connections& operator=(const Connections&) = delete;

  const Broker& broker() const;

  // A certificate or key that cannot be used, or a topic that MQTT does not allow, is an error. Returns the number of
  // the client, counted from 0; Wait connects it.
  Result<std::size_t> Add(const ClientOptions& options);

  bool IsConnected(std::size_t client) const;

  // False if the client is not connected, or the message cannot be sent (topic, length): it is dropped.
  bool Publish(std::size_t client, const Message& message);

  // Sends and receives until something has happened, the wake descriptor is readable, or the time is over.
  std::vector<Event> Wait(double seconds);

  // Sends what is left, for at most so long, and ends all connections in order: without wills.
  void Close(double seconds);

 private:
  class Content;
  std::unique_ptr<Content> content_;
};

}  // namespace troupe::mqtt
