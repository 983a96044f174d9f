#include "ros/connection/ros_qos.h"

#include "troupe/check.h"

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
constexpr double kLineSeconds = 10.0;

Qos KeptForLateReaders(std::int32_t depth) {
  return Qos() << Reliability::Reliable(kMaxBlockingTime) << Durability::TransientLocal() << History::KeepLast(depth)
               << DurabilityService{History::KeepLast(depth)} << WriterDataLifecycle{false};
}

}  // namespace

Qos ToDds(const TopicQos& qos) {
  switch (qos.kind) {
    case TopicQos::Kind::kStream:
      return Qos() << Reliability::Reliable(kMaxBlockingTime) << Durability::Volatile() << History::KeepLast(qos.depth)
                   << WriterDataLifecycle{false};
    case TopicQos::Kind::kLatched:
      return KeptForLateReaders(qos.depth);
    case TopicQos::Kind::kReliableCommands:
      return Qos() << Reliability::Reliable(kMaxBlockingTime) << Durability::Volatile() << History::KeepLast(qos.depth);
    case TopicQos::Kind::kBestEffortCommands:
      return Qos() << Reliability::BestEffort() << Durability::Volatile() << History::KeepLast(qos.depth);
    case TopicQos::Kind::kLogLines:
      return KeptForLateReaders(qos.depth) << Lifespan{kLineSeconds};
  }
  TROUPE_CHECK(false);
}

TopicQos Stream(std::int32_t depth) {
  return {TopicQos::Kind::kStream, depth};
}

TopicQos Latched(std::int32_t depth) {
  return {TopicQos::Kind::kLatched, depth};
}

TopicQos Commands(bool reliable, std::int32_t depth) {
  return {reliable ? TopicQos::Kind::kReliableCommands : TopicQos::Kind::kBestEffortCommands, depth};
}

TopicQos Service(std::int32_t depth) {
  return Stream(depth);
}

TopicQos LogLines() {
  constexpr std::int32_t kLines = 1000;
  return {TopicQos::Kind::kLogLines, kLines};
}

}  // namespace troupe::ros
