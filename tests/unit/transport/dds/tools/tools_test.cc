#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "tests/contract/transport_case.h"
#include "tests/support/dds_domain.h"
#include "tests/unit/transport/dds/transport/child_process.h"
#include "transport/dds/binding/data_reader.h"
#include "transport/dds/binding/data_writer.h"
#include "transport/dds/convert/convert.h"
#include "transport/dds/tools/control_client.h"
#include "transport/dds/tools/session_monitor.h"
#include "transport/dds/transport/dds_service_endpoint.h"
#include "transport/dds/transport/dds_transport.h"
#include "transport/dds/transport/qos_profiles.h"
#include "transport/protocol/messages.h"

namespace troupe {
namespace {

// ControlClient, with a world service of this process.

using test::TestConfig;
using test::TestDomain;
using test::TestSession;

// Replies to each request but steps, from the thread that has received it.
class ReplyingService : public ServiceHandler {
 public:
  explicit ReplyingService(const std::string& session) : connection_(Config(), session, {}) {
    endpoint_.emplace(std::vector<const dds::DdsConnection*>{&connection_}, false);
    endpoint_->Start(*this);
  }
  ~ReplyingService() override { endpoint_.reset(); }

  void OnJoin(const JoinMessage&) override {}
  void OnProposal(const ProposalMessage&) override {}
  void OnAgentGone(AgentId) override {}
  void OnRivalService(const SessionMessage&) override {}
  void OnControl(const ControlRequest& request) override {
    if (control::Is<control::Step>(request.request)) {
      is_stepping_ = true;
      is_stepping_.notify_all();
      return;
    }
    ControlReply reply{.client = request.client, .number = request.number, .done = true};
    endpoint_->SendControlReply(reply);
    if (!control::Is<control::Play>(request.request)) return;
    has_replied_ = true;
    has_replied_.notify_all();
  }

  void AwaitStep() { is_stepping_.wait(false); }
  void AwaitReply() {
    has_replied_.wait(false);
    endpoint_->Flush(20.0);
  }

 private:
  static dds::DomainConfig Config() {
    dds::DomainConfig config = TestConfig();
    config.heartbeat_seconds = 0.1;  // the service ends when its reply is acknowledged
    return config;
  }

