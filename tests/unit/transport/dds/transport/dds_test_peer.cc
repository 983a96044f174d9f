// A peer process, for tests that kill one: "agent" joins the session that it finds, "observer" follows it,
// "service" offers one. Each stays until SIGTERM.
//   dds_test_peer agent|observer|service DOMAIN SESSION ID LEASE
#include <sys/prctl.h>

#include <csignal>
#include <cstdlib>
#include <string>

#include "transport/dds/transport/dds_transport.h"

namespace troupe {
namespace {

class JoiningAgent : public AgentHandler {
 public:
  JoiningAgent(AgentEndpoint& endpoint, AgentId id) : endpoint_(endpoint), id_(id) {}
  void OnSession(const SessionMessage& session) override {
    endpoint_.SendJoin(JoinMessage{.run = session.run, .agent = id_, .robots = {"robot"}});
  }
  void OnAdmission(const AdmissionMessage&) override {}
  void OnFrame(const FrameMessage&) override {}
  void OnServiceGone() override {}

 private:
  AgentEndpoint& endpoint_;
  AgentId id_;
};

class SilentObserver : public ObserverHandler {
 public:
  void OnSession(const SessionMessage&) override {}
  void OnFrame(const SharedFrame&) override {}
  void OnStatus(const StatusMessage&) override {}
  void OnServiceGone() override {}
};

class SilentService : public ServiceHandler {
 public:
  void OnJoin(const JoinMessage&) override {}
  void OnProposal(const ProposalMessage&) override {}
  void OnAgentGone(AgentId) override {}
  void OnRivalService(const SessionMessage&) override {}
};

void WaitForTermination(const sigset_t& signals) {
  int signal = 0;
  sigwait(&signals, &signal);
}

}  // namespace
}  // namespace troupe

int main(int argc, char** argv) {
  if (argc != 6) return 2;
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGTERM);
  sigprocmask(SIG_BLOCK, &signals, nullptr);

  troupe::DdsOptions options;
  options.domain = static_cast<std::uint32_t>(std::atoi(argv[2]));
  options.session = argv[3];
  const auto id = static_cast<std::uint64_t>(std::atoll(argv[4]));
  options.lease_seconds = std::atof(argv[5]);
  if (std::string(argv[1]) == "agent") {
    const auto transport = troupe::MakeDdsAgentTransport(options);
    const auto endpoint = transport->MakeAgentEndpoint(id);
    troupe::JoiningAgent agent(*endpoint, id);
    endpoint->Start(agent);
    troupe::WaitForTermination(signals);
  } else if (std::string(argv[1]) == "observer") {
    const auto transport = troupe::MakeDdsObserverTransport(options);
    const auto endpoint = transport->MakeObserverEndpoint();
    troupe::SilentObserver observer;
    endpoint->Start(observer);
    troupe::WaitForTermination(signals);
  } else {
    const auto transport = troupe::MakeDdsServiceTransport(options).transport;
    troupe::SilentService service;
    const auto endpoint = transport->MakeServiceEndpoint();
    endpoint->SendSession(troupe::SessionMessage{.run = id, .lease_seconds = options.lease()});
    endpoint->Start(service);
    troupe::WaitForTermination(signals);
  }
}
