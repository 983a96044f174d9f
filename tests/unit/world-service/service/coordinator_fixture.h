// A coordinator with an endpoint that only records messages, and a time that only the test advances.
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "tests/support/fake_service_endpoint.h"
#include "world-service/service/tick_coordinator.h"

namespace troupe::test {

// `robots` robots "r0", "r1", ... far apart on an empty plane; ticks of 0.1 s. Their speed is bounded by 10 m/s.
WorldDescription PlaneWorld(std::size_t robots);

class CoordinatorTest : public testing::Test {
 protected:
  static constexpr RunId kRun = 1000;

  // Begins with agents 1, 2, ... for robots r0, r1, ..., none of which has joined.
  void Make(std::size_t robots);
  // Makes the coordinator and joins with all agents.
  void MakeAndStart(std::size_t robots);

  // Agent i + 1 is that of robot i.
  JoinMessage JoinOf(AgentId agent, const std::vector<std::string>& robots) const;
  void Join(AgentId agent, const std::vector<std::string>& robots);
  void Join(AgentId agent) { Join(agent, {"r" + std::to_string(agent - 1)}); }

  ProposalMessage ProposalOf(AgentId agent, double vx, std::optional<Tick> tick = {}) const;
  // Proposes for the open tick.
  void Propose(AgentId agent, double vx = 1.0) { coordinator->OnProposal(ProposalOf(agent, vx), now); }

  // The reply, if it follows at once.
  ControlReply Ask(const control::Request& request);

  void Wait(double seconds);  // polls only at the end

  Tick tick() const { return endpoint.frames.back().state.tick; }
  std::size_t frames() const { return endpoint.frames.size(); }
  // The distance of robot i from its start, m.
  double Travel(std::size_t robot) const;
  // "stall_began r0", "proposal_rejected" ...: the events since the last call.
  std::vector<std::string> Events();

  CoordinatorOptions options;  // change before Make
  double now = 50.0;
  FakeServiceEndpoint endpoint;
  std::shared_ptr<const Scene> scene;
  RunObservers observers;  // change before Make
  std::optional<TickCoordinator> coordinator;
};

}  // namespace troupe::test