  dds::DdsConnection connection_;
  std::optional<dds::DdsServiceEndpoint> endpoint_;
  std::atomic<bool> is_stepping_ = false;
  std::atomic<bool> has_replied_ = false;
};

NetworkSettings Network(const std::string& session) {
  NetworkSettings network{.domain = TestDomain(), .session = session, .security = kSecurityOff};
  return network;
}

TEST(ControlClient, TakesTheReplyOfAServiceThatEndsRightAfterIt) {
  for (int trial = 0; trial < 20; ++trial) {
    const std::string session = TestSession("ends-" + std::to_string(trial));
    std::optional<ReplyingService> service(session);
    ControlClient client(Network(session));
    ASSERT_TRUE(client.WaitForService(20.0).ok());
    std::thread end([&] {
      service->AwaitReply();
      service.reset();
    });
    const Result<ControlReply> reply = client.Call(control::Play(), 20.0);
    end.join();
    ASSERT_TRUE(reply.ok()) << "trial " << trial << ": " << reply.error().message;
    EXPECT_TRUE(reply.value().done);
  }
}

TEST(ControlClient, ReportsThatAServiceEndsWithoutAReply) {
  const std::string session = TestSession("silent");
  std::optional<ReplyingService> service(session);
  ControlClient client(Network(session));
  ASSERT_TRUE(client.WaitForService(20.0).ok());
  service.reset();
  const Result<ControlReply> reply = client.Call(control::GetStatus(), 20.0);
  ASSERT_FALSE(reply.ok());
  EXPECT_EQ(reply.error().message, "the world service of session '" + session + "' is gone");
}

// A tool without a limit of time would wait for ever: the request is lost with the service.
TEST(ControlClient, ReportsThatAServiceEndsWithoutAReplyWhenAnotherOneContinuesTheRun) {
  const std::string session = TestSession("successor");
  std::optional<ReplyingService> service(session);
  ControlClient client(Network(session));
  ASSERT_TRUE(client.WaitForService(20.0).ok());
  std::optional<ReplyingService> successor;
  std::thread end([&] {
    service->AwaitStep();
    successor.emplace(session);
    service.reset();
  });
  const Result<ControlReply> reply = client.Call(control::Step{.ticks = 1}, 20.0);
  end.join();
  ASSERT_FALSE(reply.ok());
  EXPECT_EQ(reply.error().message, "the world service of session '" + session + "' is gone");
  EXPECT_TRUE(client.WaitForService(20.0).ok());
  EXPECT_TRUE(client.Call(control::GetStatus(), 20.0).ok());
}

using test::Eventually;

struct RunningService {
  std::unique_ptr<Transport> transport;
  std::unique_ptr<ServiceEndpoint> endpoint;
  StatusMessage status;
};

TEST(SessionMonitorTest, ListsTheSessionsOfADomainWithTheirStatus) {
  DdsOptions options;
  options.domain = test::TestDomain();
  const std::string prefix = test::TestSession("monitor");
  SessionMonitor monitor(options);
  std::map<std::string, RunningService> services;
  // Sessions of other tests may exist.
  std::vector<SessionInfo> seen;
  const auto sees = [&](std::size_t count) {
    return Eventually([&] {
      // Again and again, as a run does: a status that arrives before its session is ignored.
      for (const auto& [name, service] : services) service.endpoint->SendStatus(service.status);
      monitor.WaitForChange(0.1);
      seen = monitor.Sessions();
      seen.erase(std::remove_if(seen.begin(), seen.end(),
                                [&](const SessionInfo& info) { return info.session.rfind(prefix, 0) != 0; }),
                 seen.end());
      return seen.size() == count &&
             std::all_of(seen.begin(), seen.end(), [](const SessionInfo& info) { return info.status.has_value(); });
    });
  };
  const auto start = [&](const std::string& name, RunId run) {
    options.session = prefix + name;
    RunningService& service = services[name];
    service.transport = MakeDdsServiceTransport(options).transport;
    service.endpoint = service.transport->MakeServiceEndpoint();
    SessionMessage session{.run = run, .host = "machine", .pid = 77};
    session.world.Change().name = "world of " + name;
    service.endpoint->SendSession(session);
    service.status.run = run;
    service.status.tick = 10 * run;
  };
  start("b", 1);
  start("a", 2);
  ASSERT_TRUE(sees(2));
  EXPECT_EQ(prefix + "a", seen[0].session);
  EXPECT_EQ(2u, seen[0].run);
  EXPECT_EQ("machine", seen[0].host);
  EXPECT_EQ(77u, seen[0].pid);
  EXPECT_EQ("world of a", seen[0].world);
  EXPECT_EQ(20u, seen[0].status->tick);
  EXPECT_EQ(prefix + "b", seen[1].session);

  services["a"].status.tick = 21;
  services["a"].status.waiting_for = {"r7"};
  EXPECT_TRUE(Eventually([&] { return sees(2) && seen[0].status->tick == 21; }));
  EXPECT_EQ(std::vector<std::string>{"r7"}, seen[0].status->waiting_for);

  services.erase("a");
  ASSERT_TRUE(sees(1));
  EXPECT_EQ(prefix + "b", seen[0].session);
}

// Observers over DDS: the conversation on the wire, and processes that are killed.

using test::ChildProcess;

constexpr double kPatience = 20.0;  // s

FrameMessage FrameOf(Tick tick) {
  FrameMessage frame;
  frame.run = 1;
  frame.state.tick = tick;
  frame.state.robots.resize(3);
  frame.state.robots[1].X_WR.x = 0.1 * static_cast<double>(tick);
  return frame;
}

SessionMessage SomeSession(Edition world_edition) {
  SessionMessage session;
  session.run = 1;
  session.world.Change().name = "a world";
  session.world_edition = world_edition;
  return session;
}

class DdsObserverTest : public testing::Test {
 protected:
  DdsObserverTest() {
    options_.domain = test::TestDomain();
    options_.session = test::TestSession(testing::UnitTest::GetInstance()->current_test_info()->name());
  }
  DdsOptions options_;
};

// A service that sends exactly the messages of a test.
class ScriptedService {
 public:
  explicit ScriptedService(const std::string& session)
      : participant_(test::TestConfig()),
        publisher_(participant_, dds::qos_profiles::Session(session)),
        subscriber_(participant_, dds::qos_profiles::Session(session)) {}

