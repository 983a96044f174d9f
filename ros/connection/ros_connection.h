// RosConnection: the way of a process into a ROS 2 domain. A HostConnection (ros/link) leads to the program
// ros-participant of the host; the RosParticipant is that program's own, a participant of DDS. Nodes have writers,
// readers and services on it: ros_endpoints.h.
// It is an interface because tests and ros-participant itself work without a link. Handlers of services run on threads
// of the connection; DrainMismatches, Receive and Flush are for the owner's thread, once for each tick.
#pragma once

#include <dds/dds.h>

#include <array>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "ros/connection/ros_network.h"
#include "ros/messages/ros_options.h"
#include "transport/dds/binding/entity.h"

namespace troupe::ros {

struct TopicSpec {
  std::string topic;  // its name on DDS: "rt/anna/odom"
  const dds_topic_descriptor_t* type = nullptr;
  TopicQos qos;
};

// Of an endpoint or a participant, as on the network.
using Guid = std::array<std::uint8_t, 16>;

// The types begin with a CallHeader.
struct ServiceSpec {
  std::string name;  // "/anna/robot/get_parameters"
  const dds_topic_descriptor_t* request = nullptr;
  const dds_topic_descriptor_t* response = nullptr;
  TopicQos qos;
};

// The part of a reader. A topic can have a reliable reader and, once a best-effort writer has come, a best-effort one
// for that. Not from the start: beside a best-effort reader, Cyclone's reliable one may lose what a writer has sent
// before the readers discovered it. The best-effort reader matches reliable writers too, and ignores their messages.
enum class Part : std::uint8_t { kOnlyReader, kReliableReader, kBestEffortReader };

class TopicWriter {
 public:
  TopicWriter() = default;
  virtual ~TopicWriter() = default;
  TopicWriter(const TopicWriter&) = delete;
  TopicWriter& operator=(const TopicWriter&) = delete;

  // Whether the topic has a reader. One relaxed load.
  bool wanted() const { return wanted_.load(std::memory_order_relaxed); }

  // When the newest reader came, other than those that an agent before had already.
  std::chrono::steady_clock::time_point newest_reader() const {
    return std::chrono::steady_clock::time_point(
        std::chrono::steady_clock::duration(newest_reader_.load(std::memory_order_relaxed)));
  }

  // `sample`: of the topic's type. False: it could not be written.
  virtual bool Write(const void* sample) noexcept = 0;

 protected:
  void SetWanted(bool wanted) { wanted_.store(wanted, std::memory_order_relaxed); }
  void NoteReader() {
    newest_reader_.store(std::chrono::steady_clock::now().time_since_epoch().count(), std::memory_order_relaxed);
  }

 private:
  std::atomic<bool> wanted_ = false;
  std::atomic<std::chrono::steady_clock::rep> newest_reader_ =
      std::numeric_limits<std::chrono::steady_clock::rep>::min();
};

class TopicReader {
 public:
  using Consume = std::function<void(const void* sample)>;

  TopicReader() = default;
  virtual ~TopicReader() = default;
  TopicReader(const TopicReader&) = delete;
  TopicReader& operator=(const TopicReader&) = delete;

  // A writer has come that needs a best-effort reader. For the part kReliableReader.
  bool missed_writer() const { return missed_.load(std::memory_order_relaxed); }

  // Calls `consume` with each sample received since the last call. Without one it is a single load.
  template <typename Function>
  void Drain(const Function& consume) {
    if (!arrived_.load()) return;
    arrived_.store(false);  // before the call: a sample that arrives now is consumed, or sets the flag again
    try {
      ConsumeArrived(consume);
    } catch (const dds::Exception&) {  // out of memory; the next call reads the remaining samples
      arrived_.store(true);
    }
  }

 protected:
  void SetArrived() { arrived_.store(true); }
  void SetMissedWriter() { missed_.store(true); }
  virtual void ConsumeArrived(const Consume& consume) = 0;

 private:
  std::atomic<bool> arrived_ = true;  // a sample may wait
  std::atomic<bool> missed_ = false;
};

// The first fields of a request and of its response: the address of the response.
struct CallHeader {
  std::uint64_t client_guid = 0;
  std::int64_t sequence_number = 0;

