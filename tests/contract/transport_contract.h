// The contract of all transports. Include it in a test program, and there
//   INSTANTIATE_TEST_SUITE_P(Name, TransportContract, ::testing::ValuesIn(Cases()), NameOfCase);
// Any transport may lose, duplicate and reorder messages, so the tests resend until a message arrives, and never
// expect that one arrives once.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <limits>
#include <string>
#include <thread>
#include <vector>

#include "tests/contract/transport_case.h"
#include "tests/support/test_world.h"
#include "transport/protocol/transport.h"

namespace troupe::test {

inline std::string NameOfCase(const testing::TestParamInfo<TransportCase>& info) {
  return info.param.name;
}

class TransportContract : public testing::TestWithParam<TransportCase> {
 protected:
  static constexpr double kPatience = 30.0;  // s, before a test fails
  static constexpr double kRepeat = 0.02;    // s, between two tries

  // Calls `send` again and again until `inbox` has an item that `is_wanted`.
  template <typename T, typename Send, typename Predicate>
  static bool SendUntil(const Inbox<T>& inbox, const Send& send, const Predicate& is_wanted) {
    for (double waited = 0.0; waited < kPatience; waited += kRepeat) {
      send();
      if (inbox.WaitFor(kRepeat, is_wanted)) return true;
    }
    return false;
  }

  // A proposal may be dropped unless its agent has joined.
  static void SendAsMember(AgentEndpoint& endpoint, const ProposalMessage& proposal) {
    endpoint.SendJoin(JoinMessage{.run = proposal.run, .agent = proposal.agent, .robots = {"r0"}});
    endpoint.SendProposal(proposal);
  }

  static SessionMessage SomeSession(RunId run) {
    SessionMessage session{
        .run = run, .protocol_version = 3, .host = "a host", .pid = 4711, .lease_seconds = 2.5, .world = BusyWorld()};
    return session;
  }

  static FrameMessage SomeFrame(Tick tick, std::size_t robots) {
    FrameMessage frame;
    frame.run = 77;
    frame.state.tick = tick;
    for (std::size_t i = 0; i < robots; ++i) {
      const double number = static_cast<double>(i) / 3.0;
      frame.state.robots.push_back({{number, -number, 0.1, 1e-300 * number}, {number, -0.0, 1.0 / 7.0}, i % 3 == 0});
    }
    frame.state_hash = std::numeric_limits<std::uint64_t>::max() - tick;
    frame.events.push_back({tick, EventType::kStallBegan, RobotId(0), ModelId(5), ""});
    frame.events.push_back({tick, EventType::kProposalRejected, std::nullopt, std::nullopt, "because \"of\" \xc3\xa4"});
    frame.events.push_back({tick, EventType::kLeft, RobotId(1), std::nullopt, "gone"});
    return frame;
  }

