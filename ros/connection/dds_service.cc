#include "ros/connection/dds_service.h"

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <random>
#include <utility>

#include "ros/connection/user_data.h"
#include "transport/dds/binding/topic.h"

namespace troupe::ros {
namespace {

constexpr std::size_t kMostWaiting = 100;

// 16 random bytes as ROS writes them, "01.0f.10...".
std::string NewServiceId() {
  std::random_device device;
  std::string id;
  for (int i = 0; i < 16; ++i) {
    char byte[4];
    std::snprintf(byte, sizeof byte, "%s%02x", i == 0 ? "" : ".", static_cast<unsigned>(device() & 0xffU));
    id += byte;
  }
  return id;
}

// Whether `writer` matches a reader of the participant that owns the writer `publication`, which `reader` matches.
bool HasReaderOf(dds_entity_t writer, dds_entity_t reader, dds_instance_handle_t publication) {
  dds_builtintopic_endpoint_t* const sender = dds_get_matched_publication_data(reader, publication);
  if (sender == nullptr) return true;  // the caller has left; an answer does no harm
  const dds_guid_t participant = sender->participant_key;
  dds_builtintopic_free_endpoint(sender);
  std::vector<dds_instance_handle_t> subscriptions(64);
  dds_return_t count = 0;
  for (;;) {
    count = dds_get_matched_subscriptions(writer, subscriptions.data(), subscriptions.size());
    if (count <= static_cast<dds_return_t>(subscriptions.size())) break;
    subscriptions.resize(static_cast<std::size_t>(count));
  }
  for (dds_return_t i = 0; i < count; ++i) {
    dds_builtintopic_endpoint_t* const receiver =
        dds_get_matched_subscription_data(writer, subscriptions[static_cast<std::size_t>(i)]);
    if (receiver == nullptr) continue;
    const bool same = std::memcmp(receiver->participant_key.v, participant.v, sizeof participant.v) == 0;
    dds_builtintopic_free_endpoint(receiver);
    if (same) return true;
  }
  return false;
}

}  // namespace

DdsService::DdsService(RosParticipant& owner, const ServiceSpec& spec, Handler handler)
    : owner_(owner),
      handler_(std::move(handler)),
      id_(NewServiceId()),
      request_topic_(dds::CreateTopic(owner.participant(), *spec.request, "rq" + spec.name + "Request")),
      response_topic_(dds::CreateTopic(owner.participant(), *spec.response, "rr" + spec.name + "Reply")),
      writer_(dds::Check(
          dds_create_writer(owner.service_publisher().handle(), response_topic_.handle(),
                            (ToDds(spec.qos) << ServiceUserData(owner.distribution(), id_, *spec.response)).get(),
                            nullptr),
          "creating the writer of service '" + spec.name + "'")),
      reader_(dds::Check(
          dds_create_reader(owner.service_subscriber().handle(), request_topic_.handle(),
                            (ToDds(spec.qos) << ServiceUserData(owner.distribution(), id_, *spec.request)).get(),
                            nullptr),
          "creating the reader of service '" + spec.name + "'")) {}

DdsService::~DdsService() {
  owner_.RemoveEndpoint(reader_.handle());
  owner_.RemoveEndpoint(writer_.handle());
  dds::ClearListener(reader_.handle());
  dds::ClearListener(writer_.handle());
}

void DdsService::Start() {
  reader_listener_.on_data_available = [this] { Serve(); };
  dds::SetListener(reader_.handle(), reader_listener_);
  writer_listener_.on_publication_matched = [this](const dds::PublicationMatchedStatus&) { Serve(); };
  dds::SetListener(writer_.handle(), writer_listener_);
  Serve();
}

bool DdsService::Respond(const void* response) noexcept {
  return dds_write(writer_.handle(), response) == DDS_RETCODE_OK;
}

// A request may arrive before discovery of its caller's reader; it waits for that, or its response would be lost.
void DdsService::Serve() {
  const std::lock_guard lock(mutex_);
  for (;;) {
    auto samples = dds::Loan<CallHeader>(reader_.handle(), dds_take, "taking requests");
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

void DdsService::Deliver(Batch& batch, std::size_t i) {
  if (batch.handled[i]) return;
  const auto sample = batch.samples[i];
  if (sample.info().valid()) {
    if (!HasReaderOf(writer_.handle(), reader_.handle(), sample.info().publication_handle())) return;
    handler_(&sample.data());
  }
  batch.handled[i] = true;
}

}  // namespace troupe::ros