  friend bool operator==(const CallHeader&, const CallHeader&) = default;
};

class ServiceServer {
 public:
  // Called on a thread of the connection with each request. It calls Respond, at once or later. `is_repeated`: a
  // process before had the request, and has ended without a response; it may have executed it.
  using Handler = std::function<void(const void* request, bool is_repeated)>;

  ServiceServer() = default;
  virtual ~ServiceServer() = default;
  ServiceServer(const ServiceServer&) = delete;
  ServiceServer& operator=(const ServiceServer&) = delete;

  // Call once. Handles the requests that have arrived before.
  virtual void Start() = 0;
  // From any thread. False: it could not be written.
  virtual bool Respond(const void* response) noexcept = 0;
};

class RosConnection {
 public:
  explicit RosConnection(Distribution distribution) : distribution_(distribution) {}
  virtual ~RosConnection() = default;
  RosConnection(const RosConnection&) = delete;
  RosConnection& operator=(const RosConnection&) = delete;

  Distribution distribution() const { return distribution_; }

  // `node_namespace` begins with a slash, `name` has none. Returns the index of the node.
  virtual std::size_t AddNode(const std::string& node_namespace, const std::string& name) = 0;

  // The endpoints of a node, which match others from Announce on, or before. Throw dds::Exception. The connection must
  // outlive them.
  virtual std::unique_ptr<TopicWriter> MakeWriter(std::size_t node, const TopicSpec& spec) = 0;
  // `on_arrival`: called when a sample has arrived, on a thread of the connection; it calls no function of the reader.
  virtual std::unique_ptr<TopicReader> MakeReader(std::size_t node, const TopicSpec& spec, Part part,
                                                  std::function<void()> on_arrival) = 0;
  virtual std::unique_ptr<ServiceServer> MakeService(std::size_t node, const ServiceSpec& spec,
                                                     ServiceServer::Handler handler) = 0;

  // Publishes the nodes and their endpoints. Call after all are made, and again after a change.
  virtual void Announce() = 0;

  // A line for each writer, found since the last call, that does not match the readers.
  virtual std::vector<std::string> DrainMismatches() = 0;

  // Brings the samples to the readers that have arrived by now.
  virtual void Receive() {}
  // Sends the samples written so far, at the latest.
  virtual void Flush() {}

  // From now on this thread writes samples again, that readers have already, and writers are wanted only if a reader
  // has come since that time. Without a time: no longer.
  void AddressReadersSince(std::optional<std::chrono::steady_clock::time_point> time) {
    readers_since_ = time;
    writes_again_.store(time ? std::this_thread::get_id() : std::thread::id(), std::memory_order_relaxed);
  }
  bool addresses_newcomers() const { return readers_since_.has_value(); }
  bool Addresses(const TopicWriter& writer) const {
    return writer.wanted() && (!readers_since_ || writer.newest_reader() >= *readers_since_);
  }

  // Whether any writer has had a reader.
  void NoteWanted() { had_reader_.store(true, std::memory_order_relaxed); }
  bool had_reader() const { return had_reader_.load(std::memory_order_relaxed); }

  // Samples that could not be written.
  void CountLost() { lost_.fetch_add(1, std::memory_order_relaxed); }
  std::uint64_t lost() const { return lost_.load(std::memory_order_relaxed); }

 protected:
  bool writes_again() const { return writes_again_.load(std::memory_order_relaxed) == std::this_thread::get_id(); }

 private:
  const Distribution distribution_;
  std::optional<std::chrono::steady_clock::time_point> readers_since_;  // of the thread that writes
  std::atomic<std::thread::id> writes_again_ = std::thread::id();
  std::atomic<bool> had_reader_ = false;
  std::atomic<std::uint64_t> lost_ = 0;
};

// In place of the index of a node, for endpoints that no node lists.
inline constexpr std::size_t kNoNode = 0xffffffff;

// A node of a connection.
struct RosNode {
  RosConnection* connection = nullptr;
  std::size_t index = 0;
  std::string node_namespace;  // "/anna"

  // "/anna/odom"; a name that begins with a slash stays as it is.
  std::string Resolve(const std::string& name) const {
    if (name.starts_with("/")) return name;
    return (node_namespace == "/" ? "" : node_namespace) + "/" + name;
  }
};

inline RosNode MakeNode(RosConnection& connection, const std::string& node_namespace, const std::string& name) {
  return {&connection, connection.AddNode(node_namespace, name), node_namespace};
}

}  // namespace troupe::ros
