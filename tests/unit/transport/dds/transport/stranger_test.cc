// A participant without any part in a run sends messages in the names of its service and its agents.
#include "tests/support/stranger.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "tests/contract/transport_case.h"
#include "tests/support/dds_domain.h"
#include "transport/dds/transport/dds_transport.h"
#include "transport/protocol/messages.h"

namespace troupe {
namespace {

using test::Eventually;
using test::Forger;
using test::Stranger;

constexpr RunId kRun = 77;
constexpr AgentId kAgent = 5;
constexpr std::size_t kMany = 2000;  // messages

// The lines that a program would print about messages that it ignored.
class Problems {
 public:
  std::function<void(const std::string&)> Add() {
    return [this](const std::string& line) {
      const std::lock_guard lock(mutex_);
      lines_.push_back(line);
    };
  }
  bool Have(const std::string& text) const {
    const std::lock_guard lock(mutex_);
    return std::any_of(lines_.begin(), lines_.end(),
                       [&](const std::string& line) { return line.find(text) != std::string::npos; });
  }

 private:
  mutable std::mutex mutex_;
  std::vector<std::string> lines_;
};

class StrangerTest : public testing::Test {
 protected:
  StrangerTest() {
    options_.domain = test::TestDomain();
    options_.data_sharing = false;  // a stranger reaches only the network
    options_.session = test::TestSession(testing::UnitTest::GetInstance()->current_test_info()->name());
    DdsOptions service = options_;
    service.on_problem = service_problems_.Add();
    DdsServiceTransport made = MakeDdsServiceTransport(service);
    service_transport_ = std::move(made.transport);
    participant_ = made.participants.front().participant;
    service_end_ = service_transport_->MakeServiceEndpoint();
    service_end_->Start(service_);
    service_end_->SendSession(Session());

    options_.service_address = "127.0.0.1";  // any port
    DdsOptions agent = options_;
    agent.on_problem = agent_problems_.Add();
    agent.service_participant = participant_;
    agent_transport_ = MakeDdsAgentTransport(agent);
    agent_end_ = agent_transport_->MakeAgentEndpoint(kAgent);
    agent_end_->Start(agent_);
  }

  static SessionMessage Session() { return {.run = kRun, .host = "the true host"}; }
  static JoinMessage Join() { return {.run = kRun, .agent = kAgent, .robots = {"r0"}}; }
  static ProposalMessage Proposal(Tick tick) { return {.run = kRun, .agent = kAgent, .tick = tick}; }

  bool AgentJoins() {
    return Eventually([this] {
      agent_end_->SendJoin(Join());
      return !service_.joins.items().empty();
    });
  }

