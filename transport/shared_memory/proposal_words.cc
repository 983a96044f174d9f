#include "transport/shared_memory/proposal_words.h"

namespace troupe {
namespace {

constexpr std::size_t kMessageWords = 3;  // of radio, and its bytes
constexpr std::size_t kSwitchWords = 2;
constexpr std::size_t kDirectionWords = 3;
constexpr std::size_t kProposalWords = 9;          // at least
constexpr std::size_t kLongestReport = 1'000'000;  // bytes
constexpr std::uint64_t kMostRobots = std::uint64_t{1} << 32;

bool Read(WordReader& words, RadioMessage& message) {
  std::uint64_t radio = 0;
  if (!words.Read(radio) || radio >= kMostRobots || !words.Read(message.to, kMostRobots)) return false;
  message.radio = static_cast<std::size_t>(radio);
  return words.Read(message.bytes, kMostRadioBytes);
}

bool ReadAll(WordReader& words, ProposalMessage& message) {
  std::uint64_t edition = 0;
  std::uint64_t incarnation = 0;
  std::size_t count = 0;
  if (!words.Read(message.run) || !words.Read(message.agent) || !words.Read(message.tick) ||
      !words.Read(message.paused) || !words.Read(edition) || !words.Read(incarnation) ||
      !words.ReadCount(count, kProposalWords)) {
    return false;
  }
  message.edition = static_cast<Edition>(edition);
  message.incarnation = static_cast<Incarnation>(incarnation);
  message.proposals.resize(count);
  std::uint64_t next = 0;  // the least id that may follow
  for (Proposal& proposal : message.proposals) {
    std::uint64_t robot = 0;
    std::size_t joints = 0;
    if (!words.Read(robot) || robot < next || robot >= kMostRobots || !words.Read(proposal.twist.vx) ||
        !words.Read(proposal.twist.vy) || !words.Read(proposal.twist.wz) || !words.ReadCount(joints, 1)) {
      return false;
    }
    next = robot + 1;
    proposal.robot = RobotId(static_cast<std::size_t>(robot));
    proposal.joint_velocities.resize(joints);
    for (double& velocity : proposal.joint_velocities) {
      if (!words.Read(velocity)) return false;
    }
    std::size_t messages = 0;
    if (!words.ReadCount(messages, kMessageWords)) return false;
    proposal.messages.resize(messages);
    for (RadioMessage& radio_message : proposal.messages) {
      if (!Read(words, radio_message)) return false;
    }
    std::size_t lights = 0;
    if (!words.ReadCount(lights, kSwitchWords)) return false;
    proposal.lights.resize(lights);
    for (LightOrder& order : proposal.lights) {
      std::uint64_t light = 0;
      if (!words.Read(light) || light >= kMostRobots || !words.Read(order.on)) return false;
      order.light = static_cast<std::size_t>(light);
    }
    std::size_t cameras = 0;
    if (!words.ReadCount(cameras, kDirectionWords)) return false;
    proposal.cameras.resize(cameras);
    for (CameraOrder& order : proposal.cameras) {
      std::uint64_t sensor = 0;
      if (!words.Read(sensor) || sensor >= kMostRobots || !words.Read(order.pan) || !words.Read(order.tilt))
        return false;
      order.sensor = static_cast<std::size_t>(sensor);
    }
    if (!words.Read(proposal.say, kLongestReport)) return false;
  }
  if (!words.ReadCount(count, 1)) return false;
  message.reports.resize(count);
  for (std::string& report : message.reports) {
    if (!words.Read(report, kLongestReport)) return false;
  }
  return words.remaining() == 0;
}

}  // namespace

void AddProposal(const ProposalMessage& message, WordWriter& words) {
  words.Add(message.run);
  words.Add(message.agent);
  words.Add(message.tick);
  words.Add(std::uint64_t{message.paused});
  words.Add(std::uint64_t{message.edition});
  words.Add(std::uint64_t{message.incarnation});
  words.Add(message.proposals.size());
  for (const Proposal& proposal : message.proposals) {
    words.Add(static_cast<std::uint64_t>(proposal.robot.index()));
    words.Add(proposal.twist.vx);
    words.Add(proposal.twist.vy);
    words.Add(proposal.twist.wz);
    words.Add(proposal.joint_velocities.size());
    for (const double velocity : proposal.joint_velocities) words.Add(velocity);
    words.Add(proposal.messages.size());
    for (const RadioMessage& radio_message : proposal.messages) {
      words.Add(std::uint64_t{radio_message.radio});
      words.Add(radio_message.to);
      words.Add(radio_message.bytes);
    }
    words.Add(proposal.lights.size());
    for (const LightOrder& order : proposal.lights) {
      words.Add(std::uint64_t{order.light});
      words.Add(std::uint64_t{order.on});
    }
    words.Add(proposal.cameras.size());
    for (const CameraOrder& order : proposal.cameras) {
      words.Add(std::uint64_t{order.sensor});
      words.Add(order.pan);
      words.Add(order.tilt);
    }
    words.Add(proposal.say);
  }
  words.Add(message.reports.size());
  for (const std::string& report : message.reports) words.Add(report);
}

Status ReadProposal(WordReader words, ProposalMessage& message) {
  if (ReadAll(words, message)) return {};
  return Error{{}, "a proposal in shared memory that is incomplete, or has robots out of order"};
}

}  // namespace troupe