  void SendSession(const SessionMessage& session) {
    dds::WireArena arena;
    sessions_.write(dds::ToWire(session, arena));
  }
  void SendWhole(const FrameMessage& frame) {
    dds::WireArena arena;
    whole_frames_.write(dds::ToWire(frame, arena));
  }
  void SendChanges(Tick tick) {
    dds::WireArena arena;
    const FrameMessage before = FrameOf(tick - 1);
    frames_.write(dds::ToWire(FrameOf(tick), &before.state, arena));
  }
  std::size_t ReadRequests() {
    std::size_t count = 0;
    for (const auto sample : requests_.take()) count += sample.info().valid() ? 1 : 0;
    return count;
  }
  bool IsFound() const {
    return whole_frames_.publication_matched_status().current_count > 0 &&
           frames_.publication_matched_status().current_count > 0;
  }

 private:
  dds::DomainParticipant participant_;
  dds::Publisher publisher_;
  dds::Subscriber subscriber_;
  dds::Topic<troupe_wire_Session> session_topic_{participant_, topics::kSession};
  dds::Topic<troupe_wire_Frame> frame_topic_{participant_, topics::kFrame};
  dds::Topic<troupe_wire_Frame> whole_frame_topic_{participant_, topics::kWholeFrame};
  dds::Topic<troupe_wire_FrameRequest> request_topic_{participant_, topics::kFrameRequest};
  dds::DataWriter<troupe_wire_Session> sessions_{publisher_, session_topic_, dds::qos_profiles::Description(2.0)};
  dds::DataWriter<troupe_wire_Frame> frames_{publisher_, frame_topic_, dds::qos_profiles::Frame()};
  dds::DataWriter<troupe_wire_Frame> whole_frames_{publisher_, whole_frame_topic_, dds::qos_profiles::WholeFrame()};
  dds::DataReader<troupe_wire_FrameRequest> requests_{subscriber_, request_topic_, dds::qos_profiles::FrameRequest()};
};

class Observer {
 public:
  explicit Observer(const DdsOptions& options)
      : transport_(MakeDdsObserverTransport(options)), endpoint_(transport_->MakeObserverEndpoint()) {
    endpoint_->Start(handler);
  }
  bool Sees(Tick tick) const {
    return handler.frames.WaitFor(kPatience,
                                  [tick](const FrameMessage& frame) { return frame.state == FrameOf(tick).state; });
  }
  std::vector<Tick> SeenTicks() const {
    std::vector<Tick> ticks;
    for (const FrameMessage& frame : handler.frames.items()) ticks.push_back(frame.state.tick);
    return ticks;
  }

  test::CollectingObserver handler;

