// RosService<Request, Response>: a service of a node.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <utility>

#include "ros/connection/ros_connection.h"
#include "ros/connection/ros_qos.h"
#include "ros/connection/topic_types.h"

namespace troupe::ros {

// Whether the constructor of a service starts it, or Start, once all that its handler needs exists.
enum class Serving : std::uint8_t { kAtOnce, kWhenStarted };

// The address of a response.
using RosCaller = CallHeader;

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
        server_(connection_->MakeService(node.index,
                                         {node.Resolve(name), dds::TopicTraits<Request>::descriptor(),
                                          dds::TopicTraits<Response>::descriptor(), qos},
                                         [handle = std::move(handler)](const void* sample) {
                                           const Request& request = *static_cast<const Request*>(sample);
                                           handle({request.client_guid, request.sequence_number}, request);
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
