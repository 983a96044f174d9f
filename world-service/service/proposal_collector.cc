#include "world-service/service/proposal_collector.h"

#include "world-service/core/validate_proposal.h"

namespace troupe {

ProposalCollector::ProposalCollector(const WorldDescription& world, Mode mode)
    : world_(&world), mode_(mode), newest_(world.robots.size()) {}

void ProposalCollector::ChangeWorld(const WorldDescription& world) {
  world_ = &world;
  newest_.assign(world.robots.size(), {});
}

std::span<const Rejection> ProposalCollector::Collect(const Member& member, const ProposalMessage& message,
                                                      const WorldState& state) {
  rejections_.clear();
  // Both are in robot-id order, so that one pass finds missing and surplus proposals.
  auto proposal = message.proposals.begin();
  const auto end = message.proposals.end();
  const auto reject_surplus = [&] {
    const bool known = proposal->robot.index() < newest_.size();
    rejections_.push_back({known ? std::optional(proposal->robot) : std::nullopt,
                           "robot " + std::to_string(proposal->robot.index()) + " in a message of " + Describe(member) +
                               " is not one of its robots, or is repeated or out of order"});
    ++proposal;
  };
  for (RobotId robot : member.robots) {
    while (proposal != end && proposal->robot < robot) reject_surplus();
    if (proposal == end || proposal->robot != robot) {
      rejections_.push_back({robot, "the message of " + Describe(member) + " has no proposal for it"});
      continue;
    }
    if (const Status valid = ValidateProposal(*world_, state, *proposal); valid.ok()) {
      newest_[robot.index()] = {*proposal, message.tick};
    } else {
      rejections_.push_back({robot, valid.error().message});
    }
    ++proposal;
  }
  while (proposal != end) reject_surplus();
  return rejections_;
}

std::span<const Proposal> ProposalCollector::ForStep(const WorldState& state) {
  const Tick next = state.tick + 1;
  for_step_.clear();
  for (const Newest& newest : newest_) {
    const bool in_time = newest.tick == next;
    // A proposal within the limits of a tick ago need not be now: the robot may have stalled.
    const bool kept = mode_ == Mode::kRealtime && newest.tick != 0 && newest.tick + 1 == next;
    if (in_time || (kept && ValidateProposal(*world_, state, newest.proposal).ok())) {
      for_step_.push_back(newest.proposal);
      if (!in_time) for_step_.back().messages.clear();  // they were sent in the tick before
    }
  }
  return for_step_;
}

}  // namespace troupe
