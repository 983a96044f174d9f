#include "common/dds/control_client.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "common/base/random_id.h"
#include "common/dds/condition.h"
#include "common/dds/convert_control.h"
#include "common/dds/data_reader.h"
#include "common/dds/data_writer.h"
#include "common/dds/domain_participant.h"
#include "common/dds/publisher.h"
#include "common/dds/qos_profiles.h"
#include "common/dds/topic_types.h"
#include "common/dds/topics.h"
#include "common/dds/wait_set.h"

namespace troupe {
namespace {

using Clock = std::chrono::steady_clock;
using Deadline = std::chrono::time_point<Clock, std::chrono::duration<double>>;

// s; a wait goes on after it.
constexpr double kLongestWait = 1.0;

}  // namespace

class ControlClient::Implementation {
 public:
  Implementation(const dds::DomainConfig& config, const std::string& session)
      : session_(session),
        participant_(config),
        publisher_(participant_, dds::qos_profiles::Session(session)),
        subscriber_(participant_, dds::qos_profiles::Session(session)),
        request_topic_(participant_, dds::topics::kControl),
        reply_topic_(participant_, dds::topics::kControlReply),
        requests_(publisher_, request_topic_, dds::qos_profiles::Control()),
        replies_(subscriber_, reply_topic_, dds::qos_profiles::ControlReply()),
        answered_(replies_),
        changes_(participant_) {
    dds::Check(dds_set_status_mask(requests_.handle(), DDS_PUBLICATION_MATCHED_STATUS), "watching a writer");
    dds::Check(dds_set_status_mask(replies_.handle(), DDS_SUBSCRIPTION_MATCHED_STATUS), "watching a reader");
    changes_.attach(answered_, 0);
    changes_.attach(requests_, 1);
    changes_.attach(replies_, 2);
  }

  Status WaitForService(double seconds) {
    const Deadline deadline = Clock::now() + std::chrono::duration<double>(seconds);
    while (!connected()) {
      if (Clock::now() > deadline) return Error{{}, "no world service found in session '" + session_ + "'"};
      WaitUntil(deadline);
    }
    return {};
  }

  Result<ControlReply> Call(ControlRequest request, double seconds) {
    dds::WireArena arena;
    const std::uint64_t number = ++number_;
    request.client = client_;
    request.number = number;
    requests_.write(dds::ToWire(request, arena));
    const Deadline deadline = Clock::now() + std::chrono::duration<double>(seconds);
    for (;;) {
      for (const auto sample : replies_.take()) {
        ControlReply reply;
        if (!sample.info().valid() || dds::FromWire(sample.data(), reply)) continue;
        if (reply.client == client_ && reply.number == number) return reply;
      }
      if (!connected()) return Error{{}, "the world service of session '" + session_ + "' is gone"};
      if (seconds > 0.0 && Clock::now() > deadline) {
        return Error{{}, "the world service of session '" + session_ + "' did not answer"};
      }
      WaitUntil(seconds > 0.0 ? deadline : Deadline::max());
    }
  }

 private:
  // Both are read each time, because that is what makes the wait set take note of them.
  bool connected() const {
    const auto offered = requests_.publication_matched_status();
    const auto requested = replies_.subscription_matched_status();
    return offered.current_count > 0 && requested.current_count > 0;
  }

  // Until an answer is there, or the service comes or goes.
  void WaitUntil(Deadline deadline) {
    const std::chrono::duration<double> left = deadline - Clock::now();
    changes_.wait(std::clamp(left.count(), 0.0, kLongestWait));
  }

  std::string session_;
  dds::DomainParticipant participant_;
  dds::Publisher publisher_;
  dds::Subscriber subscriber_;
  dds::Topic<troupe_wire_Control> request_topic_;
  dds::Topic<troupe_wire_ControlReply> reply_topic_;
  dds::DataWriter<troupe_wire_Control> requests_;
  dds::DataReader<troupe_wire_ControlReply> replies_;
  dds::ReadCondition answered_;
  dds::WaitSet changes_;
  std::uint64_t client_ = MakeRandomId();
  std::uint64_t number_ = 0;
};

ControlClient::ControlClient(std::uint32_t domain, const std::string& session, const std::string& network_interface,
                             const std::string& service_address)
    : implementation_(
          std::make_unique<Implementation>(dds::ToolConfig(domain, network_interface, service_address), session)) {}

ControlClient::~ControlClient() = default;

Status ControlClient::WaitForService(double seconds) {
  return implementation_->WaitForService(seconds);
}

Result<ControlReply> ControlClient::Call(ControlRequest request, double seconds) {
  return implementation_->Call(std::move(request), seconds);
}

Result<ControlReply> ControlClient::Call(ControlCommand command, std::uint64_t ticks, double seconds) {
  ControlRequest request;
  request.command = command;
  request.ticks = ticks;
  return Call(std::move(request), seconds);
}

}  // namespace troupe
