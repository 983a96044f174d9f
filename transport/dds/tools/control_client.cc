#include "transport/dds/tools/control_client.h"

#include <algorithm>
#include <chrono>
#include <set>
#include <thread>
#include <utility>
#include <vector>

#include "common/base/identity.h"
#include "transport/dds/binding/data_reader.h"
#include "transport/dds/binding/network_log.h"
#include "transport/dds/convert/convert.h"
#include "transport/dds/transport/dds_connection.h"
#include "transport/dds/transport/qos_profiles.h"
#include "transport/security/session_keys.h"

namespace troupe {
namespace {

using Clock = std::chrono::steady_clock;
using Deadline = std::chrono::time_point<Clock, std::chrono::duration<double>>;

// Between two looks for the keys of a run that has not been found yet.
constexpr std::chrono::milliseconds kKeysPeriod(100);

// s; a longer wait is several of these.
constexpr double kMaxWait = 1.0;

// s: the first request is repeated, since a lost reply is resent no sooner than after a heartbeat. A service that is
// stopped for longer than all repetitions is not waited for.
constexpr double kGreetingPeriod = 0.1;
constexpr int kGreetings = 20;

}  // namespace

class ControlClient::Connection {
 public:
  Connection(const dds::DomainConfig& config, const std::string& session, const ParticipantKeys& keys)
      : keys_(keys),
        session_(session),
        connection_(config, session, {}, keys.token),
        request_topic_(connection_.participant, topics::kControl),
        reply_topic_(connection_.participant, topics::kControlReply),
        requests_(connection_.publisher, request_topic_, connection_.proof.Announced(dds::qos_profiles::Control())),
        replies_(connection_.subscriber, reply_topic_, dds::qos_profiles::ControlReply()),
        answered_(replies_),
        changes_(connection_.participant) {
    dds::Check(dds_set_status_mask(requests_.handle(), DDS_PUBLICATION_MATCHED_STATUS), "watching a writer");
    dds::Check(dds_set_status_mask(replies_.handle(), DDS_SUBSCRIPTION_MATCHED_STATUS), "watching a reader");
    changes_.attach(answered_, 0);
    changes_.attach(requests_, 1);
    changes_.attach(replies_, 2);
  }

  const ParticipantKeys& keys() const { return keys_; }

  // Whether a world service of the session receives requests and sends replies.
  bool connected() {
    // Reading the statuses clears them: the wait set wakes for a new one only.
    requests_.publication_matched_status();
    replies_.subscription_matched_status();
    // Both directions have to be matched, of one participant: a request must find a reader, and its reply a way back.
    const std::set<dds::GuidPrefix> receivers = dds::MatchedReaders(requests_.handle());
    services_.clear();
    foreign_ = false;
    for (const dds_instance_handle_t writer : dds::MatchedPublications(replies_.handle())) {
      const auto publication = dds::MatchedPublicationData(replies_.handle(), writer);
      if (!publication || !receivers.contains(publication->participant)) continue;
      const dds::ProofCheck check = connection_.proof.Check(publication->participant, publication->user_data);
      if (check == dds::ProofCheck::kAccepted) services_.insert(writer);
      if (check == dds::ProofCheck::kUnknownProof) foreign_ = true;
    }
    return !services_.empty();
  }

  // When last looked for, there was only a service of a run whose token this user does not have.
  bool is_foreign() const { return services_.empty() && foreign_; }

  // Before its discovery is complete, a service may receive requests while it does not know the reader of the replies
  // yet: it keeps them for the reader, but not beyond its own end. The reply to a request without an effect shows that
  // the next ones arrive in any case. False: the service is gone.
  bool Greet() {
    for (int i = 0; i < kGreetings && !has_answered_ && connected(); ++i) {
      has_answered_ = Call(control::GetStatus(), kGreetingPeriod).ok();
    }
    return connected();
  }

  // Returns early when a reply arrives, or a service appears or disappears.
  void WaitUntil(Deadline deadline) {
    const std::chrono::duration<double> left = deadline - Clock::now();
    changes_.wait(std::clamp(left.count(), 0.0, kMaxWait));
  }

