// RosService<Request, Response>: a service as rmw_cyclonedds offers one: two topics, whose types begin with the
// caller's id and the number of its call. Callers on rmw_fastrtps are not understood: they put these beside the
// message, where Cyclone's interface gives no access.
#pragma once

#include <functional>
#include <string>

#include "common/dds/data_reader.h"
#include "common/dds/data_writer.h"
#include "common/dds/wire.h"
#include "common/ros_dds/ros_participant.h"
#include "common/ros_dds/ros_qos.h"
#include "common/ros_dds/topic_types.h"
#include "common/ros_dds/type_hash.h"

namespace troupe::ros {

// Whom an answer is for.
struct RosCaller {
  std::uint64_t client_guid = 0;
  std::int64_t sequence_number = 0;
};

// "serviceid=...;" with which clients find a service's two ends to belong together, and the type's hash.
template <typename T>
dds::UserData ServiceUserData(const std::string& id) {
  return {"serviceid=" + id + ";typehash=" + TypeHash(dds::TopicTraits<T>::descriptor()->m_typename) + ";"};
}

template <typename Request, typename Response>
class RosService {
 public:
  // Called on a thread of Cyclone's with each request. Answers now by Respond, or later.
  using Handler = std::function<void(const RosCaller& caller, const Request& request)>;

  RosService(const RosNode& node, const std::string& name, Handler handler, const dds::Qos& qos = Service())
      : id_(NewServiceId()),
        request_topic_(node.participant->participant(), "rq" + node.Resolve(name) + "Request"),
        response_topic_(node.participant->participant(), "rr" + node.Resolve(name) + "Reply"),
        participant_(node.participant),
        handler_(std::move(handler)),
        writer_(node.participant->publisher(), response_topic_, dds::Qos(qos) << ServiceUserData<Response>(id_)),
        reader_(node.participant->subscriber(), request_topic_, dds::Qos(qos) << ServiceUserData<Request>(id_)) {
    participant_->AddReader(node.index, reader_.handle());
    participant_->AddWriter(node.index, writer_.handle());
    dds::DataReaderListener listener;
    listener.on_data_available = [this] { Serve(); };
    reader_.set_listener(std::move(listener));
    Serve();
  }
  ~RosService() { reader_.clear_listener(); }
  RosService(const RosService&) = delete;
  RosService& operator=(const RosService&) = delete;

  // Safe to call from any thread.
  void Respond(const RosCaller& caller, Response& response) {
    response.client_guid = caller.client_guid;
    response.sequence_number = caller.sequence_number;
    if (dds_write(writer_.handle(), &response) != DDS_RETCODE_OK) participant_->CountLost();
  }

 private:
  void Serve() {
    for (;;) {
      const dds::LoanedSamples<Request> samples = reader_.take();
      if (samples.empty()) return;
      for (const auto sample : samples) {
        if (!sample.info().valid()) continue;
        handler_({sample.data().client_guid, sample.data().sequence_number}, sample.data());
      }
    }
  }

  std::string id_;
  dds::Topic<Request> request_topic_;
  dds::Topic<Response> response_topic_;
  RosParticipant* participant_;
  Handler handler_;
  dds::DataWriter<Response> writer_;
  dds::DataReader<Request> reader_;
};

}  // namespace troupe::ros
