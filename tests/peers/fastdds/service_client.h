// A client of one ROS service on Fast DDS. It puts the caller's numbers before each message, as rmw_cyclonedds does and
// Troupe's services expect.
#pragma once

#include <chrono>
#include <condition_variable>
#include <map>
#include <mutex>
#include <stdexcept>
#include <string>

#include "peer.h"

inline constexpr int kSeconds = 60;  // timeout of a response, for the slowest machine

template <typename Condition>
void Until(const Condition& condition) {
  for (int i = 0; !condition(); ++i) {
    if (i > kSeconds * 1000) throw std::runtime_error("found no service");
    usleep(1000);
  }
}

template <typename Request, typename Response>
class Client {
 public:
  Client(Peer& peer, const std::string& service)
      : writer_(peer.Write<Request>("rq" + service + "Request")),
        reader_(peer.Read<Response>("rr" + service + "Reply", [this](const typename Response::type& response) {
          if (response.client_guid() != kGuid) return;
          const std::lock_guard lock(mutex_);
          responses_.emplace(response.sequence_number(), response);
          came_.notify_all();
        })) {}

  std::int64_t Send(typename Request::type request) {
    request.client_guid(kGuid);
    request.sequence_number(++number_);
    writer_->write(&request);
    return number_;
  }
  typename Response::type Await(std::int64_t number) {
    if (!IsAnswered(number, kSeconds)) throw std::runtime_error("no answer");
    const std::lock_guard lock(mutex_);
    return responses_.at(number);
  }

  // Repeats a request without effect until a response arrives. A request written before the service has discovered this
  // writer is lost, and DDS does not report when discovery is complete.
  void CallUntilAnswered(const typename Request::type& harmless) {
    Until([this] {
      PublicationMatchedStatus offered;
      SubscriptionMatchedStatus requested;
      writer_->get_publication_matched_status(offered);
      reader_->get_subscription_matched_status(requested);
      return offered.current_count > 0 && requested.current_count > 0;
    });
    for (int i = 0; !IsAnswered(Send(harmless), 1); ++i) {
      if (i > kSeconds) throw std::runtime_error("no response arrived");
    }
  }
  typename Response::type Call(const typename Request::type& request) { return Await(Send(request)); }

 private:
  bool IsAnswered(std::int64_t number, int seconds) {
    std::unique_lock lock(mutex_);
    return came_.wait_for(lock, std::chrono::seconds(seconds), [&] { return responses_.contains(number); });
  }

  static constexpr std::uint64_t kGuid = 0x5eed5eed;

  std::mutex mutex_;
  std::condition_variable came_;
  std::map<std::int64_t, typename Response::type> responses_;  // by sequence number
  std::int64_t number_ = 0;
  DataWriter* writer_;
  DataReader* reader_;
};