  Result<ControlReply> Call(const control::Request& asked, double seconds) {
    dds::WireArena arena;
    const std::uint64_t number = ++number_;
    const ControlRequest request{client_, number, asked};
    connected();
    // A service that appears later, to continue the run of one that died, does not know the request.
    const std::set<dds_instance_handle_t> services = services_;
    requests_.write(dds::ToWire(request, arena));
    const Deadline deadline = Clock::now() + std::chrono::duration<double>(seconds);
    for (;;) {
      // The order matters: statuses are read, then the match, then the replies, and only then does the client wait. A
      // change between any two of these wakes the wait.
      connected();  // so that the wait below wakes for the next change
      // Looked for before the replies are taken: a service may reply and end at once.
      const bool is_answering = IsAnyMatched(services);
      for (const auto sample : replies_.take()) {
        if (!sample.info().valid() || !services.contains(sample.info().publication_handle())) continue;
        Result<ControlReply> reply = dds::FromWire(sample.data());
        if (reply.ok() && reply.value().client == client_ && reply.value().number == number) return reply;
      }
      if (!is_answering) return Failure("the world service of session '" + session_ + "' is gone");
      if (seconds > 0.0 && Clock::now() > deadline) {
        return Failure("the world service of session '" + session_ + "' did not answer");
      }
      WaitUntil(seconds > 0.0 ? deadline : Deadline::max());
    }
  }

 private:
  // The writer of a service remains matched until its last sample has been delivered; the reader of its requests is
  // gone before.
  bool IsAnyMatched(const std::set<dds_instance_handle_t>& writers) const {
    const std::vector<dds_instance_handle_t> matched = dds::MatchedPublications(replies_.handle());
    return std::ranges::any_of(matched, [&](dds_instance_handle_t writer) { return writers.contains(writer); });
  }

  const ParticipantKeys keys_;
  std::string session_;
  dds::DdsConnection connection_;
  dds::Topic<troupe_wire_Control> request_topic_;
  dds::Topic<troupe_wire_ControlReply> reply_topic_;
  dds::DataWriter<troupe_wire_Control> requests_;
  dds::DataReader<troupe_wire_ControlReply> replies_;
  dds::ReadCondition answered_;
  dds::WaitSet changes_;
  std::set<dds_instance_handle_t> services_;  // the writers of their replies
  bool foreign_ = false;
  bool has_answered_ = false;
  std::uint64_t client_ = MakeRandomId();
  std::uint64_t number_ = 0;
};

ControlClient::ControlClient(const NetworkSettings& network) : network_(network) {}

ControlClient::~ControlClient() = default;

Status ControlClient::WaitForService(double seconds) {
  const Deadline deadline = Clock::now() + std::chrono::duration<double>(seconds);
  for (;;) {
    // The run may publish its keys while this waits.
    const Result<ParticipantKeys> keys =
        FindKeys(network_.security, network_.domain, network_.session, Role::Operator());
    if (!keys.ok() && keys.error().code == ErrorCode::kFailure && Clock::now() < deadline) {
      std::this_thread::sleep_for(kKeysPeriod);
      continue;
    }
    if (!keys.ok()) return keys.error();
    if (!connection_ || connection_->keys() != keys.value()) {
      dds::PrintFirstNetworkMessage();
      dds::DomainConfig config = dds::ToolConfig(network_.domain, network_.network_interface, network_.service_address);
      dds::SetKeys(config, keys.value().enclave);
      connection_ = std::make_unique<Connection>(config, network_.session, keys.value());
    }
    if (connection_->Greet()) return {};
    if (Clock::now() > deadline) {
      return Failure(connection_->is_foreign()
                         ? "session '" + network_.session + "' is of another user: no keys of it for this user"
                         : "no world service found in session '" + network_.session + "'");
    }
    connection_->WaitUntil(std::min(deadline, Deadline(Clock::now() + kKeysPeriod)));
  }
}

Result<ControlReply> ControlClient::Call(const control::Request& request, double seconds) {
  if (!connection_) return Failure("not connected to the world service of session '" + network_.session + "'");
  return connection_->Call(request, seconds);
}

}  // namespace troupe
