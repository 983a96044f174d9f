// RosService<Request, Response>: a service as rmw_cyclonedds offers one: two topics, whose types begin with the
// caller's id and the number of its call. Callers on rmw_fastrtps are not understood: they put these beside the
// message, where Cyclone's interface gives no access.
#pragma once

#include <algorithm>
#include <functional>
#include <list>
#include <mutex>
#include <string>
#include <vector>

#include "common/dds/data_reader.h"
#include "common/dds/data_writer.h"
#include "common/dds/wire.h"
#include "common/ros_dds/ros_participant.h"
#include "common/ros_dds/ros_qos.h"
#include "common/ros_dds/topic_types.h"
#include "common/ros_dds/type_hash.h"

namespace troupe::ros {

// When a service calls its handler first: as soon as it is made, or when it is told by Start, because what the handler
// needs is not there before.
enum class Serving : std::uint8_t { kAtOnce, kWhenStarted };

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

  RosService(const RosNode& node, const std::string& name, Handler handler, const dds::Qos& qos = Service(),
             Serving serving = Serving::kAtOnce)
      : id_(NewServiceId()),
        request_topic_(node.participant->participant(), "rq" + node.Resolve(name) + "Request"),
        response_topic_(node.participant->participant(), "rr" + node.Resolve(name) + "Reply"),
        participant_(node.participant),
        handler_(std::move(handler)),
        writer_(node.participant->publisher(), response_topic_, dds::Qos(qos) << ServiceUserData<Response>(id_)),
        reader_(node.participant->subscriber(), request_topic_, dds::Qos(qos) << ServiceUserData<Request>(id_)) {
    participant_->AddReader(node.index, reader_.handle());
    participant_->AddWriter(node.index, writer_.handle());
    if (serving == Serving::kAtOnce) Start();
  }
  ~RosService() {
    reader_.clear_listener();
    writer_.clear_listener();
  }
  RosService(const RosService&) = delete;
  RosService& operator=(const RosService&) = delete;

  // Call once, if it was not to serve at once. Handles what has come by then.
  void Start() {
    dds::DataReaderListener listener;
    listener.on_data_available = [this] { Serve(); };
    reader_.set_listener(std::move(listener));
    dds::DataWriterListener met;
    met.on_publication_matched = [this](const dds::PublicationMatchedStatus&) { Serve(); };
    writer_.set_listener(std::move(met));
    Serve();
  }

  // Safe to call from any thread.
  void Respond(const RosCaller& caller, Response& response) {
    response.client_guid = caller.client_guid;
    response.sequence_number = caller.sequence_number;
    if (dds_write(writer_.handle(), &response) != DDS_RETCODE_OK) participant_->CountLost();
  }

 private:
  // Requests that came together, and which of them were handled.
  struct Batch {
    dds::LoanedSamples<Request> samples;
    std::vector<bool> handled;
  };
  static constexpr std::size_t kMostWaiting = 100;

  // A request may come before its caller's reader of answers was met; then it waits for that, or the answer were lost.
  void Serve() {
    const std::lock_guard lock(mutex_);
    for (;;) {
      dds::LoanedSamples<Request> samples = reader_.take();
      if (samples.empty()) break;
      std::vector<bool> handled(samples.length(), false);
      waiting_.push_back({std::move(samples), std::move(handled)});
      if (waiting_.size() > kMostWaiting) waiting_.pop_front();
    }
    for (Batch& batch : waiting_) {
      for (std::size_t i = 0; i < batch.samples.length(); ++i) Handle(batch, i);
    }
    std::erase_if(waiting_, [](const Batch& batch) {
      return std::find(batch.handled.begin(), batch.handled.end(), false) == batch.handled.end();
    });
  }

  void Handle(Batch& batch, std::size_t i) {
    if (batch.handled[i]) return;
    const auto sample = batch.samples[i];
    if (sample.info().valid()) {
      if (!HasReaderOf(writer_.handle(), reader_.handle(), sample.info().publication_handle())) return;
      handler_({sample.data().client_guid, sample.data().sequence_number}, sample.data());
    }
    batch.handled[i] = true;
  }

  std::string id_;
  dds::Topic<Request> request_topic_;
  dds::Topic<Response> response_topic_;
  RosParticipant* participant_;
  Handler handler_;
  std::mutex mutex_;  // guards what waits
  dds::DataWriter<Response> writer_;
  dds::DataReader<Request> reader_;
  std::list<Batch> waiting_;  // before the reader that lent the samples
};

}  // namespace troupe::ros
