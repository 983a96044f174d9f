#include "transport/dds/transport/dds_transport.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <functional>
#include <mutex>

#include "tests/support/dds_domain.h"
#include "tests/unit/dds/child_process.h"
#include "transport/dds/binding/data_reader.h"
#include "transport/dds/binding/data_writer.h"
#include "transport/dds/binding/domain_participant.h"
#include "transport/dds/binding/exception.h"
#include "transport/dds/convert/topic_types.h"
#include "transport/dds/transport/dds_agent_endpoint.h"
#include "transport/dds/transport/qos_profiles.h"
#include "transport/protocol/agent_name.h"
#include "transport/protocol/topics.h"

namespace troupe {
namespace {

using test::ChildProcess;
using test::Eventually;

// Keeps the messages that it receives, and answers them if the test has set a function for that.
class Service : public ServiceHandler {
 public:
  void OnJoin(const JoinMessage& join) override {
    Keep(joins, join);
    if (on_join) on_join(join);
  }
  void OnProposal(const ProposalMessage& proposal) override {
    Keep(proposals, proposal);
    if (on_proposal) on_proposal(proposal);
  }
  void OnAgentGone(AgentId agent) override { Keep(gone, agent); }
  void OnRivalService(const SessionMessage& rival) override { Keep(rivals, rival); }

  template <typename Message>
  std::vector<Message> Heard(const std::vector<Message>& kept) {
    const std::lock_guard lock(mutex_);
    return kept;
  }

  std::function<void(const JoinMessage&)> on_join;
  std::function<void(const ProposalMessage&)> on_proposal;
  std::vector<JoinMessage> joins;
  std::vector<ProposalMessage> proposals;
  std::vector<AgentId> gone;
  std::vector<SessionMessage> rivals;

 private:
  template <typename Message>
  void Keep(std::vector<Message>& kept, const Message& message) {
    const std::lock_guard lock(mutex_);
    kept.push_back(message);
  }
  std::mutex mutex_;
};

class Agent : public AgentHandler {
 public:
  void OnSession(const SessionMessage& session) override {
    Keep(sessions, session);
    if (on_session) on_session(session);
  }
  void OnAdmission(const AdmissionMessage& admission) override { Keep(admissions, admission); }
  void OnFrame(const FrameMessage& frame) override {
    Keep(frames, frame);
    if (on_frame) on_frame(frame);
  }
  void OnServiceGone() override { Keep(services_gone, 1); }
  void OnServiceLost() override { Keep(services_lost, 1); }

  template <typename Message>
  std::vector<Message> Heard(const std::vector<Message>& kept) {
    const std::lock_guard lock(mutex_);
    return kept;
  }

  std::function<void(const SessionMessage&)> on_session;
  std::function<void(const FrameMessage&)> on_frame;
  std::vector<SessionMessage> sessions;
  std::vector<AdmissionMessage> admissions;
  std::vector<FrameMessage> frames;
  std::vector<int> services_gone;
  std::vector<int> services_lost;

 private:
  template <typename Message>
  void Keep(std::vector<Message>& kept, const Message& message) {
    const std::lock_guard lock(mutex_);
    kept.push_back(message);
  }
  std::mutex mutex_;
};

class DdsTransportTest : public testing::Test {
 protected:
  DdsTransportTest() {
    options_.domain = test::TestDomain();
    options_.session = test::TestSession(testing::UnitTest::GetInstance()->current_test_info()->name());
  }

  SessionMessage Session(RunId run) const {
    SessionMessage session;
    session.run = run;
    session.protocol_version = 3;
    session.host = "host";
    session.pid = 1234;
    session.lease_seconds = options_.lease_seconds;
    session.world.name = "a world";
    return session;
  }
  static JoinMessage Join(RunId run, AgentId agent) {
    JoinMessage join;
    join.run = run;
    join.agent = agent;
    join.robots = {"r" + std::to_string(agent)};
    return join;
  }
  // Notes its port.
  std::unique_ptr<Transport> MakeServiceTransport() {
    DdsServiceTransport made = MakeDdsServiceTransport(options_);
    port_ = made.participants.front().port;
    return std::move(made.transport);
  }
  // Agents need the real port of the service: another session may have the first one.
  DdsOptions AgentOptions() const {
    DdsOptions options = options_;
    options.service_address = "127.0.0.1:" + std::to_string(port_);
    return options;
  }
  std::vector<std::string> Peer(const std::string& role, std::uint64_t id) const {
    return {TROUPE_TEST_PEER,
            role,
            std::to_string(options_.domain),
            options_.session,
            std::to_string(id),
            std::to_string(options_.lease_seconds)};
  }

