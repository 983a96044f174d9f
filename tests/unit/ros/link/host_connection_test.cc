// Either side of a connection to the participant of a host may end, or send nonsense.
#include "ros/link/host_connection.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <ctime>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "common/base/identity.h"
#include "ros/connection/ros_endpoints.h"
#include "ros/connection/ros_participant.h"
#include "ros/connection/topic_types.h"
#include "ros/link/link.h"
#include "tests/support/dds_domain.h"
#include "tests/support/host_participant.h"
#include "tests/support/ros_client.h"
#include "tests/support/ros_domain.h"
#include "tests/support/ros_graph.h"
#include "transport/dds/binding/data_writer.h"
#include "transport/dds/binding/domain_participant.h"
#include "transport/dds/binding/wire.h"
#include "transport/wire/cdr.h"

namespace troupe::ros {
namespace {

using test::Eventually;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

std::span<const std::byte> BytesOf(std::string_view text) {
  return std::as_bytes(std::span(text));
}

class HostConnectionTest : public testing::Test {
 protected:
  std::unique_ptr<HostConnection> Connect() const { return host_.Connect(); }
  // A connection of a program that may send anything.
  std::unique_ptr<Link> Stranger() const {
    const Result<int> connected = ros::Connect(host_.socket());
    return std::make_unique<Link>(connected.value());
  }
  std::string Hello() const { return ToText(HelloText{VersionText(), network_.domain}); }
  // Whether the other side ends the connection.
  static bool IsEnded(Link& link) {
    return Eventually([&link] { return !link.Receive([](const LinkMessage&) {}); });
  }
  template <typename T>
  RosReader<T> Reader(const std::string& topic, const TopicQos& qos) {
    return RosReader<T>(peer_, topic, qos);
  }

