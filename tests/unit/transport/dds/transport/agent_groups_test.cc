// A service with groups of agents: each group has a participant of its own, and all are one service.
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "tests/contract/transport_case.h"
#include "tests/support/dds_domain.h"
#include "transport/dds/binding/domain_config.h"
#include "transport/dds/transport/dds_service_endpoint.h"
#include "transport/dds/transport/dds_transport.h"

namespace troupe {
namespace {

constexpr double kSeconds = 30.0;  // longest wait on the slowest machine
constexpr std::size_t kGroups = 3;
constexpr RunId kGroupedRun = 5;

class AgentGroupsTest : public testing::TestWithParam<bool> {
 protected:
  AgentGroupsTest() {
    options_.domain = test::TestDomain();
    options_.session = test::TestSession("groups");
    options_.data_sharing = GetParam();
    options_.agent_groups = kGroups;
    made_ = MakeDdsServiceTransport(options_);
    service_end_ = made_.transport->MakeServiceEndpoint();
    service_end_->Start(service_);
    SessionMessage session;
    session.run = kGroupedRun;
    service_end_->SendSession(session);
  }

  // An agent of each group; its id is one more than that of the group.
  struct Member {
    Member(const DdsOptions& options, AgentId id)
        : transport(MakeDdsAgentTransport(options)), end(transport->MakeAgentEndpoint(id)) {
      end->Start(handler);
    }
    test::CollectingAgent handler;
    std::unique_ptr<Transport> transport;
    std::unique_ptr<AgentEndpoint> end;
  };
  void StartAgents() {
    for (std::size_t group = 0; group < kGroups; ++group) {
      DdsOptions options = options_;
      options.service_address = "127.0.0.1:" + std::to_string(made_.participants[group].port);
      options.service_participant = made_.participants[group].participant;
      members_.push_back(std::make_unique<Member>(options, AgentId(group + 1)));
    }
  }
  void Join() {
    for (std::size_t group = 0; group < kGroups; ++group) {
      const AgentId id(group + 1);
      ASSERT_TRUE(
          members_[group]->handler.sessions.WaitFor(kSeconds, [](const auto& s) { return s.run == kGroupedRun; }));
      JoinMessage join{.run = kGroupedRun, .agent = id, .robots = {"r" + std::to_string(group)}};
      ASSERT_TRUE(test::Eventually([&] {
        members_[group]->end->SendJoin(join);
        return service_.joins.WaitFor(0.1, [&](const JoinMessage& joined) { return joined.agent == id; });
      }));
    }
  }

  DdsOptions options_;
  DdsServiceTransport made_;
  test::CollectingService service_;
  std::unique_ptr<ServiceEndpoint> service_end_;
  std::vector<std::unique_ptr<Member>> members_;
};

TEST_P(AgentGroupsTest, EachGroupReceivesAllMessagesAndAnswers) {
  ASSERT_EQ(made_.participants.size(), kGroups);
  StartAgents();
  Join();
  service_end_->SendAdmissions({{kGroupedRun, 1, true, ""}, {kGroupedRun, 2, true, ""}, {kGroupedRun, 3, true, ""}});
  FrameMessage frame;
  frame.run = kGroupedRun;
  frame.state.tick = 9;
  service_end_->SendFrame(frame);
  for (std::size_t group = 0; group < kGroups; ++group) {
    Member& member = *members_[group];
    const AgentId id(group + 1);
    EXPECT_TRUE(member.handler.admissions.WaitFor(kSeconds, [&](const auto& one) { return one.agent == id; }));
    // A reader that had not matched yet has lost the frame.
    EXPECT_TRUE(test::Eventually([&] {
      service_end_->SendFrame(frame);
      return member.handler.frames.WaitFor(0.1, [](const FrameMessage& one) { return one.state.tick == 9; });
    }));
    ProposalMessage proposal{.run = kGroupedRun, .agent = id, .tick = 10};
    EXPECT_TRUE(test::Eventually([&] {
      member.end->SendProposal(proposal);
      return service_.proposals.WaitFor(0.1, [&](const ProposalMessage& one) { return one.agent == id; });
    }));
  }
  EXPECT_TRUE(service_.rivals.items().empty());
}

TEST_P(AgentGroupsTest, EachGroupLearnsTheEnd) {
  StartAgents();
  Join();
  service_end_.reset();
  for (const auto& member : members_) {
    EXPECT_TRUE(member->handler.service_gone.WaitFor(kSeconds, [](bool gone) { return gone; }));
  }
}

// Those of groups are beyond the ports at which agents and tools without a port look.
TEST_P(AgentGroupsTest, OnlyTheFirstParticipantIsDiscoveredWithoutItsPort) {
  for (std::size_t group = 1; group < kGroups; ++group) {
    EXPECT_GE(made_.participants[group].port, dds::DiscoveryPort(options_.domain, dds::kPeerPortsTried));
  }
  DdsOptions anywhere = options_;
  std::vector<std::string> problems;
  anywhere.on_problem = [&problems](const std::string& problem) { problems.push_back(problem); };
  members_.push_back(std::make_unique<Member>(anywhere, AgentId(7)));
  EXPECT_TRUE(members_.front()->handler.sessions.WaitFor(kSeconds, [](const auto& s) { return s.run == kGroupedRun; }));
  members_.clear();
  EXPECT_TRUE(problems.empty()) << problems.front();
}

TEST_P(AgentGroupsTest, TheSuccessorOfAServiceHasItsPorts) {
  DdsOptions successor = options_;
  for (const ServiceParticipant& of_group : made_.participants) successor.discovery_ports.push_back(of_group.port);
  service_end_.reset();
  made_.transport.reset();
  const DdsServiceTransport next = MakeDdsServiceTransport(successor);
  ASSERT_EQ(next.participants.size(), kGroups);
  for (std::size_t group = 0; group < kGroups; ++group) {
    EXPECT_EQ(next.participants[group].port, made_.participants[group].port);
  }
}

INSTANTIATE_TEST_SUITE_P(DataSharing, AgentGroupsTest, testing::Bool(),
                         [](const auto& of_case) { return std::string(of_case.param ? "On" : "Off"); });

}  // namespace

}  // namespace troupe

namespace troupe::dds {
namespace {

constexpr AgentId kIds = 1'000'000;

TEST(LostAgents, ForgetsTheOldestOfTooMany) {
  LostAgents lost;
  const GuidPrefix participant{{1}};
  for (AgentId i = 0; i < LostAgents::kMax; ++i) EXPECT_EQ(lost.Add(kIds - i, participant), std::nullopt);
  EXPECT_EQ(lost.Add(kIds - 1, participant), std::nullopt) << "lost again, so it is the newest";
  EXPECT_EQ(lost.Add(1, participant), kIds);
  EXPECT_EQ(lost.Add(kIds, participant), kIds - 2);
  EXPECT_TRUE(lost.Contains(kIds - 1, participant));
  EXPECT_FALSE(lost.Contains(kIds - 2, participant));
  EXPECT_FALSE(lost.Contains(1, GuidPrefix{{2}})) << "another participant";
  lost.Remove(1);
  EXPECT_FALSE(lost.Contains(1, participant));
  EXPECT_EQ(lost.Add(2, participant), std::nullopt);
}

}  // namespace
}  // namespace troupe::dds