  std::unique_ptr<TransportRig> rig_ = GetParam().make();
};

TEST_P(TransportContract, SessionReachesEarlyAndLateAgents) {
  StartedAgent early(rig_->ForAgent(), 1);
  StartedService service(rig_->ForService());
  const SessionMessage sent = SomeSession(77);
  service.endpoint->SendSession(sent);
  const auto is_sent = [&](const SessionMessage& session) {
    return session.run == sent.run && session.protocol_version == sent.protocol_version && session.host == sent.host &&
           session.pid == sent.pid && session.lease_seconds == sent.lease_seconds &&
           session.world->name == sent.world->name && Hash(session.world) == Hash(sent.world);
  };
  EXPECT_TRUE(early.sessions.WaitFor(kPatience, is_sent));
  StartedAgent late(rig_->ForAgent(), 2);
  EXPECT_TRUE(late.sessions.WaitFor(kPatience, is_sent));
}

TEST_P(TransportContract, JoinArrivesIntact) {
  StartedService service(rig_->ForService());
  service.endpoint->SendSession(SomeSession(77));
  StartedAgent agent(rig_->ForAgent(), 0xfedcba9876543210);
  JoinMessage join{.run = 77,
                   .agent = 0xfedcba9876543210,
                   .protocol_version = 9,
                   .world_hash = 0x8000000000000001,
                   .host = "some.host",
                   .pid = 0xffffffff,
                   .robots = {"r0", "a robot, \"named\"", "r2"}};
  EXPECT_TRUE(SendUntil(
      service.joins, [&] { agent.endpoint->SendJoin(join); },
      [&](const JoinMessage& came) {
        return came.run == join.run && came.agent == join.agent && came.protocol_version == join.protocol_version &&
               came.world_hash == join.world_hash && came.host == join.host && came.pid == join.pid &&
               came.robots == join.robots;
      }));
}

TEST_P(TransportContract, HistoryArrivesIntact) {
  StartedService service(rig_->ForService());
  service.endpoint->SendSession(SomeSession(77));
  StartedAgent agent(rig_->ForAgent(), 5);
  ASSERT_TRUE(agent.sessions.WaitFor(kPatience, [](const SessionMessage&) { return true; }));
  HistoryMessage sent{77, {5, 6}, ControllerCheckpoint{2, 8, true}, {}};
  for (Tick tick = 9; tick < 60; ++tick) {
    sent.entries.push_back({SomeFrame(tick, 200), tick % 7 != 0, {}});
    sent.entries.back().frame.events.clear();
  }
  sent.entries[3].world = BusyWorld();
  EXPECT_TRUE(SendUntil(
      agent.histories, [&] { service.endpoint->SendHistory(sent); },
      [&](const HistoryMessage& came) { return came == sent; }));
}

TEST_P(TransportContract, AdmissionArrivesIntact) {
  StartedService service(rig_->ForService());
  StartedAgent agent(rig_->ForAgent(), 5);
  for (const AdmissionMessage& sent : {AdmissionMessage{77, 5, true, ""}, AdmissionMessage{77, 5, false, "a reason"}}) {
    EXPECT_TRUE(SendUntil(
        agent.admissions, [&] { service.endpoint->SendAdmissions({sent}); },
        [&](const AdmissionMessage& came) {
          return came.run == sent.run && came.agent == sent.agent && came.admitted == sent.admitted &&
                 came.reason == sent.reason;
        }));
  }
}

TEST_P(TransportContract, FrameOfAnySizeArrivesIntact) {
  StartedService service(rig_->ForService());
  StartedAgent agent(rig_->ForAgent(), 5);
  Tick tick = 1;
  for (std::size_t robots : {2u, 100u, 5000u}) {
    FrameMessage sent = SomeFrame(tick++, robots);
    sent.last = robots == 5000;
    EXPECT_TRUE(SendUntil(
        agent.frames, [&] { service.endpoint->SendFrame(sent); },
        [&](const FrameMessage& came) {
          return came.run == sent.run && came.state == sent.state && came.state_hash == sent.state_hash &&
                 came.last == sent.last && came.events == sent.events;
        }))
        << robots << " robots";
  }
}

TEST_P(TransportContract, ProposalArrivesIntact) {
  StartedService service(rig_->ForService());
  StartedAgent agent(rig_->ForAgent(), 5);
  ProposalMessage sent{77, 5, 123456789012345, {{RobotId(2), {0.1, -0.2, 1.0 / 3.0}}, {RobotId(3), {}}}, {"a report"}};
  EXPECT_TRUE(SendUntil(
      service.proposals, [&] { SendAsMember(*agent.endpoint, sent); },
      [&](const ProposalMessage& came) {
        return came.run == sent.run && came.agent == sent.agent && came.tick == sent.tick &&
               came.proposals == sent.proposals && came.reports == sent.reports;
      }));
}

TEST_P(TransportContract, BadNumbersArriveAsTheyAre) {
  StartedService service(rig_->ForService());
  StartedAgent agent(rig_->ForAgent(), 5);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  const ProposalMessage sent{77, 5, 1, {{RobotId(4000000000), {nan, infinity, -infinity}}}, {}};
  EXPECT_TRUE(SendUntil(
      service.proposals, [&] { SendAsMember(*agent.endpoint, sent); },
      [&](const ProposalMessage& came) {
        return came.proposals.size() == 1 && came.proposals[0].robot == RobotId(4000000000) &&
               came.proposals[0].twist.vx != came.proposals[0].twist.vx && came.proposals[0].twist.vy == infinity &&
               came.proposals[0].twist.wz == -infinity;
      }));
}

TEST_P(TransportContract, TwoAgentsSendAndReceiveAtOnce) {
  CollectingAgent agents[2];
  StartedService service(rig_->ForService());
  std::unique_ptr<AgentEndpoint> endpoints[2];
  for (std::size_t i = 0; i < 2; ++i) {
    endpoints[i] = rig_->ForAgent().MakeAgentEndpoint(i + 1);
    endpoints[i]->Start(agents[i]);
  }
  for (Tick tick = 1; tick <= 3; ++tick) {
    for (std::size_t i = 0; i < 2; ++i) {
      const ProposalMessage sent{77, i + 1, tick, {{RobotId(i), {1.0 * static_cast<double>(i), 0.0, 0.0}}}, {}};
      EXPECT_TRUE(SendUntil(
          service.proposals, [&] { SendAsMember(*endpoints[i], sent); },
          [&](const ProposalMessage& came) {
            return came.agent == sent.agent && came.tick == tick && came.proposals == sent.proposals;
          }));
    }
    for (CollectingAgent& agent : agents) {
      EXPECT_TRUE(SendUntil(
          agent.frames, [&] { service.endpoint->SendFrame(SomeFrame(tick, 2)); },
          [&](const FrameMessage& came) { return came.state.tick == tick; }));
    }
  }
}

TEST_P(TransportContract, ServiceLearnsThatAnAgentHasEnded) {
  CollectingAgent agent;
  StartedService service(rig_->ForService());
  CollectingAgent other;
  auto staying = rig_->ForAgent().MakeAgentEndpoint(1);
  auto leaving = rig_->ForAgent().MakeAgentEndpoint(2);
  staying->Start(other);
  leaving->Start(agent);
  for (AgentEndpoint* endpoint : {staying.get(), leaving.get()}) {
    JoinMessage join;
    join.agent = endpoint == staying.get() ? 1 : 2;
    ASSERT_TRUE(SendUntil(
        service.joins, [&] { endpoint->SendJoin(join); },
        [&](const JoinMessage& came) { return came.agent == join.agent; }));
  }
  leaving.reset();
  EXPECT_TRUE(service.gone.WaitFor(kPatience, [](AgentId gone) { return gone == 2; }));
  for (AgentId gone : service.gone.items()) EXPECT_NE(gone, 1u);
}

TEST_P(TransportContract, AgentLearnsThatTheServiceHasEnded) {
  StartedService service(rig_->ForService());
  service.endpoint->SendSession(SomeSession(77));
  StartedAgent agent(rig_->ForAgent(), 1);
  ASSERT_TRUE(agent.sessions.WaitFor(kPatience, [](const SessionMessage&) { return true; }));
  service.endpoint.reset();
  EXPECT_TRUE(agent.service_gone.WaitFor(kPatience, [](bool) { return true; }));
}

// A service may be continued before its end is known, by its lease, to all.
TEST_P(TransportContract, SessionOfASuccessorArrivesThoughItsPredecessorEndsLater) {
  StartedService first(rig_->ForService());
  first.endpoint->SendSession(SomeSession(77));
  StartedAgent agent(rig_->ForAgent(), 1);
  ASSERT_TRUE(agent.sessions.WaitFor(kPatience, [](const SessionMessage&) { return true; }));
  SessionMessage continued = SomeSession(77);
  continued.incarnation = 1;
  StartedService second(rig_->ForService());
  second.endpoint->SendSession(continued);
  // The agent has discovered the second one, and in most runs has its session by now.
  ASSERT_TRUE(SendUntil(
      agent.admissions,
      [&] {
        second.endpoint->SendAdmissions({AdmissionMessage{99, 1, true, ""}});
      },
      [](const AdmissionMessage& came) { return came.run == 99; }));
  first.endpoint.reset();
  EXPECT_TRUE(agent.sessions.WaitFor(kPatience, [](const SessionMessage& next) { return next.incarnation == 1; }));
}

TEST_P(TransportContract, ServicesOfOneSessionDetectEachOther) {
  StartedService first(rig_->ForService());
  first.endpoint->SendSession(SomeSession(77));
  StartedService second(rig_->ForService());
  second.endpoint->SendSession(SomeSession(78));
  EXPECT_TRUE(second.rivals.WaitFor(kPatience, [](const SessionMessage& rival) { return rival.run == 77; }));
  EXPECT_TRUE(first.rivals.WaitFor(kPatience, [](const SessionMessage& rival) { return rival.run == 78; }));
}

TEST_P(TransportContract, NoMessageIsDeliveredToADestroyedEndpoint) {
  StartedService service(rig_->ForService());
  std::atomic<bool> enough = false;
  std::thread sender([&] {
    for (Tick tick = 1; !enough; ++tick) {
      service.endpoint->SendFrame(SomeFrame(tick, 2));
      std::this_thread::yield();
    }
  });
  for (AgentId id = 1; id <= 3; ++id) {
    // A delivery after the end of the endpoint would write to freed memory, which sanitizers report.
    auto agent = std::make_unique<CollectingAgent>();
    auto endpoint = rig_->ForAgent().MakeAgentEndpoint(id);
    endpoint->Start(*agent);
    EXPECT_TRUE(agent->frames.WaitFor(kPatience, [](const FrameMessage&) { return true; }));
    endpoint.reset();
    const std::size_t count = agent->frames.items().size();
    EXPECT_FALSE(agent->frames.WaitFor(0.02, [&](const FrameMessage&) { return false; }));
    EXPECT_EQ(agent->frames.items().size(), count);
  }
  enough = true;
  sender.join();
}

TEST_P(TransportContract, HandlersMaySendAndAreCalledOneAtATime) {
  // The agent answers each frame from inside its handler, the service each answer with the next frame.
  class PingPong final : public ServiceHandler {
   public:
    void OnJoin(const JoinMessage&) override {}
    void OnProposal(const ProposalMessage& proposal) override {
      EXPECT_FALSE(inside_.exchange(true));
      if (proposal.tick == next_) {
        ++next_;
        Send();
      }
      inside_ = false;
      answers.Put(proposal.tick);
    }
    void OnAgentGone(AgentId) override {}
    void OnRivalService(const SessionMessage&) override {}
    void Send() { endpoint->SendFrame(SomeFrame(next_, 2)); }

    ServiceEndpoint* endpoint = nullptr;
    Inbox<Tick> answers;

   private:
    std::atomic<Tick> next_ = 1;
    std::atomic<bool> inside_ = false;
  };

  PingPong service;
  CollectingAgent agent;
  std::atomic<bool> inside = false;
  const auto service_endpoint = rig_->ForService().MakeServiceEndpoint();
  service.endpoint = service_endpoint.get();
  const auto agent_endpoint = rig_->ForAgent().MakeAgentEndpoint(1);
  agent.on_frame = [&](const FrameMessage& frame) {
    EXPECT_FALSE(inside.exchange(true));
    SendAsMember(*agent_endpoint, {frame.run, 1, frame.state.tick, {}, {}});
    inside = false;
  };
  service_endpoint->Start(service);
  agent_endpoint->Start(agent);
  EXPECT_TRUE(SendUntil(
      service.answers, [&] { service.Send(); }, [](Tick tick) { return tick == 20; }));
}

TEST_P(TransportContract, RunsGiveTheSameHashesForAnyPackingAndStartOrder) {
  const std::vector<WholeRun> runs = {
      {{{"r0"}, {"r1"}, {"r2"}, {"r3"}}, true, GetParam().ticks},
      {{{"r3"}, {"r1"}, {"r2", "r0"}}, false, GetParam().ticks},
      {{{"r0", "r1", "r2", "r3"}}, true, GetParam().ticks},
  };
  // The reference: a run in memory.
  class MemoryRig final : public TransportRig {
   public:
    Transport& ForService() override { return *transport_; }
    Transport& ForAgent() override { return *transport_; }
    Transport& ForObserver() override { return *transport_; }

   private:
    std::unique_ptr<Transport> transport_ = MakeMemoryTransport();
  } memory;
  const WholeRunResult expected = RunBusyWorld(memory, runs.back());
  ASSERT_EQ(std::count(expected.hash_log.begin(), expected.hash_log.end(), '\n'),
            static_cast<std::ptrdiff_t>(GetParam().ticks) + 1);

  for (const WholeRun& run : runs) {
    const std::unique_ptr<TransportRig> rig = GetParam().make();
    const WholeRunResult result = RunBusyWorld(*rig, run);
    EXPECT_EQ(result.hash_log, expected.hash_log);
    EXPECT_EQ(result.summary.ticks, run.ticks);
    EXPECT_EQ(result.summary.state_hash, expected.summary.state_hash);
    EXPECT_EQ(result.summary.rejected, 0u);
    EXPECT_THAT(result.summary.lost, testing::IsEmpty());
  }
}

}  // namespace troupe::test
