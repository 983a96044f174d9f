#include "transport/dds/transport/dds_transport.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <functional>
#include <mutex>

#include "tests/contract/transport_case.h"
#include "tests/support/dds_domain.h"
#include "tests/unit/transport/dds/transport/child_process.h"
#include "transport/dds/binding/data_reader.h"
#include "transport/dds/binding/data_writer.h"
#include "transport/dds/binding/domain_participant.h"
#include "transport/dds/binding/entity.h"
#include "transport/dds/convert/convert.h"
#include "transport/dds/transport/dds_agent_endpoint.h"
#include "transport/dds/transport/qos_profiles.h"
#include "transport/protocol/message_texts.h"
#include "transport/protocol/messages.h"
#include "transport/wire/message_bytes.h"

namespace troupe {
namespace {

using test::ChildProcess;
using test::Eventually;

using Service = test::StartedService;
using Agent = test::StartedAgent;

class DdsTransportTest : public testing::Test {
 protected:
  DdsTransportTest() {
    options_.domain = test::TestDomain();
    options_.session = test::TestSession(testing::UnitTest::GetInstance()->current_test_info()->name());
  }

  SessionMessage Session(RunId run) const {
    SessionMessage session{
        .run = run, .protocol_version = 3, .host = "host", .pid = 1234, .lease_seconds = options_.lease()};
    session.world.Change().name = "a world";
    return session;
  }
  static JoinMessage Join(RunId run, AgentId agent) {
    return {.run = run, .agent = agent, .robots = {"r" + std::to_string(agent)}};
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
            std::to_string(options_.lease())};
  }

  DdsOptions options_;
  std::uint16_t port_ = 0;
};

TEST_F(DdsTransportTest, DeliversEveryMessage) {
  Service service(MakeServiceTransport());
  Agent agent(MakeDdsAgentTransport(AgentOptions()), 11);

  service.endpoint->SendSession(Session(5));
  ASSERT_TRUE(Eventually([&] { return agent.sessions.items().size() == 1; }));
  EXPECT_EQ(Session(5), agent.sessions.items()[0]);

  ASSERT_TRUE(Eventually([&] {
    agent.endpoint->SendJoin(Join(5, 11));
    return !service.joins.items().empty();
  }));
  EXPECT_EQ(Join(5, 11), service.joins.items()[0]);

  const AdmissionMessage admission{5, 11, false, "no such robot"};
  service.endpoint->SendAdmissions({admission});
  ASSERT_TRUE(Eventually([&] { return !agent.admissions.items().empty(); }));
  EXPECT_EQ(admission, agent.admissions.items()[0]);

  FrameMessage frame;
  frame.run = 5;
  frame.state.tick = 9;
  frame.state.robots = {{{1.0, 2.0, 3.0, 0.5}, {4.0, 5.0, 6.0}, true}};
  frame.state_hash = 0xfedcba9876543210u;
  frame.events = {{9, EventType::kStallBegan, RobotId(0), ModelId(3), "wall"}};
  service.endpoint->SendFrame(frame);
  ASSERT_TRUE(Eventually([&] { return !agent.frames.items().empty(); }));
  EXPECT_EQ(frame, agent.frames.items()[0]);

  ProposalMessage proposal{
      .run = 5, .agent = 11, .tick = 10, .proposals = {{RobotId(0), {0.1, 0.2, 0.3}}}, .reports = {"something"}};
  agent.endpoint->SendProposal(proposal);
  ASSERT_TRUE(Eventually([&] { return !service.proposals.items().empty(); }));
  EXPECT_EQ(proposal, service.proposals.items()[0]);
}

// Most frames have the changes since the one before. An agent without that one receives the state with the resent
// frame.
TEST_F(DdsTransportTest, EveryReceivedFrameHasTheWholeState) {
  Service service(MakeServiceTransport());
  Agent agent(MakeDdsAgentTransport(AgentOptions()), 1);

  FrameMessage frame;
  frame.run = 5;
  frame.state.robots.resize(3);
  frame.state.objects.resize(2);
  ASSERT_TRUE(Eventually([&] {
    service.endpoint->SendFrame(frame);
    return !agent.frames.items().empty();
  }));
  const auto drive = [&](std::size_t robot) {
    ++frame.state.tick;
    frame.state.robots[robot].X_WR.x += 1.0;
    service.endpoint->SendFrame(frame);
    return Eventually([&] { return agent.frames.items().back() == frame; });
  };
  for (const std::size_t robot : {0u, 1u, 0u, 2u}) EXPECT_TRUE(drive(robot)) << "tick " << frame.state.tick;

  Agent late(MakeDdsAgentTransport(AgentOptions()), 2);
  ASSERT_TRUE(Eventually([&] {
    service.endpoint->SendFrame(frame);
    return !late.frames.items().empty();
  }));
  EXPECT_EQ(frame, late.frames.items().front());
  EXPECT_TRUE(drive(1));
  EXPECT_TRUE(Eventually([&] { return late.frames.items().back() == frame; }));
}

// An agent that starts before the service, and one that starts after.
TEST_F(DdsTransportTest, TheSessionReachesEarlyAndLateAgents) {
  Agent early(MakeDdsAgentTransport(options_), 1);
  const auto service_transport = MakeServiceTransport();
  test::CollectingService service;
  const auto service_end = service_transport->MakeServiceEndpoint();
  service_end->SendSession(Session(5));
  service_end->Start(service);
  EXPECT_TRUE(Eventually([&] { return early.sessions.items().size() == 1; }));
  Agent late(MakeDdsAgentTransport(AgentOptions()), 2);
  EXPECT_TRUE(Eventually([&] { return late.sessions.items().size() == 1; }));
}

TEST_F(DdsTransportTest, ALargeWorldArrivesWhole) {
  SessionMessage session = Session(5);
  WorldDescription& world = session.world.Change();
  world.shapes.resize(1);
  for (int i = 0; i < 100'000; ++i) {
    world.shapes[0].rectangles.push_back({i + 0.0, 0.0, i + 1.0, 1.0});
  }
  const auto service_transport = MakeServiceTransport();
  const auto service_end = service_transport->MakeServiceEndpoint();
  service_end->SendSession(session);
  Agent agent(MakeDdsAgentTransport(AgentOptions()), 2);
  ASSERT_TRUE(Eventually([&] { return agent.sessions.items().size() == 1; }));
  EXPECT_EQ(session, agent.sessions.items()[0]);
}

// Each side answers inside its handler: the agent a frame with a proposal, the service a proposal with the next frame.
TEST_F(DdsTransportTest, HandlersAnswerEachOtherForManyTicks) {
  constexpr Tick kTicks = 2000;
  const auto service_transport = MakeServiceTransport();
  const auto agent_transport = MakeDdsAgentTransport(AgentOptions());
  test::CollectingService service;
  test::CollectingAgent agent;
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
    agent_end->SendProposal(ProposalMessage{.agent = 1, .tick = seen.state.tick + 1, .proposals = {{RobotId(0), {}}}});
  };
  service_end->Start(service);
  agent_end->Start(agent);
  service_end->SendSession(Session(5));
  // Before all writers and readers have matched, messages may be lost: begin again until the first is answered.
  ASSERT_TRUE(Eventually([&] {
    if (service.proposals.items().empty()) agent_end->SendJoin(Join(5, 1));
    return service.proposals.items().size() >= kTicks;
  }));
}

