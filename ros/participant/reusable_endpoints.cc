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
        if (sink_) sink_(wanted, is_new);
      }) {}

void ReusableWriter::Attach(std::size_t node, Sink sink) {
  participant_.AddWriter(node, writer_.handle());
  const std::lock_guard lock(mutex_);
  sink_ = std::move(sink);
  sink_(writer_.wanted(), writer_.wanted());
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

ReusableService::ReusableService(RosParticipant& participant, const ServiceSpec& spec)
    : participant_(participant),
      request_(*spec.request),
      response_(*spec.response),
      service_(participant, spec, [this](const void* request) { Pass(request); }) {}

void ReusableService::Attach(std::size_t node, Sink sink) {
  participant_.AddReader(node, service_.request_reader());
  participant_.AddWriter(node, service_.response_writer());
  const std::lock_guard lock(mutex_);
  sink_ = std::move(sink);
}

void ReusableService::Detach() {
  participant_.RemoveEndpoint(service_.request_reader());
  participant_.RemoveEndpoint(service_.response_writer());
  const std::lock_guard lock(mutex_);
  passes_ = false;
  sink_ = {};
}

void ReusableService::Pass(const void* request) {
  std::vector<std::byte> bytes = wire::SampleToCdr(request, request_);
  const std::lock_guard lock(mutex_);
  if (passes_) return sink_(bytes);
  waiting_.push_back(std::move(bytes));
  if (waiting_.size() > kMostWaiting) waiting_.pop_front();
}

void ReusableService::Start() {
  {
    const std::lock_guard lock(mutex_);
    passes_ = true;
    for (const std::vector<std::byte>& request : waiting_) sink_(request);
    waiting_.clear();
  }
  if (!std::exchange(started_, true)) service_.Start();
}

}  // namespace troupe::ros