  const RosNetwork network_ = test::TestRosNetwork();
  RosParticipant participant_{network_};
  RosNode peer_ = MakeNode(participant_, "/", "peer");
  test::HostParticipant host_{network_};
};

// The newest text of a reader, when there is one.
std::string Next(RosReader<String>& reader) {
  std::string text;
  EXPECT_TRUE(Eventually([&] {
    reader.Drain([&](const String& message) { text = dds::Text(message.data); });
    return !text.empty();
  }));
  return text;
}

void Write(RosWriter<String>& writer, const std::string& text) {
  dds::WireArena arena;
  writer.Write({arena.Copy(text)});
}

TEST_F(HostConnectionTest, EndpointsThatAreOlderThanTheParticipantAreMadeThere) {
  host_.End();
  const std::unique_ptr<HostConnection> connection = Connect();
  const RosNode node = MakeNode(*connection, "/a", "robot");
  RosWriter<String> writer(node, "description", Latched());
  Write(writer, "early");
  connection->Announce();
  EXPECT_FALSE(writer.wanted());
  host_.Start();
  RosReader<String> reader = Reader<String>("/a/description", Latched());
  EXPECT_EQ(Next(reader), "early");
  EXPECT_TRUE(Eventually([&] { return writer.wanted(); }));
}

TEST_F(HostConnectionTest, EndpointsReturnWithANewParticipant) {
  const std::unique_ptr<HostConnection> connection = Connect();
  const RosNode node = MakeNode(*connection, "/a", "robot");
  RosWriter<String> latched(node, "description", Latched());
  RosWriter<String> stream(node, "events", Stream(10));
  RosReader<Float64> commands(node, "command", Commands(true));
  connection->Announce();
  Write(latched, "first");
  Write(latched, "second");
  connection->Flush();
  test::RosGraph graph(network_);
  EXPECT_TRUE(Eventually([&] { return graph.HasNode("/a/robot"); }));
  RosReader<String> events = Reader<String>("/a/events", Stream(10));
  EXPECT_TRUE(Eventually([&] { return stream.wanted(); }));
  const auto before = std::chrono::steady_clock::now();

  host_.End();
  EXPECT_TRUE(Eventually([&] { return !stream.wanted(); }));
  EXPECT_TRUE(Eventually([&] { return !graph.HasNode("/a/robot"); }));
  Write(stream, "lost");
  host_.Start();
  EXPECT_TRUE(Eventually([&] { return stream.wanted(); }));
  connection->AddressReadersSince(before);
  EXPECT_TRUE(stream.is_addressed()) << "the robot's topics are repeated in a pause";
  EXPECT_TRUE(Eventually([&] { return graph.HasNode("/a/robot"); }));
  Write(stream, "kept");
  connection->Flush();
  EXPECT_EQ(Next(events), "kept");
  RosReader<String> late = Reader<String>("/a/description", Latched());
  EXPECT_EQ(Next(late), "second");

  RosWriter<Float64> commander(peer_, "/a/command", Stream(1));
  EXPECT_TRUE(Eventually([&] { return commander.wanted(); }));
  commander.Write({0.5});
  double commanded = 0.0;
  EXPECT_TRUE(Eventually([&] {
    connection->Receive();
    commands.Drain([&](const Float64& message) { commanded = message.data; });
    return commanded != 0.0;
  }));
  EXPECT_EQ(commanded, 0.5);
}

TEST_F(HostConnectionTest, TheNodesOfAnAgentEndWithIt) {
  test::RosGraph graph(network_);
  const std::unique_ptr<HostConnection> stays = Connect();
  const RosNode node = MakeNode(*stays, "/a", "robot");
  RosWriter<String> writer(node, "events", Stream(10));
  stays->Announce();
  std::unique_ptr<HostConnection> leaves = Connect();
  auto of_other = std::make_unique<RosWriter<String>>(MakeNode(*leaves, "/b", "robot"), "events", Stream(10));
  leaves->Announce();
  RosReader<String> events = Reader<String>("/b/events", Stream(10));
  EXPECT_TRUE(Eventually([&] { return graph.HasNode("/a/robot") && graph.HasNode("/b/robot"); }));
  EXPECT_TRUE(Eventually([&] { return of_other->wanted(); }));
  of_other.reset();
  leaves.reset();
  EXPECT_TRUE(Eventually([&] { return !graph.HasNode("/b/robot"); }));
  EXPECT_TRUE(graph.HasNode("/a/robot"));
}

// A domain of a robot's own.
TEST_F(HostConnectionTest, EachDomainHasAParticipantWhileItIsUsed) {
  RosNetwork other = network_;
  other.domain = test::ReserveDomain();
  test::RosGraph graph(other);
  auto connection = std::make_unique<HostConnection>(network_.distribution, host_.socket(), other.domain,
                                                     HostConnection::Sending::kAtOnce);
  auto writer = std::make_unique<RosWriter<String>>(MakeNode(*connection, "/", "robot"), "text", Latched());
  connection->Announce();
  EXPECT_TRUE(Eventually([&] { return graph.HasNode("/robot"); }));
  EXPECT_EQ(graph.Participants(), 1u);
  RosParticipant there(other);
  RosReader<String> reader(MakeNode(there, "/", "peer"), "/text", Latched());
  Write(*writer, "sent without a flush");
  EXPECT_EQ(Next(reader), "sent without a flush");
  writer.reset();
  connection.reset();
  EXPECT_TRUE(Eventually([&] { return graph.Participants() == 1u; })) << "the peer of this test";
  EXPECT_FALSE(graph.HasNode("/robot"));
}

TEST_F(HostConnectionTest, AReaderTellsOfItsSamples) {
  const std::unique_ptr<HostConnection> connection = Connect();
  std::atomic<int> arrived = 0;
  RosReader<Float64> commands(MakeNode(*connection, "/a", "robot"), "command", Commands(true), Part::kOnlyReader,
                              [&] { ++arrived; });
  connection->Announce();
  RosWriter<Float64> commander(peer_, "/a/command", Stream(1));
  EXPECT_TRUE(Eventually([&] { return commander.wanted(); }));
  commander.Write({0.5});
  EXPECT_TRUE(Eventually([&] { return arrived > 0; }));
}

TEST_F(HostConnectionTest, AReaderIsMadeAndRemovedWhileNothingElseIsSent) {
  HostConnection connection(network_.distribution, host_.socket(), network_.domain, HostConnection::Sending::kAtOnce);
  const RosNode node = MakeNode(connection, "/a", "robot");
  const RosReader<Float64> first(node, "first", Commands(true));
  connection.Announce();
  const RosWriter<Float64> of_first(peer_, "/a/first", Stream(1));
  EXPECT_TRUE(Eventually([&] { return of_first.wanted(); }));
  std::optional<RosReader<Float64>> late(std::in_place, node, "late", Commands(true));
  const RosWriter<Float64> of_late(peer_, "/a/late", Stream(1));
  EXPECT_TRUE(Eventually([&] { return of_late.wanted(); }));
  late.reset();
  EXPECT_TRUE(Eventually([&] { return !of_late.wanted(); }));
}

TEST_F(HostConnectionTest, AnEndpointThatEndsIsListedNoMore) {
  test::RosGraph graph(network_);
  const std::unique_ptr<HostConnection> connection = Connect();
  const RosNode node = MakeNode(*connection, "/a", "robot");
  const RosWriter<String> stays(node, "stays", Stream(1));
  auto leaves = std::make_unique<RosWriter<String>>(node, "leaves", Stream(1));
  connection->Announce();
  EXPECT_TRUE(Eventually([&] { return graph.WritersOf("/a/robot") == 2u; }));
  leaves.reset();
  connection->Announce();
  EXPECT_TRUE(Eventually([&] { return graph.WritersOf("/a/robot") == 1u; }));
}

// As an image of a large camera, in many parts.
TEST_F(HostConnectionTest, PassesLargeSamplesOn) {
  const std::unique_ptr<HostConnection> connection = Connect();
  RosWriter<String> writer(MakeNode(*connection, "/a", "robot"), "events", Stream(2));
  connection->Announce();
  RosReader<String> reader = Reader<String>("/a/events", Stream(2));
  ASSERT_TRUE(Eventually([&] { return writer.wanted(); }));
  const std::string large(std::size_t{4} << 20, 'x');
  Write(writer, large);
  connection->Flush();
  EXPECT_EQ(Next(reader), large);
}

// A stream keeps its newest sample meanwhile, and the connection waits without use of the processor.
TEST_F(HostConnectionTest, AParticipantThatHangsGetsTheNewestSampleLater) {
  host_.End();
  const Result<int> listening = Bind(host_.socket());
  ASSERT_TRUE(listening.ok());
  ASSERT_EQ(listen(listening.value(), 1), 0);
  const std::unique_ptr<HostConnection> connection = Connect();
  RosWriter<String> writer(MakeNode(*connection, "/a", "robot"), "events", Stream(2));
  int accepted = -1;
  ASSERT_TRUE(Eventually([&] { return (accepted = Accept(listening.value())) >= 0; }));
  // Samples count from the connection's first message on.
  pollfd greeted = {accepted, POLLIN, 0};
  ASSERT_EQ(poll(&greeted, 1, 10'000), 1);
  const std::string large(std::size_t{1} << 20, 'x');
  constexpr int kSamples = 100;
  for (int i = 1; i <= kSamples; ++i) {
    Write(writer, std::to_string(i) + large);
    connection->Flush();
  }
  EXPECT_GT(connection->lost(), 90u);
  EXPECT_LT(connection->lost(), 100u);
  const std::clock_t used = std::clock();
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  EXPECT_LT(std::clock() - used, CLOCKS_PER_SEC / 10);

  Link participant(accepted);
  std::vector<int> numbers;
  EXPECT_TRUE(Eventually([&] {
    participant.Receive([&](const LinkMessage& message) {
      if (message.kind != LinkKind::kWrite) return;
      const Result<wire::Sample<String>> sample = wire::FromCdr<String>(message.content);
      numbers.push_back(std::atoi(sample.value().data().data));
    });
    return !numbers.empty() && numbers.back() == kSamples;
  }));
  EXPECT_TRUE(std::is_sorted(numbers.begin(), numbers.end()));
  EXPECT_EQ(numbers.size() + connection->lost(), 100u);
  close(listening.value());
}

// A reset: the agent's robots are made anew, and their endpoints are used again.
TEST_F(HostConnectionTest, LateReadersGetNoSampleOfAnAgentThatHasEnded) {
  std::unique_ptr<HostConnection> connection = Connect();
  auto writer = std::make_unique<RosWriter<String>>(MakeNode(*connection, "/a", "robot"), "status", Latched());
  connection->Announce();
  Write(*writer, "old");
  connection->Flush();
  RosReader<String> early = Reader<String>("/a/status", Latched());
  EXPECT_EQ(Next(early), "old");
  writer.reset();
  connection.reset();
  const auto before = std::chrono::steady_clock::now();
  connection = Connect();
  connection->AddressReadersSince(before);
  writer = std::make_unique<RosWriter<String>>(MakeNode(*connection, "/a", "robot"), "status", Latched());
  connection->Announce();
  EXPECT_TRUE(Eventually([&] { return writer->wanted(); })) << "the early reader still matches";
  EXPECT_FALSE(writer->is_addressed()) << "it has the samples of a pause";
  RosReader<String> late = Reader<String>("/a/status", Latched());
  EXPECT_TRUE(Eventually([&] { return writer->is_addressed(); }));
  Write(*writer, "new");
  connection->Flush();
  std::vector<std::string> texts;
  EXPECT_TRUE(Eventually([&] {
    late.Drain([&](const String& message) { texts.emplace_back(dds::Text(message.data)); });
    return !texts.empty() && texts.back() == "new";
  }));
  EXPECT_EQ(texts, std::vector<std::string>{"new"});
}

TEST_F(HostConnectionTest, ACallDuringAResetIsAnswered) {
  using Request = simulation_interfaces_srv_dds__GetSimulationState_Request_;
  using Response = simulation_interfaces_srv_dds__GetSimulationState_Response_;
  struct Server {
    explicit Server(std::unique_ptr<HostConnection> to) : connection(std::move(to)) { connection->Announce(); }
    std::unique_ptr<HostConnection> connection;
    RosService<Request, Response> service{MakeNode(*connection, "/a", "robot"), "state",
                                          [this](const RosCaller& caller, const Request&) {
                                            Response response{};
                                            response.result.error_message = const_cast<char*>("");
                                            service.Respond(caller, response);
                                          },
                                          Service(), Serving::kWhenStarted};
  };
  test::RosGraph graph(network_);
  auto server = std::make_unique<Server>(Connect());
  server->service.Start();
  test::Client<Request, Response> client(participant_, "/a/state");
  client.Call({}, [](const Response&) {});
  EXPECT_TRUE(Eventually([&] { return graph.HasNode("/a/robot"); }));
  server.reset();
  EXPECT_TRUE(Eventually([&] { return !graph.HasNode("/a/robot"); }));
  client.Send({});
  server = std::make_unique<Server>(Connect());
  server->service.Start();
  EXPECT_TRUE(Eventually([&] { return client.Receive([](const Response&) {}); }));
}

// No client waits without end, and no call is executed twice unnoticed.
TEST_F(HostConnectionTest, ACallThatAnAgentHasNotAnsweredIsRepeatedForTheNextOne) {
  using Request = simulation_interfaces_srv_dds__GetSimulationState_Request_;
  using Response = simulation_interfaces_srv_dds__GetSimulationState_Response_;
  struct Server {
    explicit Server(std::unique_ptr<HostConnection> to) : connection(std::move(to)) {
      connection->Announce();
      service.Start();
    }
    std::unique_ptr<HostConnection> connection;
    std::atomic<bool> answers = true;
    std::atomic<int> calls = 0;
    std::atomic<int> repeats = 0;
    RosService<Request, Response> service{MakeNode(*connection, "/a", "robot"), "state",
                                          [this](const RosCaller& caller, const Request&) {
                                            ++(caller.is_repeated ? repeats : calls);
                                            if (!answers) return;
                                            Response response{};
                                            response.result.error_message = const_cast<char*>("");
                                            service.Respond(caller, response);
                                          },
                                          Service(), Serving::kWhenStarted};
  };
  auto server = std::make_unique<Server>(Connect());
  test::Client<Request, Response> client(participant_, "/a/state");
  client.Call({}, [](const Response&) {});
  server->answers = false;
  client.Send({});
  EXPECT_TRUE(Eventually([&] { return server->calls == 2; }));
  server.reset();
  server = std::make_unique<Server>(Connect());
  EXPECT_TRUE(Eventually([&] { return client.Receive([](const Response&) {}); }));
  EXPECT_EQ(server->repeats, 1) << "not the one that was answered";
  EXPECT_EQ(server->calls, 0);
}

TEST_F(HostConnectionTest, APublisherOfAnotherTypeIsReportedToAnAgentThatComesLater) {
  const auto mismatches_of = [](HostConnection& connection) {
    std::vector<std::string> all;
    EXPECT_TRUE(Eventually([&] {
      for (std::string& line : connection.DrainMismatches()) all.push_back(std::move(line));
      return !all.empty();
    }));
    return all;
  };
  const RosWriter<Float64> wrong_for_a(peer_, "/a/text", Stream(1));
  const RosWriter<Float64> wrong_for_b(peer_, "/b/text", Stream(1));
  const std::unique_ptr<HostConnection> a = Connect();
  const RosReader<String> reader_of_a(MakeNode(*a, "/a", "robot"), "text", Stream(1));
  a->Announce();
  EXPECT_THAT(mismatches_of(*a), ElementsAre(HasSubstr("/a/text: cannot read another program's publisher")));
  const std::unique_ptr<HostConnection> b = Connect();
  const RosReader<String> reader_of_b(MakeNode(*b, "/b", "robot"), "text", Stream(1));
  b->Announce();
  EXPECT_THAT(mismatches_of(*b), ElementsAre(HasSubstr("/b/text: cannot read another program's publisher")));
  EXPECT_THAT(a->DrainMismatches(), IsEmpty());
}

TEST_F(HostConnectionTest, ASecondRunInTheDomainIsReportedToBothOnce) {
  const test::HostParticipant other_host(network_);
  const std::unique_ptr<HostConnection> runs[] = {Connect(), other_host.Connect()};
  const std::unique_ptr<HostConnection> without_clock = Connect();
  std::vector<std::unique_ptr<RosWriter<Clock>>> clocks;
  const auto start = [&](HostConnection& connection) {
    connection.WatchDistributions();
    clocks.push_back(std::make_unique<RosWriter<Clock>>(MakeNode(connection, "/", "world"), "/clock", Stream(10)));
    connection.Announce();
  };
  start(*runs[0]);
  test::RosGraph graph(network_);
  EXPECT_TRUE(Eventually([&] { return graph.HasNode("/world"); }));
  EXPECT_THAT(runs[0]->DrainMismatches(), IsEmpty()) << "its own clock";
  start(*runs[1]);
  for (const auto& run : runs) {
    std::vector<std::string> reports;
    EXPECT_TRUE(Eventually([&] {
      for (std::string& line : run->DrainMismatches()) reports.push_back(std::move(line));
      return !reports.empty();
    }));
    EXPECT_THAT(reports, ElementsAre(HasSubstr("another program in the ROS domain writes /clock")));
  }
  EXPECT_THAT(without_clock->DrainMismatches(), IsEmpty());
}

TEST_F(HostConnectionTest, AStrangerIsRefusedAndTheOthersGoOn) {
  const std::unique_ptr<HostConnection> connection = Connect();
  RosWriter<String> writer(MakeNode(*connection, "/a", "robot"), "events", Stream(10));
  connection->Announce();
  RosReader<String> events = Reader<String>("/a/events", Stream(10));
  ASSERT_TRUE(Eventually([&] { return writer.wanted(); }));

  using Messages = std::vector<std::pair<LinkKind, std::string>>;
  const std::pair<LinkKind, std::string> hello = {LinkKind::kHello, Hello()};
  const auto make = [](const MadeText& made) { return std::pair(LinkKind::kMake, ToText(made)); };
  const std::pair<LinkKind, std::string> node = make({.kind = MadeKind::kNode, .name = "/b/robot"});
  const auto writer_of = [&make](const std::string& type, int depth, std::uint32_t of = kNothing) {
    return make({.kind = MadeKind::kWriter, .node = of, .name = "rt/b", .type = type, .qos = {{}, depth}});
  };
  const std::string string = "std_msgs::msg::dds_::String_";
  const std::string outside = R"({"kind": 6, "name": "rt/b"})";
  const std::string too_large = R"({"kind": 256, "name": "/b/robot"})";
  const std::pair<Messages, std::string> refused[] = {
      {{{LinkKind::kHello, ToText(HelloText{"troupe 0.0.1", 0})}}, "found version 'troupe 0.0.1', expected"},
      {{node}, "found no version"},
      {{hello, hello}, "found no version, or two"},
      {{{LinkKind::kHello, "troupe"}}, "found 'troupe', expected a version"},
      {{hello, {LinkKind::kMake, "{"}}, "found '{', expected a version, a node, an endpoint or a watch"},
      {{hello, {LinkKind::kMake, outside}}, "expected a version, a node, an endpoint or a watch"},
      {{hello, {LinkKind::kMake, too_large}}, "expected a version, a node, an endpoint or a watch"},
      {{hello, make({.kind = MadeKind::kNode, .name = "b"})}, "found node 'b', expected"},
      {{hello, node, node}, "an id a second time"},
      {{hello, node, writer_of(string, 1)}, "an id a second time"},
      {{hello, writer_of(string, 1, 7)}, "found node 7, expected one of this agent"},
      {{hello, writer_of("Nothing", 1)}, "found type 'Nothing', expected one of ROS"},
      {{hello, writer_of(string, 0)}, "a node, an endpoint or a watch"},
      {{hello, writer_of(string, 1), {LinkKind::kWrite, "nonsense"}}, "bytes of a std_msgs"},
      {{hello, {LinkKind::kWrite, "nonsense"}}, "a sample of no writer or service"},
      {{hello, {LinkKind::kSample, ""}}, "a message for agents"},
  };
  for (const auto& [messages, problem] : refused) {
    const std::unique_ptr<Link> stranger = Stranger();
    for (const auto& [kind, text] : messages) stranger->Add(kind, 0, BytesOf(text));
    stranger->Flush();
    EXPECT_TRUE(IsEnded(*stranger)) << problem;
  }
  const std::unique_ptr<Link> garbage = Stranger();
  const std::array<std::uint32_t, 3> huge = {0xffffffff, 0, 0};
  ASSERT_EQ(send(garbage->descriptor(), huge.data(), sizeof huge, 0), sizeof huge);
  EXPECT_TRUE(IsEnded(*garbage));

  Write(writer, "still there");
  connection->Flush();
  EXPECT_EQ(Next(events), "still there");
  host_.End();
  ASSERT_EQ(host_.reports().size(), std::size(refused));
  for (std::size_t i = 0; i < std::size(refused); ++i) EXPECT_THAT(host_.reports()[i], HasSubstr(refused[i].second));
}

TEST_F(HostConnectionTest, AnAgentWaitsWhileThereAreNoDescriptors) {
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_NOFILE, &before), 0);
  const rlimit few = {std::min<rlim_t>(before.rlim_cur, 200), before.rlim_max};
  ASSERT_EQ(setrlimit(RLIMIT_NOFILE, &few), 0);
  std::vector<int> descriptors;
  for (int descriptor = 0; descriptor >= 0;) descriptors.push_back(descriptor = dup(STDERR_FILENO));
  descriptors.pop_back();
  ASSERT_FALSE(descriptors.empty());
  close(descriptors.back());  // for the agent's side
  descriptors.pop_back();
  const std::unique_ptr<Link> agent = Stranger();
  const std::clock_t used = std::clock();
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  EXPECT_LT(std::clock() - used, CLOCKS_PER_SEC / 10);
  for (const int descriptor : descriptors) close(descriptor);
  ASSERT_EQ(setrlimit(RLIMIT_NOFILE, &before), 0);
  agent->Add(LinkKind::kHello, 0, BytesOf(ToText(HelloText{"troupe 0.0.1", 0})));
  agent->Flush();
  EXPECT_TRUE(IsEnded(*agent));
  host_.End();
  EXPECT_THAT(host_.reports(), ElementsAre(HasSubstr("ulimit -n"), HasSubstr("found version 'troupe 0.0.1'")));
}

// An agent that is stopped reads nothing: its samples wait up to a limit, and those of others arrive.
TEST_F(HostConnectionTest, AnAgentThatHangsDelaysNoOther) {
  const std::unique_ptr<Link> hangs = Stranger();
  hangs->Add(LinkKind::kHello, 0, BytesOf(Hello()));
  hangs->Add(LinkKind::kMake, 0, BytesOf(ToText(MadeText{.kind = MadeKind::kNode, .name = "/b/robot"})));
  hangs->Add(LinkKind::kMake, 1,
             BytesOf(ToText(MadeText{.kind = MadeKind::kReader,
                                     .node = 0,
                                     .name = "rt/all",
                                     .type = "std_msgs::msg::dds_::String_",
                                     .qos = Commands(true)})));
  ASSERT_TRUE(hangs->Flush());
  const std::unique_ptr<HostConnection> connection = Connect();
  RosReader<String> reader(MakeNode(*connection, "/a", "robot"), "/all", Commands(true));
  connection->Announce();
  const dds::Topic<String> topic(participant_.participant(), "rt/all");
  dds::DataWriter<String> writer(participant_.publisher(), topic, ToDds(Stream(1)));
  ASSERT_TRUE(Eventually([&] { return writer.publication_matched_status().current_count == 2; }));
  const std::string large(std::size_t{1} << 20, 'x');
  for (int i = 0; i < 20; ++i) {
    dds::WireArena arena;
    writer.write({arena.Copy(large)});
    EXPECT_EQ(Next(reader), large);
  }
}

}  // namespace
}  // namespace troupe::ros
