#include "common/ros_dds/ros_qos.h"

namespace troupe::ros {
namespace {

using dds::Durability;
using dds::DurabilityService;
using dds::History;
using dds::Lifespan;
using dds::Qos;
using dds::Reliability;
using dds::WriterDataLifecycle;

// s. A write must not delay a tick. Nor may it be the default of 100 ms: Cyclone omits a default from its
// announcements, and some other implementations then do not match.
constexpr double kMaxBlockingTime = 0.001;

}  // namespace

Qos Stream(std::int32_t depth) {
  return Qos() << Reliability::Reliable(kMaxBlockingTime) << Durability::Volatile() << History::KeepLast(depth)
               << WriterDataLifecycle{false};
}

Qos Latched(std::int32_t depth) {
  return Qos() << Reliability::Reliable(kMaxBlockingTime) << Durability::TransientLocal() << History::KeepLast(depth)
               << DurabilityService{History::KeepLast(depth)} << WriterDataLifecycle{false};
}

Qos Commands(bool reliable) {
  return Qos() << (reliable ? Reliability::Reliable(kMaxBlockingTime) : Reliability::BestEffort())
               << Durability::Volatile() << History::KeepLast(1);
}

Qos Service(std::int32_t depth) {
  return Stream(depth);
}

Qos LogLines() {
  constexpr std::int32_t kLines = 1000;
  constexpr double kSeconds = 10.0;
  return Latched(kLines) << Lifespan{kSeconds};
}

Qos Discovery() {
  return Latched(1);
}

}  // namespace troupe::ros