TEST_F(DdsTransportTest, SessionsOfOtherNamesDoNotMatch) {
  DdsOptions other = options_;
  other.session += "-other";
  Service service(MakeServiceTransport());
  const DdsServiceTransport other_service_transport = MakeDdsServiceTransport(other);
  EXPECT_NE(port_, other_service_transport.participants.front().port);
  test::CollectingService other_service;
  const auto other_end = other_service_transport.transport->MakeServiceEndpoint();
  other_end->Start(other_service);
  service.endpoint->SendSession(Session(1));
  other_end->SendSession(Session(2));
  // Without a port, the agent finds its own service among those of this machine.
  Agent agent(MakeDdsAgentTransport(options_), 1);
  ASSERT_TRUE(Eventually([&] { return !agent.sessions.items().empty(); }));
  EXPECT_EQ(1u, agent.sessions.items()[0].run);
  EXPECT_TRUE(service.rivals.items().empty());
  EXPECT_TRUE(other_service.rivals.items().empty());
}

TEST_F(DdsTransportTest, EachOfTwoRivalServicesDiscoversTheOther) {
  Service first(MakeDdsServiceTransport(options_).transport);
  Service second(MakeDdsServiceTransport(options_).transport);
  first.endpoint->SendSession(Session(1));
  second.endpoint->SendSession(Session(2));
  ASSERT_TRUE(Eventually([&] { return !first.rivals.items().empty(); }));
  ASSERT_TRUE(Eventually([&] { return !second.rivals.items().empty(); }));
  EXPECT_EQ(2u, first.rivals.items()[0].run);
  EXPECT_EQ(1u, second.rivals.items()[0].run);
}

