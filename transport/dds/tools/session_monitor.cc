#include "transport/dds/tools/session_monitor.h"

#include <algorithm>
#include <chrono>
#include <exception>
#include <iterator>
#include <map>
#include <set>
#include <stdexcept>
#include <tuple>
#include <utility>

#include "common/base/text.h"
#include "transport/dds/binding/data_reader.h"
#include "transport/dds/binding/network_log.h"
#include "transport/dds/convert/convert.h"
#include "transport/dds/transport/dds_connection.h"
#include "transport/dds/transport/dds_transport.h"
#include "transport/dds/transport/qos_profiles.h"
#include "transport/security/session_keys.h"

namespace troupe {
namespace {

constexpr const char* kAllSessions = "*";  // as a partition

struct KnownRun {
  SessionInfo info;
  dds::GuidPrefix service;
  dds_instance_handle_t session_writer = 0;
};

// The sessions that one participant sees.
class MonitoringParticipant {
 public:
  explicit MonitoringParticipant(const dds::DomainConfig& config)
      : connection_(config, kAllSessions, {}),
        session_topic_(connection_.participant, topics::kSession),
        status_topic_(connection_.participant, topics::kStatus),
        sessions_(connection_.subscriber, session_topic_,
                  dds::qos_profiles::FromMany(dds::qos_profiles::Description())),
        statuses_(connection_.subscriber, status_topic_, dds::qos_profiles::FromMany(dds::qos_profiles::Status())),
        session_condition_(sessions_),
        status_condition_(statuses_) {
    dds::Check(dds_set_status_mask(sessions_.handle(), DDS_SUBSCRIPTION_MATCHED_STATUS), "watching a reader");
  }

  template <typename Use>
  void ForEachCondition(const Use& use) const {
    use(sessions_);
    use(session_condition_);
    use(status_condition_);
  }

  // `tokens`: of the user's own runs, by session.
  void AddSessions(const std::map<std::string, RunToken>& tokens, std::vector<SessionInfo>& list) {
    ReadSessions(tokens);
    ReadStatuses();
    ForgetEnded();
    for (const auto& [run, known] : runs_) list.push_back(known.info);
  }

 private:
  void ReadSessions(const std::map<std::string, RunToken>& tokens) {
    for (;;) {
      const auto samples = sessions_.take();
      if (samples.empty()) return;
      for (const auto& sample : samples) {
        const troupe_wire_Session& session = sample.data();
        if (!sample.info().valid()) continue;
        const auto publication = dds::MatchedPublicationData(sessions_.handle(), sample.info().publication_handle());
        if (!publication) continue;
        const std::string name = publication->partitions.empty() ? "" : publication->partitions.front();
        if (const auto token = tokens.find(name); token != tokens.end()) {
          const dds::RunProof proof(token->second, connection_.participant.guid_prefix());
          if (proof.Check(publication->participant, publication->user_data) != dds::ProofCheck::kAccepted) continue;
        }
        KnownRun& known = runs_[session.run];
        // Another participant cannot take a known run over in this list.
        if (known.session_writer != 0 && known.service != publication->participant) continue;
        if (session.ended) {
          runs_.erase(session.run);
          continue;
        }
        known.service = publication->participant;
        known.session_writer = sample.info().publication_handle();
        SessionInfo& info = known.info;
        info.session = name;
        info.run = session.run;
        info.host = dds::Text(session.host);
        info.pid = session.pid;
        info.world = dds::Text(session.world.name);
        info.robots = session.world.robots._length;
      }
    }
  }

  void ReadStatuses() {
    for (;;) {
      const auto samples = statuses_.take();
      if (samples.empty()) return;
      for (const auto& sample : samples) {
        if (!sample.info().valid()) continue;
        const auto publication = dds::MatchedPublicationData(statuses_.handle(), sample.info().publication_handle());
        const auto known = runs_.find(sample.data().run);
        if (!publication || known == runs_.end() || known->second.service != publication->participant) continue;
        Result<StatusMessage> status = dds::FromWire(sample.data());
        if (status.ok()) known->second.info.status = std::move(status.value());
      }
    }
  }

  void ForgetEnded() {
    // A service that died sends no last session: its writer is no longer matched when its lease has expired.
    sessions_.subscription_matched_status();  // reading it arms the wait set again
    const std::vector<dds_instance_handle_t> matched = dds::MatchedPublications(sessions_.handle());
    std::erase_if(runs_, [&](const auto& known) {
      return !std::binary_search(matched.begin(), matched.end(), known.second.session_writer);
    });
  }

  dds::DdsConnection connection_;
  dds::Topic<troupe_wire_Session> session_topic_;
  dds::Topic<troupe_wire_Status> status_topic_;
  dds::DataReader<troupe_wire_Session> sessions_;
  dds::DataReader<troupe_wire_Status> statuses_;
  dds::ReadCondition session_condition_;
  dds::ReadCondition status_condition_;
  std::map<RunId, KnownRun> runs_;
};

class DdsSessionObserver : public SessionObserver {
 public:
  DdsSessionObserver(const DdsOptions& options, ObserverHandler& handler)
      : transport_(MakeDdsObserverTransport(options)), endpoint_(transport_->MakeObserverEndpoint()) {
    endpoint_->Start(handler);
  }

