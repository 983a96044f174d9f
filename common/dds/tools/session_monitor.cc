#include "common/dds/tools/session_monitor.h"

#include <algorithm>
#include <map>
#include <tuple>

#include "common/dds/binding/builtin_topic.h"
#include "common/dds/binding/condition.h"
#include "common/dds/binding/wait_set.h"
#include "common/dds/convert/convert_status.h"
#include "common/dds/convert/topic_types.h"
#include "common/dds/transport/dds_connection.h"
#include "common/dds/transport/qos_profiles.h"
#include "common/dds/transport/topics.h"

namespace troupe {
namespace {

constexpr const char* kAllSessions = "*";  // as a partition

}  // namespace

class SessionMonitor::Implementation {
 public:
  explicit Implementation(const dds::DomainConfig& config)
      : connection_(config, kAllSessions, {}),
        session_topic_(connection_.participant, dds::topics::kSession),
        status_topic_(connection_.participant, dds::topics::kStatus),
        sessions_(connection_.subscriber, session_topic_, dds::qos_profiles::Description()),
        statuses_(connection_.subscriber, status_topic_, dds::qos_profiles::Status()),
        session_condition_(sessions_),
        status_condition_(statuses_),
        wait_set_(connection_.participant) {
    wait_set_.attach(session_condition_, 0);
    wait_set_.attach(status_condition_, 1);
  }

  std::vector<SessionInfo> Sessions() {
    ReadSessions();
    ReadStatuses();
    std::vector<SessionInfo> list;
    for (const auto& [run, info] : runs_) {
      if (info.pid != 0) list.push_back(info);
    }
    std::sort(list.begin(), list.end(), [](const SessionInfo& a, const SessionInfo& b) {
      return std::tie(a.session, a.run) < std::tie(b.session, b.run);
    });
    return list;
  }

  void WaitForChange(double seconds) { wait_set_.wait(seconds); }

 private:
  void ReadSessions() {
    for (;;) {
      const auto samples = sessions_.take();
      if (samples.empty()) return;
      for (const auto& sample : samples) {
        const troupe_wire_Session& session = sample.data();
        if (!sample.info().instance_alive()) {
          runs_.erase(session.run);
          continue;
        }
        if (!sample.info().valid()) continue;
        const auto publication = dds::MatchedPublicationData(sessions_.handle(), sample.info().publication_handle());
        if (!publication) continue;
        SessionInfo& info = runs_[session.run];
        info.session = publication->partitions.empty() ? "" : publication->partitions.front();
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
        if (!sample.info().instance_alive() || !sample.info().valid()) continue;
        Result<StatusMessage> status = dds::FromWire(sample.data());
        if (status.ok()) runs_[status.value().run].status = std::move(status.value());
      }
    }
  }

  dds::DdsConnection connection_;
  dds::Topic<troupe_wire_Session> session_topic_;
  dds::Topic<troupe_wire_Status> status_topic_;
  dds::DataReader<troupe_wire_Session> sessions_;
  dds::DataReader<troupe_wire_Status> statuses_;
  dds::ReadCondition session_condition_;
  dds::ReadCondition status_condition_;
  dds::WaitSet wait_set_;
  std::map<RunId, SessionInfo> runs_;  // a run without a pid has published its status only, so far
};

SessionMonitor::SessionMonitor(std::uint32_t domain, const std::string& network_interface,
                               const std::string& service_address)
    : implementation_(std::make_unique<Implementation>(dds::ToolConfig(domain, network_interface, service_address))) {}

SessionMonitor::~SessionMonitor() = default;

std::vector<SessionInfo> SessionMonitor::Sessions() {
  return implementation_->Sessions();
}

void SessionMonitor::WaitForChange(double seconds) {
  implementation_->WaitForChange(seconds);
}

}  // namespace troupe
