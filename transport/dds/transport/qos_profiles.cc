#include "transport/dds/transport/qos_profiles.h"

namespace troupe::dds::qos_profiles {
namespace {

constexpr char kAgentMark = '/';  // not in the names of sessions

// s; a service discovers the client that it has answered long before.
constexpr double kReplyLifespan = 10.0;

Qos ReliableLatest() {
  return Qos() << Reliability::Reliable(kMaxBlockingTime) << History::KeepLast(1);
}

// Messages with answers to joins that may be in transit at once.
constexpr std::int32_t kAdmissionsKept = 16;

// Answers to different agents that may be in transit at once.
constexpr std::int32_t kPastStatesKept = 4;

// Replies kept for tools that the service has not discovered yet.
constexpr std::int32_t kRepliesKept = 64;

// Messages that may wait in a reader of many writers, and of the service's frames. A reader is drained by the thread
// that receives, so that more than one waits only while the program starts, or when several threads receive.
constexpr std::int32_t kMessagesOfMany = 1024;
constexpr std::int32_t kReceivedFramesKept = 8;

// Frames that may wait in an observer's reader until its thread has read them.
constexpr std::int32_t kObservedFramesKept = 64;

Qos KeptForLatecomers() {
  return ReliableLatest() << Durability::TransientLocal() << DurabilityService{History::KeepLast(1)};
}

}  // namespace

Qos Session(const std::string& session) {
  return Qos() << Partition{session};
}

Qos Agent(const std::string& session, const std::string& name) {
  return Session(session + kAgentMark + name);
}

Qos AllAgents(const std::string& session) {
  return Session(session + kAgentMark + "*");
}

std::string AgentOfPartition(const std::string& partition) {
  const std::size_t mark = partition.find(kAgentMark);
  return mark == std::string::npos ? std::string() : partition.substr(mark + 1);
}

Qos FromMany(Qos profile) {
  return profile << History::KeepLast(kMessagesOfMany);
}

Qos Description(double lease_seconds) {
  return KeptForLatecomers() << Liveliness::Automatic(lease_seconds);
}

Qos Join(double lease_seconds) {
  return KeptForLatecomers() << Liveliness::Automatic(lease_seconds);
}

Qos Admission() {
  return ReliableLatest() << History::KeepLast(kAdmissionsKept);
}

Qos Frame() {
  return ReliableLatest() << Durability::Volatile();
}

Qos ReceivedFrame() {
  return Frame() << History::KeepLast(kReceivedFramesKept);
}

Qos ObservedFrame() {
  return Qos() << Reliability::BestEffort() << History::KeepLast(kObservedFramesKept) << Durability::Volatile();
}

Qos WholeFrame() {
  return ReliableLatest() << Durability::Volatile();
}

Qos FrameRequest() {
  return Qos() << Reliability::BestEffort() << History::KeepLast(1) << Durability::Volatile();
}

Qos PastStates() {
  return ReliableLatest() << Durability::Volatile() << History::KeepLast(kPastStatesKept);
}

Qos Proposal() {
  return ReliableLatest() << Durability::Volatile();
}

Qos Control() {
  return Qos() << Reliability::Reliable(kMaxBlockingTime) << History::KeepLast(kMessagesOfMany);
}

Qos ControlReply() {
  return Qos() << Reliability::Reliable(kMaxBlockingTime) << History::KeepLast(kRepliesKept)
               << Durability::TransientLocal() << DurabilityService{History::KeepLast(kRepliesKept)}
               << Lifespan{kReplyLifespan};
}

Qos Status() {
  return KeptForLatecomers();
}

}  // namespace troupe::dds::qos_profiles