 private:
  std::unique_ptr<Transport> transport_;
  std::unique_ptr<ObserverEndpoint> endpoint_;
};

}  // namespace

class SessionMonitor::Implementation {
 public:
  explicit Implementation(const NetworkSettings& network) : network_(network) { FindParticipants(); }

  std::vector<SessionInfo> Sessions() {
    FindParticipants();
    std::vector<SessionInfo> list;
    for (auto& [enclave, participant] : participants_) participant->AddSessions(tokens_, list);
    std::sort(list.begin(), list.end(), [](const SessionInfo& a, const SessionInfo& b) {
      return std::tie(a.session, a.run) < std::tie(b.session, b.run);
    });
    return list;
  }

  void WaitForChange(double seconds) { changes_.wait(seconds); }

 private:
  // One for the runs without security, and one for each set of keys.
  void FindParticipants() {
    std::set<std::string> enclaves;
    tokens_.clear();
    if (network_.security == kSecurityAuto || network_.security == kSecurityOn) {
      if (network_.security == kSecurityAuto) enclaves.insert("");
      for (const SessionKeys& published : FindSessionKeys(network_.domain)) {
        // A run that ends now is none of the monitor's.
        const Result<ParticipantKeys> keys = FindKeys(published.keys, network_.domain, {}, Role::Observer());
        if (keys.ok()) enclaves.insert(keys.value().enclave);
        if (keys.ok() && keys.value().token) tokens_.insert_or_assign(published.session, *keys.value().token);
      }
    } else {
      const Result<ParticipantKeys> keys = FindKeys(network_.security, network_.domain, {}, Role::Observer());
      if (!keys.ok()) throw std::runtime_error(keys.error().ToString());
      enclaves.insert(keys.value().enclave);
    }
    for (auto known = participants_.begin(); known != participants_.end();) {
      const bool ended = !enclaves.contains(known->first);
      if (ended) known->second->ForEachCondition([this](const auto& condition) { changes_.detach(condition); });
      known = ended ? participants_.erase(known) : std::next(known);
    }
    for (const std::string& enclave : enclaves) {
      if (!participants_.contains(enclave)) AddParticipant(enclave);
    }
  }

  void AddParticipant(const std::string& enclave) {
    dds::PrintFirstNetworkMessage();
    dds::DomainConfig config = dds::ToolConfig(network_.domain, network_.network_interface, network_.service_address);
    dds::SetKeys(config, enclave);
    auto participant = std::make_unique<MonitoringParticipant>(config);
    participant->ForEachCondition([this](const auto& condition) { changes_.attach(condition, next_token_++); });
    participants_.emplace(enclave, std::move(participant));
  }

  const NetworkSettings network_;
  std::map<std::string, std::unique_ptr<MonitoringParticipant>> participants_;  // by the folders of their keys
  std::map<std::string, RunToken> tokens_;                                      // of the user's own runs, by session
  dds::WaitSet changes_;
  int next_token_ = 0;
};

SessionMonitor::SessionMonitor(const NetworkSettings& network)
    : implementation_(std::make_unique<Implementation>(network)) {}

SessionMonitor::~SessionMonitor() = default;

std::vector<SessionInfo> SessionMonitor::Sessions() {
  return implementation_->Sessions();
}

void SessionMonitor::WaitForChange(double seconds) {
  implementation_->WaitForChange(seconds);
}

std::string SimilarSession(const NetworkSettings& network) {
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::duration<double>(kSimilarSeconds);
  SessionMonitor monitor(network);
  for (;;) {
    std::vector<std::string> names;
    for (const SessionInfo& info : monitor.Sessions()) names.push_back(info.session);
    // The user's own runs on this host are known before they are discovered.
    for (const SessionKeys& known : FindSessionKeys(network.domain)) names.push_back(known.session);
    if (std::find(names.begin(), names.end(), network.session) != names.end()) return "";
    std::string similar = DidYouMean(network.session, names);
    const std::chrono::duration<double> left = deadline - std::chrono::steady_clock::now();
    if (!similar.empty() || left.count() <= 0.0) return similar;
    monitor.WaitForChange(left.count());
  }
}

Result<std::unique_ptr<SessionObserver>> ObserveSession(const NetworkSettings& network, ObserverHandler& handler) {
  Result<ParticipantKeys> keys = FindKeys(network.security, network.domain, network.session, Role::Observer());
  if (!keys.ok()) return keys.error();
  dds::PrintFirstNetworkMessage();
  DdsOptions options;
  static_cast<NetworkSettings&>(options) = network;
  options.keys = std::move(keys).value();
  try {
    return std::unique_ptr<SessionObserver>(std::make_unique<DdsSessionObserver>(options, handler));
  } catch (const std::exception& exception) {
    return FailureOf(exception);
  }
}

}  // namespace troupe
