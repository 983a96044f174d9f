// RosService<Request, Response>: a service as rmw_cyclonedds lays it out: two topics, whose types begin with the id of
// the caller and the number of its call. Callers on rmw_fastrtps send these two beside the message, where Cyclone's
// interface gives no access; the program ros-service-bridge passes their calls on.
#pragma once

#include <algorithm>
#include <functional>
#include <list>
#include <mutex>
#include <string>
#include <vector>

#include "common/dds/binding/data_reader.h"
#include "common/dds/binding/data_writer.h"
#include "common/dds/binding/wire.h"
#include "common/ros/bridge_call.h"
#include "common/ros_dds/ros_participant.h"
#include "common/ros_dds/ros_qos.h"
#include "common/ros_dds/topic_types.h"
#include "common/ros_dds/user_data.h"

namespace troupe::ros {

// Whether the constructor of a service starts it, or Start, once all that its handler needs exists.
enum class Serving : std::uint8_t { kAtOnce, kWhenStarted };

// The address of a response.
struct RosCaller {
  std::uint64_t client_guid = 0;
  std::int64_t sequence_number = 0;
};

template <typename Request, typename Response>
class RosService {
 public:
  // Called on one of Cyclone's threads with each request. It calls Respond, at once or later.
  using Handler = std::function<void(const RosCaller& caller, const Request& request)>;

  RosService(const RosNode& node, const std::string& name, Handler handler, const dds::Qos& qos = Service(),
             Serving serving = Serving::kAtOnce)
      : id_(NewServiceId()),
        request_topic_(node.participant->participant(), "rq" + node.Resolve(name) + "Request"),
        response_topic_(node.participant->participant(), "rr" + node.Resolve(name) + "Reply"),
        participant_(node.participant),
        handler_(std::move(handler)),
        writer_(participant_->service_publisher(), response_topic_,
                dds::Qos(qos) << ServiceUserData<Response>(participant_->distribution(), id_)),
        reader_(participant_->service_subscriber(), request_topic_,
                dds::Qos(qos) << ServiceUserData<Request>(participant_->distribution(), id_)) {
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

  // Call once, with kWhenStarted. Handles the requests that have arrived before.
  void Start() {
    dds::DataReaderListener listener;
    listener.on_data_available = [this] { Serve(); };
    reader_.set_listener(std::move(listener));
    dds::DataWriterListener matched;
    matched.on_publication_matched = [this](const dds::PublicationMatchedStatus&) { Serve(); };
    writer_.set_listener(std::move(matched));
    Serve();
  }

  // Safe to call from any thread.
  void Respond(const RosCaller& caller, Response& response) {
    response.client_guid = caller.client_guid;
    response.sequence_number = caller.sequence_number;
    if (dds_write(writer_.handle(), &response) != DDS_RETCODE_OK) participant_->CountLost();
  }

 private:
  // Samples of one call of take(), with a flag for each handled one.
  struct Batch {
    dds::LoanedSamples<Request> samples;
    std::vector<bool> handled;
  };
  static constexpr std::size_t kMostWaiting = 100;

  // A request may arrive before discovery of its caller's reader; it waits for that, or its response would be lost.
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
      for (std::size_t i = 0; i < batch.samples.length(); ++i) Deliver(batch, i);
    }
    std::erase_if(waiting_, [](const Batch& batch) {
      return std::find(batch.handled.begin(), batch.handled.end(), false) == batch.handled.end();
    });
  }

  void Deliver(Batch& batch, std::size_t i) {
    if (batch.handled[i]) return;
    const auto sample = batch.samples[i];
    if (sample.info().valid()) {
      if (!HasReaderOf(writer_.handle(), reader_.handle(), sample.info().publication_handle())) return;
      const RosCaller caller{sample.data().client_guid, sample.data().sequence_number};
      if (recent_.Add(caller.client_guid, caller.sequence_number)) handler_(caller, sample.data());
    }
    batch.handled[i] = true;
  }

  std::string id_;
  dds::Topic<Request> request_topic_;
  dds::Topic<Response> response_topic_;
  RosParticipant* participant_;
  Handler handler_;
  std::mutex mutex_;  // guards recent_ and waiting_
  RecentBridgeCalls recent_;
  dds::DataWriter<Response> writer_;
  dds::DataReader<Request> reader_;
  std::list<Batch> waiting_;  // destroyed before reader_, which lent the samples
};

}  // namespace troupe::ros