 private:
  std::unique_ptr<Transport> transport_;
  std::unique_ptr<ObserverEndpoint> endpoint_;
};

TEST_F(DdsObserverTest, AGapIsClosedByAWholeFrameOnRequest) {
  ScriptedService service(options_.session);
  const Observer observer(options_);
  service.SendSession(SomeSession(0));
  ASSERT_TRUE(observer.handler.sessions.WaitFor(kPatience, [](const SessionMessage&) { return true; }));
  ASSERT_TRUE(Eventually([&] { return service.IsFound(); }));
  // It joins: it resends its request until it is answered.
  ASSERT_TRUE(Eventually([&] { return service.ReadRequests() > 0; }));
  service.SendWhole(FrameOf(1));
  ASSERT_TRUE(observer.Sees(1));
  service.SendChanges(2);
  ASSERT_TRUE(observer.Sees(2));
  service.ReadRequests();
  // The frame of tick 3 is lost.
  service.SendChanges(4);
  ASSERT_TRUE(Eventually([&] { return service.ReadRequests() > 0; }));
  service.SendChanges(5);
  service.SendWhole(FrameOf(5));
  ASSERT_TRUE(observer.Sees(5));
  service.SendChanges(6);
  ASSERT_TRUE(observer.Sees(6));
  EXPECT_EQ(observer.SeenTicks(), (std::vector<Tick>{1, 2, 5, 6}));
}

TEST_F(DdsObserverTest, AFrameWaitsForTheWorldThatItBelongsTo) {
  ScriptedService service(options_.session);
  const Observer observer(options_);
  service.SendSession(SomeSession(0));
  ASSERT_TRUE(observer.handler.sessions.WaitFor(kPatience, [](const SessionMessage&) { return true; }));
  ASSERT_TRUE(Eventually([&] { return service.IsFound(); }));
  service.SendWhole(FrameOf(1));
  ASSERT_TRUE(observer.Sees(1));
  FrameMessage edited = FrameOf(2);
  edited.world_edition = 7;
  edited.edition = 7;
  service.SendWhole(edited);
  EXPECT_FALSE(observer.handler.frames.WaitFor(0.1, [](const FrameMessage& frame) { return frame.edition == 7; }));
  service.SendSession(SomeSession(7));
  EXPECT_TRUE(observer.handler.frames.WaitFor(kPatience, [](const FrameMessage& frame) { return frame.edition == 7; }));
}

TEST_F(DdsObserverTest, AKilledObserverDelaysNoTick) {
  // Its first request shows that the process has joined.
  const dds::DomainParticipant participant(test::TestConfig());
  const dds::Subscriber subscriber(participant, dds::qos_profiles::Session(options_.session));
  const dds::Topic<troupe_wire_FrameRequest> topic(participant, topics::kFrameRequest);
  dds::DataReader<troupe_wire_FrameRequest> requests(subscriber, topic, dds::qos_profiles::FrameRequest());

  const auto transport = MakeDdsServiceTransport(options_).transport;
  test::CollectingService service;
  const auto service_end = transport->MakeServiceEndpoint();
  service_end->Start(service);
  service_end->SendSession(SomeSession(0));
  ChildProcess killed({TROUPE_TEST_PEER, "observer", std::to_string(options_.domain), options_.session, "1", "10"});
  const Observer survivor(options_);
  ASSERT_TRUE(survivor.handler.sessions.WaitFor(kPatience, [](const SessionMessage&) { return true; }));
  std::set<std::uint64_t> requesting;
  ASSERT_TRUE(Eventually([&] {
    for (const auto sample : requests.take()) {
      if (sample.info().valid()) requesting.insert(sample.data().observer);
    }
    return requesting.size() == 2;
  }));
  service_end->SendFrame(FrameOf(1));
  ASSERT_TRUE(survivor.Sees(1));
  killed.End(SIGKILL);
  // Long before its lease ends: a write that waits for room takes half a second.
  const auto start = std::chrono::steady_clock::now();
  for (Tick tick = 2; tick <= 500; ++tick) service_end->SendFrame(FrameOf(tick));
  EXPECT_LT(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(), 5.0);
  EXPECT_TRUE(survivor.Sees(500));
}

}  // namespace
}  // namespace troupe