  DdsOptions options_;
  std::uint16_t port_ = 0;
};

TEST_F(DdsTransportTest, DeliversEveryMessage) {
  const auto service_transport = MakeServiceTransport();
  const auto agent_transport = MakeDdsAgentTransport(AgentOptions());
  Service service;
  Agent agent;
  const auto service_end = service_transport->MakeServiceEndpoint();
  const auto agent_end = agent_transport->MakeAgentEndpoint(11);
  service_end->Start(service);
  agent_end->Start(agent);

  service_end->SendSession(Session(5));
  ASSERT_TRUE(Eventually([&] { return agent.Heard(agent.sessions).size() == 1; }));
  EXPECT_EQ(Session(5), agent.Heard(agent.sessions)[0]);

  ASSERT_TRUE(Eventually([&] {
    agent_end->SendJoin(Join(5, 11));
    return !service.Heard(service.joins).empty();
  }));
  EXPECT_EQ(Join(5, 11), service.Heard(service.joins)[0]);

  const AdmissionMessage admission{5, 11, false, "no such robot"};
  service_end->SendAdmissions({admission});
  ASSERT_TRUE(Eventually([&] { return !agent.Heard(agent.admissions).empty(); }));
  EXPECT_EQ(admission, agent.Heard(agent.admissions)[0]);

  FrameMessage frame;
  frame.run = 5;
  frame.state.tick = 9;
  frame.state.robots = {{{1.0, 2.0, 3.0, 0.5}, {4.0, 5.0, 6.0}, true}};
  frame.state_hash = 0xfedcba9876543210u;
  frame.events = {{9, EventType::kStallBegan, RobotId(0), ModelId(3), "wall"}};
  service_end->SendFrame(frame);
  ASSERT_TRUE(Eventually([&] { return !agent.Heard(agent.frames).empty(); }));
  EXPECT_EQ(frame, agent.Heard(agent.frames)[0]);

  ProposalMessage proposal;
  proposal.run = 5;
  proposal.agent = 11;
  proposal.tick = 10;
  proposal.proposals = {{RobotId(0), {0.1, 0.2, 0.3}}};
  proposal.reports = {"something"};
  agent_end->SendProposal(proposal);
  ASSERT_TRUE(Eventually([&] { return !service.Heard(service.proposals).empty(); }));
  EXPECT_EQ(proposal, service.Heard(service.proposals)[0]);
}

// Most frames have the changes since the one before. An agent without that one receives the state with the resent
// frame.
TEST_F(DdsTransportTest, EveryReceivedFrameHasTheWholeState) {
  const auto service_transport = MakeServiceTransport();
  Service service;
  const auto service_end = service_transport->MakeServiceEndpoint();
  service_end->Start(service);
  const auto agent_transport = MakeDdsAgentTransport(AgentOptions());
  Agent agent;
  const auto agent_end = agent_transport->MakeAgentEndpoint(1);
  agent_end->Start(agent);

  FrameMessage frame;
  frame.run = 5;
  frame.state.robots.resize(3);
  frame.state.objects.resize(2);
  ASSERT_TRUE(Eventually([&] {
    service_end->SendFrame(frame);
    return !agent.Heard(agent.frames).empty();
  }));
  const auto drive = [&](std::size_t robot) {
    ++frame.state.tick;
    frame.state.robots[robot].X_WR.x += 1.0;
    service_end->SendFrame(frame);
    return Eventually([&] { return agent.Heard(agent.frames).back() == frame; });
  };
  for (const std::size_t robot : {0u, 1u, 0u, 2u}) EXPECT_TRUE(drive(robot)) << "tick " << frame.state.tick;

  const auto late_transport = MakeDdsAgentTransport(AgentOptions());
  Agent late;
  const auto late_end = late_transport->MakeAgentEndpoint(2);
  late_end->Start(late);
  ASSERT_TRUE(Eventually([&] {
    service_end->SendFrame(frame);
    return !late.Heard(late.frames).empty();
  }));
  EXPECT_EQ(frame, late.Heard(late.frames).front());
  EXPECT_TRUE(drive(1));
  EXPECT_TRUE(Eventually([&] { return late.Heard(late.frames).back() == frame; }));
}

// An agent that starts before the service, and one that starts after.
TEST_F(DdsTransportTest, TheSessionReachesEarlyAndLateAgents) {
  const auto early_transport = MakeDdsAgentTransport(options_);
  Agent early;
  const auto early_end = early_transport->MakeAgentEndpoint(1);
  early_end->Start(early);
  const auto service_transport = MakeServiceTransport();
  Service service;
  const auto service_end = service_transport->MakeServiceEndpoint();
  service_end->SendSession(Session(5));
  service_end->Start(service);
  EXPECT_TRUE(Eventually([&] { return early.Heard(early.sessions).size() == 1; }));
  const auto late_transport = MakeDdsAgentTransport(AgentOptions());
  Agent late;
  const auto late_end = late_transport->MakeAgentEndpoint(2);
  late_end->Start(late);
  EXPECT_TRUE(Eventually([&] { return late.Heard(late.sessions).size() == 1; }));
}

TEST_F(DdsTransportTest, ALargeWorldArrivesWhole) {
  SessionMessage session = Session(5);
  session.world.shapes.resize(1);
  for (int i = 0; i < 100'000; ++i) {
    session.world.shapes[0].rectangles.push_back({i + 0.0, 0.0, i + 1.0, 1.0});
  }
  const auto service_transport = MakeServiceTransport();
  const auto service_end = service_transport->MakeServiceEndpoint();
  service_end->SendSession(session);
  const auto agent_transport = MakeDdsAgentTransport(AgentOptions());
  Agent agent;
  const auto agent_end = agent_transport->MakeAgentEndpoint(2);
  agent_end->Start(agent);
  ASSERT_TRUE(Eventually([&] { return agent.Heard(agent.sessions).size() == 1; }));
  EXPECT_EQ(session, agent.Heard(agent.sessions)[0]);
}

// Each side answers inside its handler: the agent a frame with a proposal, the service a proposal with the next frame.
TEST_F(DdsTransportTest, HandlersAnswerEachOtherForManyTicks) {
  constexpr Tick kTicks = 2000;
  const auto service_transport = MakeServiceTransport();
  const auto agent_transport = MakeDdsAgentTransport(AgentOptions());
  Service service;
  Agent agent;
  const auto service_end = service_transport->MakeServiceEndpoint();
  const auto agent_end = agent_transport->MakeAgentEndpoint(1);
  FrameMessage frame;
  frame.state.robots.resize(10);
  service.on_join = [&](const JoinMessage&) {
    if (frame.state.tick == 0) service_end->SendFrame(frame);
  };
  service.on_proposal = [&](const ProposalMessage& proposal) {
    if (proposal.tick != frame.state.tick + 1 || proposal.tick > kTicks) return;
    frame.state.tick = proposal.tick;
    service_end->SendFrame(frame);
  };
  agent.on_session = [&](const SessionMessage& session) { agent_end->SendJoin(Join(session.run, 1)); };
  agent.on_frame = [&](const FrameMessage& seen) {
    ProposalMessage proposal;
    proposal.agent = 1;
    proposal.tick = seen.state.tick + 1;
    proposal.proposals = {{RobotId(0), {}}};
    agent_end->SendProposal(proposal);
  };
  service_end->Start(service);
  agent_end->Start(agent);
  service_end->SendSession(Session(5));
  // Before all writers and readers have matched, messages may be lost: begin again until the first is answered.
  ASSERT_TRUE(Eventually([&] {
    if (service.Heard(service.proposals).empty()) agent_end->SendJoin(Join(5, 1));
    return service.Heard(service.proposals).size() >= kTicks;
  }));
}

TEST_F(DdsTransportTest, SessionsOfOtherNamesDoNotMatch) {
  DdsOptions other = options_;
  other.session += "-other";
  const auto service_transport = MakeServiceTransport();
  const DdsServiceTransport other_service_transport = MakeDdsServiceTransport(other);
  EXPECT_NE(port_, other_service_transport.participants.front().port);
  Service service;
  const auto service_end = service_transport->MakeServiceEndpoint();
  Service other_service;
  const auto other_end = other_service_transport.transport->MakeServiceEndpoint();
  service_end->Start(service);
  other_end->Start(other_service);
  service_end->SendSession(Session(1));
  other_end->SendSession(Session(2));
  // Without a port, the agent finds its own service among those of this machine.
  const auto agent_transport = MakeDdsAgentTransport(options_);
  Agent agent;
  const auto agent_end = agent_transport->MakeAgentEndpoint(1);
  agent_end->Start(agent);
  ASSERT_TRUE(Eventually([&] { return !agent.Heard(agent.sessions).empty(); }));
  EXPECT_EQ(1u, agent.Heard(agent.sessions)[0].run);
  EXPECT_TRUE(service.Heard(service.rivals).empty());
  EXPECT_TRUE(other_service.Heard(other_service.rivals).empty());
}

TEST_F(DdsTransportTest, EachOfTwoRivalServicesDiscoversTheOther) {
  const auto first_transport = MakeDdsServiceTransport(options_).transport;
  const auto second_transport = MakeDdsServiceTransport(options_).transport;
  Service first;
  const auto first_end = first_transport->MakeServiceEndpoint();
  Service second;
  const auto second_end = second_transport->MakeServiceEndpoint();
  first_end->Start(first);
  second_end->Start(second);
  first_end->SendSession(Session(1));
  second_end->SendSession(Session(2));
  ASSERT_TRUE(Eventually([&] { return !first.Heard(first.rivals).empty(); }));
  ASSERT_TRUE(Eventually([&] { return !second.Heard(second.rivals).empty(); }));
  EXPECT_EQ(2u, first.Heard(first.rivals)[0].run);
  EXPECT_EQ(1u, second.Heard(second.rivals)[0].run);
}

// The service receives the request of a tool as soon as it has discovered its writer, perhaps before its reader.
TEST_F(DdsTransportTest, TheAnswerToAToolWaitsUntilItsReaderIsFound) {
  const auto service_transport = MakeServiceTransport();
  Service service;
  const auto service_end = service_transport->MakeServiceEndpoint();
  service_end->Start(service);
  ControlReply reply;
  reply.client = 77;
  reply.number = 5;
  service_end->SendControlReply(reply);

  const dds::DomainParticipant participant(
      dds::ToolConfig(options_.domain, "lo", "127.0.0.1:" + std::to_string(port_)));
  const dds::Topic<troupe_wire_ControlReply> topic(participant, topics::kControlReply);
  const dds::Subscriber subscriber(participant, dds::qos_profiles::Session(options_.session));
  dds::DataReader<troupe_wire_ControlReply> reader(subscriber, topic, dds::qos_profiles::ControlReply());
  std::uint64_t heard = 0;
  ASSERT_TRUE(Eventually([&] {
    for (const auto sample : reader.take()) {
      if (sample.info().valid() && sample.data().client == reply.client) heard = sample.data().number;
    }
    return heard != 0;
  }));
  EXPECT_EQ(heard, reply.number);
}

TEST_F(DdsTransportTest, AnAgentThatLeavesIsReportedGone) {
  const auto service_transport = MakeServiceTransport();
  Service service;
  const auto service_end = service_transport->MakeServiceEndpoint();
  service_end->Start(service);
  const auto agent_transport = MakeDdsAgentTransport(AgentOptions());
  {
    Agent agent;
    const auto agent_end = agent_transport->MakeAgentEndpoint(21);
    agent_end->Start(agent);
    ASSERT_TRUE(Eventually([&] {
      agent_end->SendJoin(Join(1, 21));
      return !service.Heard(service.joins).empty();
    }));
    EXPECT_TRUE(service.Heard(service.gone).empty());
  }
  ASSERT_TRUE(Eventually([&] { return !service.Heard(service.gone).empty(); }));
  EXPECT_EQ(std::vector<AgentId>{21}, service.Heard(service.gone));
}

TEST_F(DdsTransportTest, OnlyTheKilledAgentIsReportedGone) {
  options_.lease_seconds = 1.0;
  const auto service_transport = MakeDdsServiceTransport(options_).transport;
  Service service;
  const auto service_end = service_transport->MakeServiceEndpoint();
  service_end->Start(service);
  service_end->SendSession(Session(1));
  ChildProcess victim(Peer("agent", 31));
  ChildProcess survivor(Peer("agent", 32));
  ASSERT_TRUE(Eventually([&] { return service.Heard(service.joins).size() == 2; }));
  victim.End(SIGKILL);
  ASSERT_TRUE(Eventually([&] { return !service.Heard(service.gone).empty(); }));
  EXPECT_EQ(std::vector<AgentId>{31}, service.Heard(service.gone));
  survivor.End(SIGTERM);
  ASSERT_TRUE(Eventually([&] { return service.Heard(service.gone).size() == 2; }));
  EXPECT_EQ((std::vector<AgentId>{31, 32}), service.Heard(service.gone));
}

TEST_F(DdsTransportTest, AServiceThatEndsIsReportedGoneAndOneThatIsKilledLost) {
  for (const int signal : {SIGTERM, SIGKILL}) {
    options_.lease_seconds = 1.0;
    options_.session += "x";
    ChildProcess service(Peer("service", 41));
    const auto agent_transport = MakeDdsAgentTransport(options_);
    Agent agent;
    const auto agent_end = agent_transport->MakeAgentEndpoint(1);
    agent_end->Start(agent);
    ASSERT_TRUE(Eventually([&] { return !agent.Heard(agent.sessions).empty(); }));
    agent_end->SendJoin(Join(41, 1));
    EXPECT_TRUE(agent.Heard(agent.services_gone).empty());
    service.End(signal);
    const std::vector<int>& expected = signal == SIGTERM ? agent.services_gone : agent.services_lost;
    const std::vector<int>& other = signal == SIGTERM ? agent.services_lost : agent.services_gone;
    EXPECT_TRUE(Eventually([&] { return agent.Heard(expected).size() == 1; })) << "signal " << signal;
    EXPECT_THAT(agent.Heard(other), testing::IsEmpty()) << "signal " << signal;
  }
}

TEST_F(DdsTransportTest, AServiceThatWasStoppedBeyondItsLeaseIsLostAndAnnouncesItselfAgain) {
  options_.lease_seconds = 0.5;
  ChildProcess service(Peer("service", 41));
  const auto agent_transport = MakeDdsAgentTransport(options_);
  Agent agent;
  const auto agent_end = agent_transport->MakeAgentEndpoint(1);
  agent_end->Start(agent);
  ASSERT_TRUE(Eventually([&] { return agent.Heard(agent.sessions).size() == 1; }));
  agent_end->SendJoin(Join(41, 1));
  service.Signal(SIGSTOP);
  ASSERT_TRUE(Eventually([&] { return agent.Heard(agent.services_lost).size() == 1; }));
  service.Signal(SIGCONT);
  EXPECT_TRUE(Eventually([&] { return agent.Heard(agent.sessions).size() == 2; }));
  EXPECT_THAT(agent.Heard(agent.services_gone), testing::IsEmpty());
}

TEST_F(DdsTransportTest, TheEndOfAnEarlierServiceDoesNotAffectTheNextRun) {
  const auto old_transport = MakeDdsServiceTransport(options_).transport;
  auto old_end = old_transport->MakeServiceEndpoint();
  old_end->SendSession(Session(1));
  const auto agent_transport = MakeDdsAgentTransport(options_);
  Agent agent;
  const auto agent_end = agent_transport->MakeAgentEndpoint(1);
  agent_end->Start(agent);
  ASSERT_TRUE(Eventually([&] { return agent.Heard(agent.sessions).size() == 1; }));
  const auto new_transport = MakeDdsServiceTransport(options_).transport;
  auto new_end = new_transport->MakeServiceEndpoint();
  new_end->SendSession(Session(2));
  ASSERT_TRUE(Eventually([&] { return agent.Heard(agent.sessions).size() == 2; }));
  agent_end->SendJoin(Join(2, 1));
  old_end.reset();
  new_end->SendAdmissions({{2, 1, true, ""}});
  ASSERT_TRUE(Eventually([&] { return !agent.Heard(agent.admissions).empty(); }));
  EXPECT_TRUE(agent.Heard(agent.services_gone).empty());
  new_end.reset();
  EXPECT_TRUE(Eventually([&] { return agent.Heard(agent.services_gone).size() == 1; }));
}

TEST_F(DdsTransportTest, MalformedMessagesAreReportedAndIgnored) {
  std::mutex mutex;
  std::vector<std::string> problems;
  // A participant like the service's, which writes messages that no service would.
  constexpr std::uint32_t kIndex = 60;
  dds::DomainConfig config = test::TestConfig();
  config.participant_index = kIndex;
  const dds::DomainParticipant hostile(config);
  const dds::Publisher publisher(hostile, dds::qos_profiles::Session(options_.session));
  const dds::Topic<troupe_wire_Frame> topic(hostile, topics::kFrame);
  dds::DataWriter<troupe_wire_Frame> writer(publisher, topic, dds::qos_profiles::Frame());

  port_ = dds::DiscoveryPort(options_.domain, kIndex);
  DdsOptions agent_options = AgentOptions();
  agent_options.data_sharing = false;
  agent_options.on_problem = [&](const std::string& problem) {
    const std::lock_guard lock(mutex);
    problems.push_back(problem);
  };
  const auto agent_transport = MakeDdsAgentTransport(agent_options);
  Agent agent;
  const auto agent_end = agent_transport->MakeAgentEndpoint(1);
  agent_end->Start(agent);
  ASSERT_TRUE(Eventually([&] { return writer.publication_matched_status().current_count == 1; }));
  double numbers[] = {1.0, 2.0};
  troupe_wire_Frame frame{};
  frame.whole = true;
  frame.state.robots.x = {2, 2, numbers, false};
  const auto count = [&] {
    const std::lock_guard lock(mutex);
    return problems.size();
  };
  ASSERT_TRUE(Eventually([&] {
    writer.write(frame);
    return count() > 0;
  }));
  {
    const std::lock_guard lock(mutex);
    EXPECT_EQ("troupe/frame: ignored: frame with columns of different lengths, for its robots", problems[0]);
  }
  EXPECT_TRUE(agent.Heard(agent.frames).empty());
  frame.state.robots.x = {0, 0, nullptr, false};
  ASSERT_TRUE(Eventually([&] {
    writer.write(frame);
    return !agent.Heard(agent.frames).empty();
  }));
}

TEST_F(DdsTransportTest, AnAgentMakesItsEndpointsOfTheNetworkAgainAfterAFailure) {
  options_.data_sharing = false;
  const auto service_transport = MakeServiceTransport();
  Service service;
  const auto service_end = service_transport->MakeServiceEndpoint();
  service_end->Start(service);
  service_end->SendSession(Session(5));

  std::atomic<int> failures = 0;
  const dds::DdsConnection connection(
      dds::ToolConfig(options_.domain, "lo", "127.0.0.1:" + std::to_string(port_)), options_.session,
      [&](const std::string&) { ++failures; }, {}, AgentName({"r1"}));
  // As long as the participant has this topic with other QoS, there can be no writer of proposals.
  auto other = std::make_unique<dds::Entity>(
      dds_create_topic(connection.participant.handle(), dds::TopicTraits<troupe_wire_Proposal>::descriptor(),
                       topics::kProposal, dds::qos_profiles::Description().get(), nullptr));
  Agent agent;
  dds::DdsAgentEndpoint agent_end(connection, std::nullopt, true);
  agent_end.Start(agent);
  ASSERT_TRUE(Eventually([&] { return failures > 0; }));
  other.reset();
  FrameMessage frame;
  frame.run = 5;
  EXPECT_TRUE(Eventually([&] {
    service_end->SendFrame(frame);
    return !agent.Heard(agent.frames).empty();
  }));
  ProposalMessage proposal;
  proposal.run = 5;
  proposal.agent = 1;
  EXPECT_TRUE(Eventually([&] {
    agent_end.SendJoin(Join(5, 1));
    agent_end.SendProposal(proposal);
    return !service.Heard(service.proposals).empty();
  }));
}

TEST_F(DdsTransportTest, RefusesSessionNamesThatMatchOthers) {
  for (const std::string name : {"*", "a?b", "a[0-9]"}) {
    options_.session = name;
    EXPECT_THROW(MakeDdsServiceTransport(options_), dds::Exception) << name;
    EXPECT_THROW(MakeDdsAgentTransport(options_), dds::Exception) << name;
  }
}

// Over the network. A shared frame is received as soon as it is sent.
TEST_F(DdsTransportTest, FlushWaitsUntilAllHaveReceived) {
  options_.data_sharing = false;
  const auto service_transport = MakeServiceTransport();
  Service service;
  const auto service_end = service_transport->MakeServiceEndpoint();
  service_end->Start(service);
  service_end->SendSession(Session(1));
  const auto agent_transport = MakeDdsAgentTransport(AgentOptions());
  Agent agent;
  const auto agent_end = agent_transport->MakeAgentEndpoint(1);
  agent.on_session = [&](const SessionMessage& session) { agent_end->SendJoin(Join(session.run, 1)); };
  agent_end->Start(agent);
  FrameMessage frame;
  ASSERT_TRUE(Eventually([&] {
    service_end->SendFrame(frame);
    return !agent.Heard(agent.frames).empty();
  }));
  frame.last = true;
  service_end->SendFrame(frame);
  service_end->Flush(10.0);
  EXPECT_TRUE(agent.Heard(agent.frames).back().last);
}

}  // namespace
}  // namespace troupe