  DdsOptions options_;
  Problems service_problems_;
  Problems agent_problems_;
  std::string participant_;
  test::CollectingService service_;
  test::CollectingAgent agent_;
  std::unique_ptr<Transport> service_transport_;
  std::unique_ptr<Transport> agent_transport_;
  std::unique_ptr<ServiceEndpoint> service_end_;
  std::unique_ptr<AgentEndpoint> agent_end_;
};

TEST_F(StrangerTest, ForgedFramesAndAdmissionsDoNotReachAnAgent) {
  ASSERT_TRUE(AgentJoins());
  ASSERT_TRUE(Eventually([this] { return !agent_.sessions.items().empty(); }));
  const Stranger stranger(options_.session);
  Forger<troupe_wire_Frame> frames(stranger, stranger.publisher, topics::kFrame, dds::qos_profiles::Frame());
  Forger<troupe_wire_Admissions> admissions(stranger, stranger.publisher, topics::kAdmission,
                                            dds::qos_profiles::Admission());
  Forger<troupe_wire_Session> sessions(stranger, stranger.publisher, topics::kSession,
                                       dds::qos_profiles::Description(1.0));
  ASSERT_TRUE(frames.Found() && admissions.Found() && sessions.Found());

  FrameMessage last;
  last.run = kRun;
  last.state.tick = 7;
  last.last = true;
  frames.Send(last);
  admissions.Send(std::vector<AdmissionMessage>{{kRun, kAgent, false, "leave"}});
  SessionMessage false_session = Session();
  false_session.host = "a false host";
  sessions.Send(false_session);
  EXPECT_TRUE(Eventually([this] {
    return agent_problems_.Have("troupe/frame: ignored participant") &&
           agent_problems_.Have("troupe/admission: ignored participant") &&
           agent_problems_.Have("troupe/session: ignored participant");
  }));

  // The service is still the one that the agent obeys.
  FrameMessage frame;
  frame.run = kRun;
  frame.state.tick = 1;
  service_end_->SendFrame(frame);
  ASSERT_TRUE(agent_.frames.WaitFor(20.0, [](const FrameMessage&) { return true; }));
  EXPECT_EQ(agent_.frames.items().front().state.tick, 1u);
  EXPECT_TRUE(agent_.admissions.items().empty());
  for (const SessionMessage& session : agent_.sessions.items()) EXPECT_EQ(session.host, "the true host");
  EXPECT_TRUE(agent_.service_gone.items().empty());
}

TEST_F(StrangerTest, ForgedJoinsAndProposalsAreNotTheAgents) {
  ASSERT_TRUE(AgentJoins());
  {
    const Stranger stranger(options_.session);
    Forger<troupe_wire_Join> joins(stranger, stranger.agent_publisher, topics::kJoin, dds::qos_profiles::Join(1.0));
    Forger<troupe_wire_Proposal> proposals(stranger, stranger.agent_publisher, topics::kProposal,
                                           dds::qos_profiles::Proposal());
    ASSERT_TRUE(joins.Found() && proposals.Found());
    JoinMessage join = Join();
    join.robots = {"another"};
    joins.Send(join);
    proposals.Send(Proposal(666));
    EXPECT_TRUE(Eventually([this] {
      return service_problems_.Have("troupe/join: ignored participant") &&
             service_problems_.Have("troupe/proposal: ignored participant");
    }));
  }
  // The end of the forger is not the end of the agent.
  agent_end_->SendProposal(Proposal(1));
  ASSERT_TRUE(service_.proposals.WaitFor(20.0, [](const ProposalMessage&) { return true; }));
  for (const ProposalMessage& proposal : service_.proposals.items()) EXPECT_EQ(proposal.tick, 1u);
  for (const JoinMessage& join : service_.joins.items()) EXPECT_EQ(join.robots, std::vector<std::string>{"r0"});
  EXPECT_TRUE(service_.gone.items().empty());

  agent_end_.reset();
  EXPECT_TRUE(service_.gone.WaitFor(20.0, [](AgentId agent) { return agent == kAgent; }));
}

// As after a lease that expires for a moment: the end of the first writer may be noticed after the joins of the second.
TEST_F(StrangerTest, AnAgentWhoseWriterIsDiscoveredAgainStaysAnAgent) {
  constexpr AgentId kOther = 9;
  JoinMessage join = Join();
  join.agent = kOther;
  const auto joins_with = [this](const std::string& robot) {
    return service_.joins.WaitFor(
        20.0, [&](const JoinMessage& one) { return one.agent == kOther && one.robots.front() == robot; });
  };
  const Stranger other(options_.session);
  auto first = std::make_unique<Forger<troupe_wire_Join>>(other, other.agent_publisher, topics::kJoin,
                                                          dds::qos_profiles::Join(1.0));
  ASSERT_TRUE(first->Found());
  first->Send(join);
  ASSERT_TRUE(joins_with("r0"));
  auto again = std::make_unique<Forger<troupe_wire_Join>>(other, other.agent_publisher, topics::kJoin,
                                                          dds::qos_profiles::Join(1.0));
  ASSERT_TRUE(again->Found());
  join.robots = {"r1"};
  again->Send(join);
  ASSERT_TRUE(joins_with("r1"));
  first.reset();
  join.robots = {"r2"};
  again->Send(join);
  ASSERT_TRUE(joins_with("r2"));
  EXPECT_TRUE(service_.gone.items().empty());
  EXPECT_FALSE(service_problems_.Have("troupe/join: ignored participant"));
  again.reset();
  EXPECT_TRUE(service_.gone.WaitFor(20.0, [](AgentId agent) { return agent == kOther; }));
}

TEST(UnseenServiceTest, AnAgentFollowsOneThatContinuesTheRunOfAServiceThatItHasNotSeen) {
  for (const bool data_sharing : {false, true}) {
    for (const Incarnation incarnation : {0, 1}) {
      Problems problems;
      DdsOptions options;
      options.domain = test::TestDomain();
      options.session = test::TestSession("unseen" + std::to_string(incarnation) + std::to_string(data_sharing));
      options.data_sharing = data_sharing;
      options.on_problem = problems.Add();
      test::StartedService service(MakeDdsServiceTransport(options).transport);
      SessionMessage session{.run = kRun, .host = "a host", .world = test::BusyWorld()};
      session.incarnation = incarnation;
      service.endpoint->SendSession(session);
      options.service_address = "127.0.0.1";
      options.service_participant = "0102030405060708090a0b0c";  // of a process that has ended
      test::StartedAgent agent(MakeDdsAgentTransport(options), kAgent);
      if (incarnation > 0) {
        EXPECT_TRUE(agent.sessions.WaitFor(20.0, [](const SessionMessage&) { return true; }));
      } else if (!data_sharing) {
        EXPECT_TRUE(Eventually([&] { return problems.Have("troupe/session: ignored participant"); }));
        EXPECT_TRUE(agent.sessions.items().empty());
      }
    }
  }
}

TEST_F(StrangerTest, AFloodOfAgentsOfOneWriterIsCutOff) {
  const Stranger stranger(options_.session);
  Forger<troupe_wire_Join> joins(stranger, stranger.agent_publisher, topics::kJoin, dds::qos_profiles::Join(1.0));
  ASSERT_TRUE(joins.Found());
  for (std::size_t i = 0; i < kMany; ++i) {
    JoinMessage join = Join();
    join.agent = 1000 + i;
    joins.Send(join);
  }
  ASSERT_TRUE(joins.Delivered());
  ASSERT_TRUE(Eventually([this] { return service_problems_.Have("troupe/join: ignored participant"); }));
  EXPECT_LE(service_.joins.items().size(), 64u);
  EXPECT_TRUE(AgentJoins());
}

TEST_F(StrangerTest, AMessageBeyondTheLargestSizeIsDropped) {
  const Stranger stranger(options_.session);
  Forger<troupe_wire_Control> controls(stranger, stranger.publisher, topics::kControl, dds::qos_profiles::Control());
  ASSERT_TRUE(controls.Found());
  ControlRequest request;
  request.request = control::LoadWorld{std::string(20'000'000, 'x')};
  controls.Send(request);
  request.request = control::LoadWorld{"a world"};
  controls.Send(request);
  EXPECT_TRUE(
      service_.controls.WaitFor(20.0, [&](const ControlRequest& heard) { return heard.request == request.request; }));
  EXPECT_EQ(service_.controls.items().size(), 1u);
}

}  // namespace
}  // namespace troupe
