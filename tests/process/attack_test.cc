// A program without keys attacks real runs: it forges the messages of service and agents, and floods the service.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <fstream>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/base/identity.h"
#include "tests/process/programs.h"
#include "tests/support/own_network.h"
#include "tests/support/stranger.h"
#include "transport/dds/binding/data_reader.h"
#include "transport/dds/tools/control_client.h"
#include "transport/protocol/messages.h"

namespace troupe::test {
namespace {

constexpr Tick kTicks = 30;
constexpr std::size_t kFlood = 20000;  // messages
#ifdef TROUPE_SANITIZED
constexpr double kMemoryMargin = 300.0;  // MiB: sanitizers keep freed memory
// Cyclone DDS grows the buffer of a message by small steps, each of which the address sanitizer copies.
constexpr std::size_t kLongList = 200'000;
#else
constexpr double kMemoryMargin = 40.0;  // MiB
constexpr std::size_t kLongList = 1'000'000;
#endif

// The ports of all UDP sockets of this thread's network namespace, in the form of Stranger's peers: agents listen at
// any of them.
std::vector<std::string> AllPorts(const std::string& address = "127.0.0.1") {
  std::ifstream sockets("/proc/thread-self/net/udp");
  std::string line;
  std::getline(sockets, line);  // the titles
  std::vector<std::string> peers;
  while (std::getline(sockets, line)) {
    const std::size_t colon = line.find(':', line.find(':') + 1);  // of the address
    peers.push_back(address + ":" + std::to_string(std::stoul(line.substr(colon + 1, 4), nullptr, 16)));
  }
  return peers;
}

double ResidentMemory(pid_t process) {  // MiB
  std::ifstream status("/proc/" + std::to_string(process) + "/status");
  for (std::string line; std::getline(status, line);) {
    if (line.starts_with("VmRSS:")) return std::stod(line.substr(6)) / 1024.0;
  }
  return 0.0;
}

// A run of pen.world that waits in a pause, and is controlled by its owner.
class AttackedRun {
 public:
  AttackedRun(const std::string& session, const std::string& security, const std::string& interface = "lo")
      : session_(session),
        // Frames and proposals that are shared offer no endpoint to forge them.
        run_(RunPen({"--paused", "--session", session, "--security", security, "--interface", interface,
                     "--data-sharing", "off"})),
        owner_(OwnerOf(session, interface)) {
    EXPECT_TRUE(owner_.WaitForService(kSeconds).ok()) << run_.output();
    run_.WaitForLine("ready");
  }

  const std::string& session() const { return session_; }
  std::uint64_t HashAfterSteps() {
    const Result<ControlReply> reply = owner_.Call(control::Step{.ticks = kTicks}, kSeconds);
    EXPECT_TRUE(reply.ok() && reply.value().done) << (reply.ok() ? reply.value().problem : reply.error().message);
    if (!reply.ok()) return 0;
    EXPECT_EQ(reply.value().tick, kTicks);
    return reply.value().state_hash;
  }
  double ServiceMemory() const {
    for (const pid_t child : ChildrenOf(run_.pid())) {
      if (CommandLineOf(child).find("world-service") != std::string::npos) return ResidentMemory(child);
    }
    return 0.0;
  }
  std::string Stop() {
    run_.Interrupt();
    return run_.output();
  }

 private:
  static NetworkSettings OwnerOf(const std::string& session, const std::string& interface) {
    NetworkSettings network = NetworkOf(session);
    network.network_interface = interface;
    return network;
  }

  const std::string session_;
  Program run_;
  ControlClient owner_;
};

std::uint64_t HashWithoutAttack() {
  static const std::uint64_t hash = [] {
    AttackedRun run(TestSession("peace"), "on");
    const std::uint64_t hash_after = run.HashAfterSteps();
    run.Stop();
    return hash_after;
  }();
  return hash;
}

// Writers of all topics that matter, of one stranger.
struct Arsenal {
  explicit Arsenal(const std::string& session) : Arsenal(session, AllPorts(), "lo") {}
  Arsenal(const std::string& session, std::vector<std::string> peers, const std::string& interface)
      : stranger(session, std::move(peers), interface),
        sessions(stranger, stranger.publisher, topics::kSession, dds::qos_profiles::Description(1.0)),
        frames(stranger, stranger.publisher, topics::kFrame, dds::qos_profiles::Frame()),
        admissions(stranger, stranger.publisher, topics::kAdmission, dds::qos_profiles::Admission()),
        joins(stranger, stranger.agent_publisher, topics::kJoin, dds::qos_profiles::Join(1.0)),
        proposals(stranger, stranger.agent_publisher, topics::kProposal, dds::qos_profiles::Proposal()),
        controls(stranger, stranger.publisher, topics::kControl, dds::qos_profiles::Control()) {}

