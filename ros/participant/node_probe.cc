#include "ros/participant/node_probe.h"

#include <random>

#include "ros/connection/dds_endpoints.h"
#include "ros/connection/ros_network.h"

namespace troupe::ros {
namespace {

constexpr auto kAskAgain = std::chrono::seconds(1);

std::uint64_t NewClientId() {
  std::random_device device;
  return (std::uint64_t{device()} << 32) | device();
}

}  // namespace

NodeProbe::NodeProbe(const RosParticipant& participant, const std::string& service)
    : id_(NewClientId()),
      request_topic_(participant.participant(), "rq" + service + "Request"),
      response_topic_(participant.participant(), "rr" + service + "Reply"),
      writer_(participant.publisher(), request_topic_,
              ToDds(Service()) << TypeUserData<Request>(participant.distribution())),
      reader_(participant.subscriber(), response_topic_,
              ToDds(Service()) << TypeUserData<Response>(participant.distribution())) {}

std::optional<NodeProbe::Time> NodeProbe::Poll(Time now) {
  for (;;) {
    const auto samples = reader_.take();
    if (samples.empty()) break;
    for (const auto sample : samples) {
      if (!answered_at_ && sample.info().valid() && sample.data().client_guid == id_) answered_at_ = now;
    }
  }
  const bool is_due = !asked_at_ || now - *asked_at_ > kAskAgain;
  if (answered_at_ || !is_due || writer_.publication_matched_status().current_count == 0 ||
      reader_.subscription_matched_status().current_count == 0) {
    return answered_at_;
  }
  asked_at_ = now;
  Request request{};
  request.client_guid = id_;
  request.sequence_number = ++questions_;
  writer_.write(request);
  return std::nullopt;
}

}  // namespace troupe::ros
