#include "ros/participant/reusable_endpoints.h"

#include <utility>

#include "transport/wire/cdr.h"

namespace troupe::ros {
namespace {

constexpr std::size_t kMostWaiting = 100;  // requests to a service without an agent

}  // namespace

ReusableWriter::ReusableWriter(RosParticipant& participant, const TopicSpec& spec)
    : participant_(participant),
      type_(*spec.type),
      is_volatile_(spec.qos.kind == TopicQos::Kind::kStream),
      writer_(participant, spec, [this](bool wanted, bool is_new) {
        const std::lock_guard lock(mutex_);
        if (sink_) return sink_(wanted, is_new);
        has_new_ = has_new_ || is_new;
      }) {}

void ReusableWriter::Attach(std::size_t node, Sink sink) {
  participant_.AddWriter(node, writer_.handle());
  const std::lock_guard lock(mutex_);
  sink_ = std::move(sink);
  // Readers of the agent before have its samples.
  sink_(writer_.wanted(), std::exchange(has_new_, false) && writer_.wanted());
}

void ReusableWriter::Detach() {
  participant_.RemoveEndpoint(writer_.handle());
  {
    const std::lock_guard lock(mutex_);
    sink_ = {};
  }
  if (is_volatile_) return;
  const wire::UntypedSample none(type_);
  dds_dispose(writer_.handle(), none.data());
}

ReusableReader::ReusableReader(RosParticipant& participant, const TopicSpec& spec, Part part)
    : participant_(participant),
      topic_(spec.topic),
      part_(part),
      reader_(participant, spec, part,
              {[this] { Pass(); },
               [this] {
                 const std::lock_guard lock(mutex_);
                 if (sink_) sink_->on_missed_writer();
               }}) {}

void ReusableReader::Attach(std::size_t node, Sink sink) {
  participant_.AddReader(node, reader_.handle(), part_ == Part::kReliableReader);
  {
    const std::lock_guard lock(mutex_);
    if (std::exchange(used_, true)) reader_.Drain([](const void*) {});
    sink_ = std::move(sink);
    if (reader_.missed_writer()) sink_->on_missed_writer();
  }
  Pass();
}

void ReusableReader::Detach() {
  participant_.RemoveEndpoint(reader_.handle());
  const std::lock_guard lock(mutex_);
  sink_.reset();
}

void ReusableReader::Pass() {
  const std::lock_guard lock(mutex_);
  if (sink_) reader_.Drain(sink_->on_sample);
}

ReusableService::ReusableService(RosParticipant& participant, const ServiceSpec& spec, std::uint32_t domain,
                                 FastDdsSide* fast_dds, bool on_cyclone)
    : participant_(participant), request_(*spec.request), response_(*spec.response), fast_dds_(fast_dds) {
  if (on_cyclone) {
    cyclone_.emplace(participant, spec, [this](const void* request) { Pass(wire::SampleToCdr(request, request_)); });
  }
  if (fast_dds_ == nullptr) return;
  fast_id_ = fast_dds_->Add({domain, spec.name, request_.m_typename, response_.m_typename},
                            [this](std::span<const std::byte> request) { PassOfFastDds(request); });
}

ReusableService::~ReusableService() {
  if (fast_dds_ != nullptr) fast_dds_->Remove(fast_id_);
}

void ReusableService::Attach(std::size_t node, Sink sink) {
  if (cyclone_) {
    participant_.AddReader(node, cyclone_->request_reader());
    participant_.AddWriter(node, cyclone_->response_writer());
  }
  const std::lock_guard lock(mutex_);
  sink_ = std::move(sink);
}

void ReusableService::Detach() {
  if (cyclone_) {
    participant_.RemoveEndpoint(cyclone_->request_reader());
    participant_.RemoveEndpoint(cyclone_->response_writer());
  }
  const std::lock_guard lock(mutex_);
  passes_ = false;
  sink_ = {};
}

void ReusableService::Pass(std::span<const std::byte> request) {
  const std::lock_guard lock(mutex_);
  if (passes_) return sink_(request);
  waiting_.emplace_back(request.begin(), request.end());
  if (waiting_.size() > kMostWaiting) waiting_.pop_front();
}

// Fast DDS pads samples to a multiple of 4 bytes, without stating it in their fourth byte. Any bytes are safe.
void ReusableService::PassOfFastDds(std::span<const std::byte> request) {
  constexpr std::size_t kPaddingAt = 3;
  if (request.size() <= kPaddingAt) return;
  std::vector<std::byte> bytes(request.begin(), request.end());
  for (unsigned padding = 0; padding <= 3; ++padding) {
    bytes[kPaddingAt] = static_cast<std::byte>(padding);
    const wire::UntypedSample sample(request_);
    if (wire::SampleFromCdr(bytes, request_, sample.data()).ok()) return Pass(bytes);
  }
}

void ReusableService::Start() {
  {
    const std::lock_guard lock(mutex_);
    passes_ = true;
    for (const std::vector<std::byte>& request : waiting_) sink_(request);
    waiting_.clear();
  }
  if (!std::exchange(started_, true) && cyclone_) cyclone_->Start();
}

bool ReusableService::Respond(const void* response, std::span<const std::byte> bytes) {
  const std::uint64_t client = static_cast<const CallHeader*>(response)->client_guid;
  if (fast_dds_ != nullptr && fast_dds_->Respond(fast_id_, client, bytes)) return true;
  return !cyclone_ || cyclone_->Respond(response);
}

}  // namespace troupe::ros