  bool FoundAll() {
    return joins.Found() && proposals.Found() && frames.Found() && sessions.Found() && admissions.Found();
  }
  std::int32_t readers() {
    return sessions.readers() + frames.readers() + admissions.readers() + joins.readers() + proposals.readers() +
           controls.readers();
  }

  Stranger stranger;
  Forger<troupe_wire_Session> sessions;
  Forger<troupe_wire_Frame> frames;
  Forger<troupe_wire_Admissions> admissions;
  Forger<troupe_wire_Join> joins;
  Forger<troupe_wire_Proposal> proposals;
  Forger<troupe_wire_Control> controls;
};

// The run that a session announces to anyone, where it is not secured.
std::optional<RunId> SpyOutRun(const std::string& session, const std::string& interface = "lo") {
  dds::DomainConfig config = TestConfig();
  config.network_interface = interface;
  const dds::DomainParticipant spy(config);
  const dds::Subscriber subscriber(spy, dds::qos_profiles::Session(session));
  const dds::Topic<troupe_wire_Session> topic(spy, topics::kSession);
  dds::DataReader<troupe_wire_Session> reader(subscriber, topic, dds::qos_profiles::Description());
  std::optional<RunId> run;
  Eventually(
      [&] {
        for (const auto sample : reader.take()) run = sample.data().run;
        return run.has_value();
      },
      3.0);
  return run;
}

TEST(Attack, ASecuredRunIsInvisibleToStrangers) {
  const std::uint64_t peace = HashWithoutAttack();
  AttackedRun run(TestSession("secured"), "on");
  EXPECT_EQ(SpyOutRun(run.session()), std::nullopt);
  Arsenal arsenal(run.session());
  EXPECT_FALSE(arsenal.joins.Found(3.0));
  EXPECT_EQ(arsenal.readers(), 0);
  EXPECT_EQ(run.HashAfterSteps(), peace);
  run.Stop();
}

// One of each message that only the service or an agent sends, and floods of the others.
void Forge(Arsenal& arsenal, RunId id) {
  SessionMessage session{.run = id, .protocol_version = kProtocolVersion};
  arsenal.sessions.Send(session);
  session.run = 1;
  arsenal.sessions.Send(session);
  FrameMessage frame;
  frame.run = id;
  frame.state.tick = 7;
  arsenal.frames.Send(frame);
  frame.last = true;
  arsenal.frames.Send(frame);
  arsenal.admissions.Send(std::vector<AdmissionMessage>{{id, 1, false, "leave"}});
  JoinMessage join{.run = id, .protocol_version = kProtocolVersion, .robots = {"r0"}};
  for (AgentId agent = 1; agent <= kFlood; ++agent) {
    join.agent = agent;
    arsenal.joins.Send(join);
  }
  ProposalMessage proposal{.run = id, .tick = 1};
  for (AgentId agent = 1; agent <= kFlood; ++agent) {
    proposal.agent = agent;
    arsenal.proposals.Send(proposal);
  }
  EXPECT_TRUE(arsenal.joins.Delivered() && arsenal.proposals.Delivered());
}

TEST(Attack, ForgedMessagesDoNotChangeARunWithoutSecurity) {
  const std::uint64_t peace = HashWithoutAttack();
  AttackedRun run(TestSession("open"), "off");
  const std::optional<RunId> id = SpyOutRun(run.session());
  ASSERT_TRUE(id.has_value());
  Arsenal arsenal(run.session());
  ASSERT_TRUE(arsenal.FoundAll());
  Forge(arsenal, *id);
  EXPECT_EQ(run.HashAfterSteps(), peace);
  const std::string output = run.Stop();
  EXPECT_THAT(output, testing::HasSubstr("ignored participant"));
}

// The attacker is on another host of the network.
class BridgedAttack : public testing::Test {
 protected:
  void SetUp() override {
    if (hosts_ == nullptr) GTEST_SKIP() << "no network namespaces here: they need root and the program ip";
  }
  // The ports of the run, which must have started, on the first host.
  static std::vector<std::string> PortsOfRun() { return AllPorts(BridgedHosts::AddressOf(1)); }