// The service receives the request of a tool as soon as it has discovered its writer, perhaps before its reader.
TEST_F(DdsTransportTest, TheAnswerToAToolWaitsUntilItsReaderIsFound) {
  Service service(MakeServiceTransport());
  ControlReply reply{.client = 77, .number = 5};
  service.endpoint->SendControlReply(reply);

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
  Service service(MakeServiceTransport());
  {
    Agent agent(MakeDdsAgentTransport(AgentOptions()), 21);
    ASSERT_TRUE(Eventually([&] {
      agent.endpoint->SendJoin(Join(1, 21));
      return !service.joins.items().empty();
    }));
    EXPECT_TRUE(service.gone.items().empty());
  }
  ASSERT_TRUE(Eventually([&] { return !service.gone.items().empty(); }));
  EXPECT_EQ(std::vector<AgentId>{21}, service.gone.items());
}

TEST_F(DdsTransportTest, OnlyTheKilledAgentIsReportedGone) {
  options_.lease_seconds = 1.0;
  Service service(MakeDdsServiceTransport(options_).transport);
  service.endpoint->SendSession(Session(1));
  ChildProcess victim(Peer("agent", 31));
  ChildProcess survivor(Peer("agent", 32));
  ASSERT_TRUE(Eventually([&] { return service.joins.items().size() == 2; }));
  victim.End(SIGKILL);
  ASSERT_TRUE(Eventually([&] { return !service.gone.items().empty(); }));
  EXPECT_EQ(std::vector<AgentId>{31}, service.gone.items());
  survivor.End(SIGTERM);
  ASSERT_TRUE(Eventually([&] { return service.gone.items().size() == 2; }));
  EXPECT_EQ((std::vector<AgentId>{31, 32}), service.gone.items());
}

TEST_F(DdsTransportTest, AServiceThatEndsIsReportedGoneAndOneThatIsKilledLost) {
  for (const int signal : {SIGTERM, SIGKILL}) {
    options_.lease_seconds = 1.0;
    options_.session += "x";
    ChildProcess service(Peer("service", 41));
    Agent agent(MakeDdsAgentTransport(options_), 1);
    ASSERT_TRUE(Eventually([&] { return !agent.sessions.items().empty(); }));
    agent.endpoint->SendJoin(Join(41, 1));
    EXPECT_TRUE(agent.service_gone.items().empty());
    service.End(signal);
    const test::Inbox<bool>& expected = signal == SIGTERM ? agent.service_gone : agent.service_lost;
    const test::Inbox<bool>& other = signal == SIGTERM ? agent.service_lost : agent.service_gone;
    EXPECT_TRUE(Eventually([&] { return expected.items().size() == 1; })) << "signal " << signal;
    EXPECT_THAT(other.items(), testing::IsEmpty()) << "signal " << signal;
  }
}

TEST_F(DdsTransportTest, AServiceThatWasStoppedBeyondItsLeaseIsLostAndAnnouncesItselfAgain) {
  options_.lease_seconds = 0.5;
  ChildProcess service(Peer("service", 41));
  Agent agent(MakeDdsAgentTransport(options_), 1);
  ASSERT_TRUE(Eventually([&] { return agent.sessions.items().size() == 1; }));
  agent.endpoint->SendJoin(Join(41, 1));
  service.Signal(SIGSTOP);
  ASSERT_TRUE(Eventually([&] { return agent.service_lost.items().size() == 1; }));
  service.Signal(SIGCONT);
  EXPECT_TRUE(Eventually([&] { return agent.sessions.items().size() == 2; }));
  EXPECT_THAT(agent.service_gone.items(), testing::IsEmpty());
}

TEST_F(DdsTransportTest, TheEndOfAnEarlierServiceDoesNotAffectTheNextRun) {
  const auto old_transport = MakeDdsServiceTransport(options_).transport;
  auto old_end = old_transport->MakeServiceEndpoint();
  old_end->SendSession(Session(1));
  Agent agent(MakeDdsAgentTransport(options_), 1);
  ASSERT_TRUE(Eventually([&] { return agent.sessions.items().size() == 1; }));
  const auto new_transport = MakeDdsServiceTransport(options_).transport;
  auto new_end = new_transport->MakeServiceEndpoint();
  new_end->SendSession(Session(2));
  ASSERT_TRUE(Eventually([&] { return agent.sessions.items().size() == 2; }));
  agent.endpoint->SendJoin(Join(2, 1));
  old_end.reset();
  new_end->SendAdmissions({{2, 1, true, ""}});
  ASSERT_TRUE(Eventually([&] { return !agent.admissions.items().empty(); }));
  EXPECT_TRUE(agent.service_gone.items().empty());
  new_end.reset();
  EXPECT_TRUE(Eventually([&] { return agent.service_gone.items().size() == 1; }));
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
  Agent agent(MakeDdsAgentTransport(agent_options), 1);
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
  EXPECT_TRUE(agent.frames.items().empty());
  frame.state.robots.x = {0, 0, nullptr, false};
  ASSERT_TRUE(Eventually([&] {
    writer.write(frame);
    return !agent.frames.items().empty();
  }));
}

