// RosWriter<T> and RosReader<T>: the endpoints of a node on a topic, with the message's type. Their constructors throw
// dds::Exception; no other call throws: a sample that cannot be written is counted (RosConnection::lost) and dropped,
// because a slow tool must not stop a run.
//
// `is_addressed` is the first question of each publisher: most topics of most robots have no reader, and a message is
// made only for one. A sample that is read lives until the function of Drain returns.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <utility>

#include "ros/connection/ros_connection.h"
#include "ros/connection/ros_network.h"
#include "ros/connection/topic_types.h"

namespace troupe::ros {

template <typename T>
class RosWriter {
 public:
  RosWriter(const RosNode& node, const std::string& name, const TopicQos& qos)
      : connection_(node.connection),
        writer_(
            connection_->MakeWriter(node.index, {"rt" + node.Resolve(name), dds::TopicTraits<T>::descriptor(), qos})) {}

  // Whether the topic has a reader, so that a message is worth making. Cheap, because each topic asks in each tick.
  bool wanted() const { return writer_->wanted(); }
  // The same for samples of a node's own thread: only for the readers that the connection addresses.
  bool is_addressed() const { return connection_->Addresses(*writer_); }
  void Write(const T& message) noexcept {
    if (!writer_->Write(&message)) connection_->CountLost();
  }

 private:
  RosConnection* connection_;
  std::unique_ptr<TopicWriter> writer_;
};

template <typename T>
class RosReader {
 public:
  // `on_arrival`: as in RosConnection::MakeReader.
  RosReader(const RosNode& node, const std::string& name, const TopicQos& qos, Part part = Part::kOnlyReader,
            std::function<void()> on_arrival = {})
      : reader_(node.connection->MakeReader(node.index,
                                            {"rt" + node.Resolve(name), dds::TopicTraits<T>::descriptor(), qos}, part,
                                            std::move(on_arrival))) {}

  // A writer has come that needs a best-effort reader. For the part kReliableReader.
  bool missed_writer() const { return reader_->missed_writer(); }

  // Calls `consume` with each message received since the last call.
  template <typename Consume>
  void Drain(const Consume& consume) {
    reader_->Drain([&consume](const void* message) { consume(*static_cast<const T*>(message)); });
  }

 private:
  std::unique_ptr<TopicReader> reader_;
};

// Whether the constructor of a service starts it, or Start, once all that its handler needs exists.
enum class Serving : std::uint8_t { kAtOnce, kWhenStarted };

// The address of a response, and whether the request is repeated: see ServiceServer.
struct RosCaller : CallHeader {
  bool is_repeated = false;
};

// RosService<Request, Response>: a service of a node.
template <typename Request, typename Response>
class RosService {
  static_assert(offsetof(Request, client_guid) == offsetof(CallHeader, client_guid) &&
                offsetof(Request, sequence_number) == offsetof(CallHeader, sequence_number));

 public:
  // Called on a thread of the connection with each request. It calls Respond, at once or later.
  using Handler = std::function<void(const RosCaller& caller, const Request& request)>;

  RosService(const RosNode& node, const std::string& name, Handler handler, const TopicQos& qos = Service(),
             Serving serving = Serving::kAtOnce)
      : connection_(node.connection),
        server_(
            connection_->MakeService(node.index,
                                     {node.Resolve(name), dds::TopicTraits<Request>::descriptor(),
                                      dds::TopicTraits<Response>::descriptor(), qos},
                                     [handle = std::move(handler)](const void* sample, bool is_repeated) {
                                       const Request& request = *static_cast<const Request*>(sample);
                                       handle({{request.client_guid, request.sequence_number}, is_repeated}, request);
                                     })) {
    if (serving == Serving::kAtOnce) Start();
  }

  // Call once, with kWhenStarted. Handles the requests that have arrived before.
  void Start() { server_->Start(); }

  // Safe to call from any thread.
  void Respond(const RosCaller& caller, Response& response) {
    response.client_guid = caller.client_guid;
    response.sequence_number = caller.sequence_number;
    if (!server_->Respond(&response)) connection_->CountLost();
  }

 private:
  RosConnection* connection_;
  std::unique_ptr<ServiceServer> server_;
};

}  // namespace troupe::ros