  const std::uint64_t peace_ = HashWithoutAttack();
  const std::unique_ptr<BridgedHosts> hosts_ = BridgedHosts::Make();
};

TEST_F(BridgedAttack, ARunIsInvisibleByDefault) {
  const BridgedHosts::Visit home(*hosts_, 1);
  AttackedRun run(TestSession("bridged"), "auto", BridgedHosts::kInterface);
  const std::vector<std::string> ports = PortsOfRun();
  {
    const BridgedHosts::Visit away(*hosts_, 2);
    EXPECT_EQ(SpyOutRun(run.session(), BridgedHosts::kInterface), std::nullopt);
    Arsenal arsenal(run.session(), ports, BridgedHosts::kInterface);
    EXPECT_FALSE(arsenal.joins.Found(3.0));
    EXPECT_EQ(arsenal.readers(), 0);
  }
  EXPECT_EQ(run.HashAfterSteps(), peace_);
  run.Stop();
}

TEST_F(BridgedAttack, ForgedMessagesDoNotChangeARunWithoutSecurity) {
  const BridgedHosts::Visit home(*hosts_, 1);
  AttackedRun run(TestSession("bridged-open"), "off", BridgedHosts::kInterface);
  const std::vector<std::string> ports = PortsOfRun();
  {
    const BridgedHosts::Visit away(*hosts_, 2);
    const std::optional<RunId> id = SpyOutRun(run.session(), BridgedHosts::kInterface);
    ASSERT_TRUE(id.has_value());
    Arsenal arsenal(run.session(), ports, BridgedHosts::kInterface);
    ASSERT_TRUE(arsenal.FoundAll());
    Forge(arsenal, *id);
  }
  EXPECT_EQ(run.HashAfterSteps(), peace_);
  EXPECT_THAT(run.Stop(), testing::HasSubstr("ignored participant"));
}

TEST(Attack, AnotherUserNeitherControlsNorJoinsARunOnLoopback) {
  const std::uint64_t peace = HashWithoutAttack();
  AttackedRun run(TestSession("token"), "auto");
  const std::optional<RunId> id = SpyOutRun(run.session());
  ASSERT_TRUE(id.has_value()) << "without keys of DDS Security anyone can read it";
  Arsenal arsenal(run.session());
  ASSERT_TRUE(arsenal.controls.Found() && arsenal.joins.Found());
  for (const control::Request& request :
       std::vector<control::Request>{control::Play(), control::Reset(), control::Step{5}, control::Delete{"r0"}}) {
    arsenal.controls.Send(ControlRequest{.request = request});
  }
  arsenal.joins.Send(JoinMessage{.run = *id, .agent = 5, .protocol_version = kProtocolVersion, .robots = {"r0"}});
  EXPECT_TRUE(arsenal.controls.Delivered() && arsenal.joins.Delivered());

  NetworkSettings other_user = NetworkOf(run.session());
  other_user.security = kSecurityOff;
  ControlClient tool(other_user);
  const Status refused = tool.WaitForService(1.0);
  ASSERT_FALSE(refused.ok());
  EXPECT_THAT(refused.error().message, testing::HasSubstr("is of another user"));

  EXPECT_EQ(run.HashAfterSteps(), peace);
  const std::string output = run.Stop();
  EXPECT_THAT(output, testing::HasSubstr("troupe/control: ignored participant"));
  EXPECT_THAT(output, testing::HasSubstr("troupe/join: ignored participant"));
}

TEST(Attack, AnAgentThatIsStartedBeforeItsRunFindsTheToken) {
  const std::string session = TestSession("early-agents");
  const std::string domain = std::to_string(TestDomain());
  std::vector<Program> agents;
  for (const char* robot : {"r0", "r1", "r2", "r3"}) {
    agents.emplace_back(std::vector<std::string>{ProgramPath("robot-agent"), "--session", session, "--domain", domain,
                                                 "--robot", robot});
  }
  Program service({ProgramPath("world-service"), WorldPath("pen.world"), "--session", session, "--domain", domain,
                   "--ticks", "3", "--speed", "max"});
  EXPECT_EQ(service.Wait(), 0) << service.output();
  for (Program& agent : agents) EXPECT_EQ(agent.Wait(), 0) << agent.output();
}

TEST(Attack, AFloodOfRequestsLeavesNoMemoryBehind) {
  const std::uint64_t peace = HashWithoutAttack();
  AttackedRun run(TestSession("flood"), "off");
  const double before = run.ServiceMemory();
  {
    Arsenal arsenal(run.session());
    ASSERT_TRUE(arsenal.controls.Found() && arsenal.joins.Found());
    ControlRequest request;
    for (std::size_t i = 0; i < kFlood; ++i) {
      request.client = i;
      arsenal.controls.Send(request);
    }
    request.request = control::LoadWorld{std::string(100'000'000, 'x')};
    for (int i = 0; i < 3; ++i) arsenal.controls.Send(request);
    JoinMessage join;
    join.robots.assign(kLongList, "a robot with a long name");
    arsenal.joins.Send(join);
    request.request = control::GetStatus();
    arsenal.controls.Send(request);
    EXPECT_TRUE(arsenal.controls.Delivered());
  }
  EXPECT_EQ(run.HashAfterSteps(), peace);
  EXPECT_GT(before, 0.0);
  EXPECT_LT(run.ServiceMemory(), before + kMemoryMargin);
  run.Stop();
}

}  // namespace
}  // namespace troupe::test