TEST_F(DdsTransportTest, AnAgentMakesItsEndpointsOfTheNetworkAgainAfterAFailure) {
  options_.data_sharing = false;
  Service service(MakeServiceTransport());
  service.endpoint->SendSession(Session(5));

  std::atomic<int> failures = 0;
  const dds::DdsConnection connection(
      dds::ToolConfig(options_.domain, "lo", "127.0.0.1:" + std::to_string(port_)), options_.session,
      [&](const std::string&) { ++failures; }, {}, AgentName({"r1"}));
  // As long as the participant has this topic with other QoS, there can be no writer of proposals.
  auto other = std::make_unique<dds::Entity>(
      dds_create_topic(connection.participant.handle(), dds::TopicTraits<troupe_wire_Proposal>::descriptor(),
                       topics::kProposal, dds::qos_profiles::Description().get(), nullptr));
  test::CollectingAgent agent;
  dds::DdsAgentEndpoint agent_end(connection, std::nullopt, true);
  agent_end.Start(agent);
  ASSERT_TRUE(Eventually([&] { return failures > 0; }));
  other.reset();
  FrameMessage frame;
  frame.run = 5;
  EXPECT_TRUE(Eventually([&] {
    service.endpoint->SendFrame(frame);
    return !agent.frames.items().empty();
  }));
  ProposalMessage proposal{.run = 5, .agent = 1};
  EXPECT_TRUE(Eventually([&] {
    agent_end.SendJoin(Join(5, 1));
    agent_end.SendProposal(proposal);
    return !service.proposals.items().empty();
  }));
}

TEST_F(DdsTransportTest, WorldsOfAnySizeReachTheAgents) {
  SessionMessage session = Session(5);
  WorldDescription world;
  world.shapes.resize(1);
  for (int i = 0; i < 600'000; ++i) {
    const double x = i % 1'000;
    const double y = i / 1'000;
    world.shapes[0].rectangles.push_back({x, y, x + 0.5, y + 0.5});
  }
  session.world = world;
  ASSERT_GT(wire::ToBytes(session).size(), 16'000'000u);
  options_.session_bytes = SessionBytes(world);
  const auto service_transport = MakeServiceTransport();
  const auto service_end = service_transport->MakeServiceEndpoint();
  service_end->SendSession(session);
  Agent agent(MakeDdsAgentTransport(AgentOptions()), 11);
  ASSERT_TRUE(Eventually([&] { return agent.sessions.items().size() == 1; }));
  EXPECT_EQ(agent.sessions.items()[0].world->shapes, world.shapes);
}

TEST_F(DdsTransportTest, TheBytesOfASessionAreAboutThoseOfItsWorld) {
  RobotDescription robot{.name = "r"};
  robot.sensors.push_back({.name = "ranger", .parameters = RangerParameters{std::vector<RaySensorDescription>(12)}});
  WorldDescription swarm;
  swarm.robots.assign(1'000, robot);
  swarm.models.resize(2'000);
  WorldDescription map;
  map.shapes.resize(1);
  map.shapes[0].rectangles.resize(100'000);
  for (const WorldDescription& world : {swarm, map}) {
    SessionMessage session = Session(5);
    session.world = world;
    const std::size_t bytes = wire::ToBytes(session).size();
    EXPECT_GE(SessionBytes(world), bytes);
    EXPECT_LE(SessionBytes(world), 16'000'000 + 20 * bytes);
  }
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
  Service service(MakeServiceTransport());
  service.endpoint->SendSession(Session(1));
  const auto agent_transport = MakeDdsAgentTransport(AgentOptions());
  test::CollectingAgent agent;
  const auto agent_end = agent_transport->MakeAgentEndpoint(1);
  agent.on_session = [&](const SessionMessage& session) { agent_end->SendJoin(Join(session.run, 1)); };
  agent_end->Start(agent);
  FrameMessage frame;
  ASSERT_TRUE(Eventually([&] {
    service.endpoint->SendFrame(frame);
    return !agent.frames.items().empty();
  }));
  frame.last = true;
  service.endpoint->SendFrame(frame);
  service.endpoint->Flush(10.0);
  EXPECT_TRUE(agent.frames.items().back().last);
}

}  // namespace
}  // namespace troupe
