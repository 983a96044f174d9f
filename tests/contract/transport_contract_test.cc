#include "tests/contract/transport_contract.h"

#include "tests/contract/observer_contract.h"
#include "transport/protocol/faulty_transport.h"

namespace troupe::test {
namespace {

class OneTransportRig final : public TransportRig {
 public:
  explicit OneTransportRig(std::unique_ptr<Transport> transport) : transport_(std::move(transport)) {}
  Transport& ForService() override { return *transport_; }
  Transport& ForAgent() override { return *transport_; }
  Transport& ForObserver() override { return *transport_; }

 private:
  std::unique_ptr<Transport> transport_;
};

TransportCase Faulty(const std::string& name, const std::string& faults) {
  return {name,
          [faults] {
            return std::make_unique<OneTransportRig>(
                MakeFaultyTransport(MakeMemoryTransport(), ParseFaults(faults).value()));
          },
          true, 20};
}

std::vector<TransportCase> Cases() {
  return {
      {"Memory", [] { return std::make_unique<OneTransportRig>(MakeMemoryTransport()); }, false, 200},
      Faulty("Loss", "loss=0.15,seed=1"),
      Faulty("Duplicates", "duplicate=0.5,seed=2"),
      Faulty("Order", "reorder=0.2,seed=3"),
      Faulty("Delay", "delay=0.5:0.01,seed=4"),
      Faulty("Everything", "loss=0.1,duplicate=0.1,reorder=0.1,delay=0.3:0.01,seed=5"),
  };
}

}  // namespace

INSTANTIATE_TEST_SUITE_P(InMemory, TransportContract, testing::ValuesIn(Cases()), NameOfCase);
INSTANTIATE_TEST_SUITE_P(InMemory, ObserverContract, testing::ValuesIn(Cases()), NameOfCase);

}  // namespace troupe::test
