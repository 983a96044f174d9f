// The contract of transports over real DDS: a participant for each service and each agent, on the loopback interface.
#include <atomic>
#include <mutex>
#include <random>

#include "tests/contract/observer_contract.h"
#include "tests/contract/transport_contract.h"
#include "tests/support/dds_domain.h"
#include "transport/dds/transport/dds_transport.h"
#include "transport/protocol/faulty_transport.h"

namespace troupe::test {
namespace {

// Which agents share memory with the service.
enum class Sharing : std::uint8_t { kAll, kNone, kEverySecond };

class DdsRig final : public TransportRig {
 public:
  DdsRig(const std::string& session, const std::string& faults, Sharing sharing) : faults_(faults), sharing_(sharing) {
    options_.data_sharing = sharing != Sharing::kNone;
    options_.domain = TestDomain();
    options_.session = TestSession(session);
  }
  Transport& ForService() override { return Keep(MakeDdsServiceTransport(options_).transport); }
  Transport& ForAgent() override {
    DdsOptions agent = options_;
    if (sharing_ == Sharing::kEverySecond) agent.data_sharing = agents_++ % 2 == 0;
    return Keep(MakeDdsAgentTransport(agent));
  }
  Transport& ForObserver() override {
    if (observers_.size() < kMaxObserverParticipants) {
      observers_.push_back(&Keep(MakeDdsObserverTransport(options_)));
      return *observers_.back();
    }
    return *observers_[next_observer_++ % observers_.size()];
  }

 private:
  // The participants of one test process; further observers share them.
  static constexpr std::size_t kMaxObserverParticipants = 10;

  Transport& Keep(std::unique_ptr<Transport> transport) {
    if (!faults_.empty()) transport = MakeFaultyTransport(std::move(transport), ParseFaults(faults_).value());
    const std::lock_guard lock(mutex_);
    return *transports_.emplace_back(std::move(transport));
  }

  DdsOptions options_;
  std::string faults_;
  Sharing sharing_;
  std::atomic<int> agents_ = 0;
  std::mutex mutex_;  // a run has its service on a thread of its own
  std::vector<std::unique_ptr<Transport>> transports_;
  std::vector<Transport*> observers_;
  std::size_t next_observer_ = 0;
};

TransportCase Dds(const std::string& name, const std::string& faults, std::uint64_t ticks, Sharing sharing) {
  const auto make = [=] {
    return std::make_unique<DdsRig>(name + std::to_string(std::random_device()()), faults, sharing);
  };
  return {name, make, !faults.empty(), ticks};
}

std::vector<TransportCase> Cases() {
  const std::string faults = "loss=0.1,duplicate=0.1,reorder=0.1,delay=0.3:0.01,seed=6";
  return {
      Dds("Dds", "", 200, Sharing::kNone),
      Dds("DdsWithFaults", faults, 20, Sharing::kNone),
      Dds("DataSharing", "", 200, Sharing::kAll),
      Dds("DataSharingWithFaults", faults, 20, Sharing::kAll),
      Dds("DataSharingOfEverySecondAgent", "", 200, Sharing::kEverySecond),
  };
}

}  // namespace

INSTANTIATE_TEST_SUITE_P(OverDds, TransportContract, testing::ValuesIn(Cases()), NameOfCase);
INSTANTIATE_TEST_SUITE_P(OverDds, ObserverContract, testing::ValuesIn(Cases()), NameOfCase);

}  // namespace troupe::test
