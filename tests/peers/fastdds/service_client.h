// A client of one ROS service on Fast DDS, as rmw_fastrtps_cpp of Humble and Jazzy makes it: beside each request it
// names its reader of responses, and a response names that reader and the request's number in the same place.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <map>
#include <memory>
#include <mutex>
#include <stdexcept>
#include <string>
#include <utility>

#include "peer.h"
#include "without_numbers.h"

inline constexpr int kSeconds = 60;  // timeout of a response, for the slowest machine

template <typename Condition>
void Until(const Condition& condition) {
  for (int i = 0; !condition(); ++i) {
    if (i > kSeconds * 1000) throw std::runtime_error("found no service");
    usleep(1000);
  }
}

// Waits until the program that writes `topic`, repeatedly, has discovered this reader, and with it all readers made
// before: their topics come from the program itself, which may discover them later than the service answers.
template <typename PubSubType>
void AwaitSampleOf(Peer& peer, const std::string& topic) {
  const auto came = std::make_shared<std::atomic<bool>>(false);
  peer.Read<PubSubType>(topic, [came](const auto&) { *came = true; });
  Until([&came] { return came->load(); });
}

template <typename Request, typename Response>
class Client {
 public:
  using Samples = eprosima::fastrtps::rtps::WriteParams;

  Client(Peer& peer, const std::string& service)
      : writer_(peer.Write<WithoutNumbers<Request>>("rq" + service + "Request")),
        reader_(peer.ReadWithInfo<WithoutNumbers<Response>>(
            "rr" + service + "Reply", [this](const typename Response::type& response, const SampleInfo& info) {
              const DataReader* const self = self_;
              if (self == nullptr || info.related_sample_identity.writer_guid() != self->guid()) return;
              const std::lock_guard lock(mutex_);
              const std::int64_t number = info.related_sample_identity.sequence_number().to64long();
              if (!responses_.emplace(number, response).second) ++repeated_;
              came_.notify_all();
            })) {
    self_ = reader_;
  }

  std::int64_t Send(typename Request::type request) {
    Samples samples;
    samples.related_sample_identity().writer_guid(reader_->guid());
    if (!writer_->write(&request, samples)) throw std::runtime_error("cannot write a request");
    return samples.sample_identity().sequence_number().to64long();
  }
  typename Response::type Await(std::int64_t number) {
    if (!IsAnswered(number, kSeconds)) throw std::runtime_error("no answer");
    const std::lock_guard lock(mutex_);
    return responses_.at(number);
  }
  bool IsAnswered(std::int64_t number, int seconds) {
    std::unique_lock lock(mutex_);
    return came_.wait_for(lock, std::chrono::seconds(seconds), [&] { return responses_.contains(number); });
  }

  // As rclcpp's wait_for_service.
  void WaitForService() {
    Until([this] {
      const auto [readers, writers] = Matched();
      return readers > 0 && writers > 0;
    });
  }
  // Readers of its requests and writers of its responses.
  std::pair<int, int> Matched() const {
    PublicationMatchedStatus offered;
    SubscriptionMatchedStatus requested;
    writer_->get_publication_matched_status(offered);
    reader_->get_subscription_matched_status(requested);
    return {offered.current_count, requested.current_count};
  }
  typename Response::type Call(const typename Request::type& request) { return Await(Send(request)); }
  int repeated() {
    const std::lock_guard lock(mutex_);
    return repeated_;
  }

 private:
  std::mutex mutex_;
  std::condition_variable came_;
  std::map<std::int64_t, typename Response::type> responses_;  // by number of the request
  int repeated_ = 0;                                           // responses to an answered request
  std::atomic<const DataReader*> self_ = nullptr;              // reader_, once it exists
  DataWriter* writer_;
  DataReader* reader_;
};
