// The permissions of the roles, as Cyclone's plugins enforce them between participants on the network.
#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <fstream>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "common/base/paths.h"
#include "tests/support/dds_domain.h"
#include "tests/support/files.h"
#include "transport/dds/binding/data_reader.h"
#include "transport/dds/binding/data_writer.h"
#include "transport/dds/binding/domain_config.h"
#include "transport/dds/binding/network_log.h"
#include "transport/dds/convert/convert.h"
#include "transport/protocol/messages.h"
#include "transport/security/certificate.h"
#include "transport/security/key_authority.h"

namespace troupe::dds {
namespace {

using test::Eventually;
using test::TemporaryFolder;
using test::TestConfig;

DomainConfig ConfigWith(const std::string& enclave) {
  DomainConfig config = TestConfig();
  config.security_enclave = enclave;  // without the tag of the authority, as another program
  return config;
}

Qos Reliably() {
  return Qos() << Reliability::Reliable(1.0) << Durability::TransientLocal();
}

// Permissions are about topics, not about types.
using Sample = troupe_wire_Status;

class Participant {
 public:
  explicit Participant(const std::string& enclave) : Participant(ConfigWith(enclave)) {}
  explicit Participant(const DomainConfig& config) : participant_(config) {}

  dds_guid_t guid() const {
    dds_guid_t guid{};
    Check(dds_get_guid(participant_.handle(), &guid), "reading a GUID");
    return guid;
  }

  DataWriter<Sample> Writer(const char* topic, const std::string& partition) {
    publishers_.push_back(std::make_unique<Publisher>(participant_, Qos() << Partition{partition}));
    return {*publishers_.back(), TopicOf(topic), Reliably()};
  }
  DataReader<Sample> Reader(const char* topic, const std::string& partition) {
    subscribers_.push_back(std::make_unique<Subscriber>(participant_, Qos() << Partition{partition}));
    return {*subscribers_.back(), TopicOf(topic), Reliably()};
  }

 private:
  const Topic<Sample>& TopicOf(const char* name) {
    topics_.push_back(std::make_unique<Topic<Sample>>(participant_, name));
    return *topics_.back();
  }

  DomainParticipant participant_;
  std::vector<std::unique_ptr<Topic<Sample>>> topics_;
  std::vector<std::unique_ptr<Publisher>> publishers_;
  std::vector<std::unique_ptr<Subscriber>> subscribers_;
};

std::int32_t MatchedBy(const DataReader<Sample>& reader) {
  return reader.subscription_matched_status().current_count;
}
std::int32_t MatchedBy(const DataWriter<Sample>& writer) {
  return writer.publication_matched_status().current_count;
}

// The announcement that a participant has ended (RTPS 2.2, 8.5.3), as a stranger can send it in another's name.
std::string EndOfParticipant(const dds_guid_t& guid) {
  using namespace std::string_literals;
  const std::string bytes(reinterpret_cast<const char*>(guid.v), sizeof(guid.v));
  const std::string data =
      "\0\0\x10\0"s                        // the offset of the inline QoS
      "\0\x01\0\xc7\0\x01\0\xc2"s          // reader and writer of participants
      "\0\0\0\0\x4d\0\0\0"s                // a sequence number beyond those of the participant
      "\x71\0\x04\0\0\0\0\x03\x01\0\0\0"s  // inline QoS: disposed and unregistered
      "\0\x03\0\0\x50\0\x10\0"s +
      bytes + "\x01\0\0\0"s;  // the key: the participant's GUID
  return "RTPS\x02\x01\x01\x10"s + bytes.substr(0, 12) + "\x15\x0b"s + static_cast<char>(data.size()) + "\0"s + data;
}

void SendTo(std::uint16_t port, const std::string& packet) {
  const int sender = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  EXPECT_EQ(
      sendto(sender, packet.data(), packet.size(), 0, reinterpret_cast<const sockaddr*>(&address), sizeof(address)),
      static_cast<ssize_t>(packet.size()));
  close(sender);
}

class PermissionsTest : public testing::Test {
 protected:
  std::string Keys(const Role& role) { return Keys(authority_, "keys/" + KeyFolder(role), role); }
  std::string Keys(const Result<KeyAuthority>& authority, const std::string& name, const Role& role) {
    const std::string folder = folder_.Path(name);
    const Status written = authority.value().WriteIdentity(folder, role);
    EXPECT_TRUE(written.ok());
    return folder;
  }

  // An agent whose own plugins check nothing, as those of a changed program would. Cyclone compares the domain of a
  // rule with the number by which the process knows the domain, so a rule for `own_domain` counts for this participant
  // only.
  std::string UncheckedKeys(const std::string& agent, std::uint32_t own_domain) {
    const std::string folder = Keys(Role::Agent(agent));
    EXPECT_TRUE(authority_.value().Save(folder_.Path("authority")).ok());
    const Result<CertifiedKey> key =
        ReadCertifiedKey(folder_.Read("authority/ca.key.pem"), folder_.Read("authority/ca.cert.pem"));
    const std::string all = "<topics><topic>*</topic></topics><partitions><partition>*</partition></partitions>";
    std::string document =
        PermissionsDocument(Role::Agent(agent), "CN=troupe-agent-" + agent, ValidityOf(key.value()).value());
    document.insert(document.find("<allow_rule>"), "<allow_rule><domains><id>" + std::to_string(own_domain) +
                                                       "</id></domains><publish>" + all + "</publish><subscribe>" +
                                                       all + "</subscribe></allow_rule>\n");
    std::ofstream(folder + "/" + kPermissionsFile) << SignedDocument(document, key.value()).value();
    return folder;
  }

  const TemporaryFolder folder_;
  const Result<KeyAuthority> authority_ = KeyAuthority::Create();
  const std::string session_ = test::TestSession("permissions");
};

TEST_F(PermissionsTest, TheRolesOfARunMeet) {
  Participant service(Keys(Role::Service()));
  Participant agent(Keys(Role::Agent("a1")));
  Participant tool(Keys(Role::Operator()));
  Participant viewer(Keys(Role::Observer()));
  const DataWriter<Sample> frames = service.Writer(topics::kFrame, session_);
  const DataReader<Sample> joins = service.Reader(topics::kJoin, session_ + "/*");
  const DataReader<Sample> controls = service.Reader(topics::kControl, session_);
  const DataWriter<Sample> join = agent.Writer(topics::kJoin, session_ + "/a1");
  const DataReader<Sample> agent_frames = agent.Reader(topics::kFrame, session_);
  const DataWriter<Sample> control = tool.Writer(topics::kControl, session_);
  const DataReader<Sample> seen = viewer.Reader(topics::kFrame, session_);
  const DataReader<Sample> any_session = viewer.Reader(topics::kSession, "*");
  EXPECT_TRUE(Eventually([&] { return MatchedBy(frames) == 2 && MatchedBy(agent_frames) == 1; }));
  EXPECT_TRUE(Eventually([&] { return MatchedBy(joins) == 1 && MatchedBy(join) == 1; }));
  EXPECT_TRUE(Eventually([&] { return MatchedBy(controls) == 1 && MatchedBy(seen) == 1; }));
}

TEST_F(PermissionsTest, AParticipantMakesOnlyTheWritersAndReadersOfItsRole) {
  Participant agent(Keys(Role::Agent("a1")));
  EXPECT_NO_THROW(agent.Writer(topics::kProposal, session_ + "/a1"));
  EXPECT_THROW(agent.Writer(topics::kProposal, session_ + "/a2"), Exception);
  EXPECT_THROW(agent.Writer(topics::kProposal, session_), Exception);
  EXPECT_THROW(agent.Writer(topics::kProposal, "*"), Exception);
  EXPECT_THROW(agent.Writer(topics::kFrame, session_), Exception);
  EXPECT_THROW(agent.Reader(topics::kJoin, session_), Exception);
  EXPECT_THROW(agent.Writer("troupe/other", session_), Exception);
  Participant viewer(Keys(Role::Observer()));
  EXPECT_NO_THROW(viewer.Writer(topics::kFrameRequest, session_));
  EXPECT_THROW(viewer.Writer(topics::kControl, session_), Exception);
  EXPECT_THROW(viewer.Reader(topics::kControlReply, session_), Exception);
}

constexpr std::uint32_t kNumberOfThird = 228;  // by which this process knows the domain of its third participant

TEST_F(PermissionsTest, OthersRefuseWritersBeyondTheRole) {
  Participant service(Keys(Role::Service()));
  Participant victim(Keys(Role::Agent("a2")));
  Participant hostile(UncheckedKeys("a1", kNumberOfThird));
  const DataReader<Sample> joins = service.Reader(topics::kJoin, session_ + "/*");
  const DataReader<Sample> frames = victim.Reader(topics::kFrame, session_);
  const DataWriter<Sample> forged_frame = hostile.Writer(topics::kFrame, session_);
  const DataWriter<Sample> forged_join = hostile.Writer(topics::kJoin, session_ + "/a2");
  const DataWriter<Sample> forged_pattern = hostile.Writer(topics::kJoin, session_ + "/a?");
  const DataReader<Sample> spy = hostile.Reader(topics::kControlReply, session_);
  // Discovered after the forged ones.
  const DataWriter<Sample> own_join = hostile.Writer(topics::kJoin, session_ + "/a1");
  const DataReader<Sample> own_frames = hostile.Reader(topics::kFrame, session_);
  const DataWriter<Sample> true_frame = service.Writer(topics::kFrame, session_);
  const DataWriter<Sample> reply = service.Writer(topics::kControlReply, session_);
  EXPECT_TRUE(Eventually([&] { return MatchedBy(own_join) == 1 && MatchedBy(joins) >= 1; }));
  EXPECT_TRUE(Eventually([&] { return MatchedBy(true_frame) == 2 && MatchedBy(frames) >= 1; }));
  EXPECT_EQ(MatchedBy(joins), 1) << "the join in its own partition alone";
  EXPECT_EQ(MatchedBy(frames), 1) << "the service's frames alone";
  EXPECT_EQ(MatchedBy(reply), 0);
}

TEST_F(PermissionsTest, StrangersAreInvisible) {
  const Result<KeyAuthority> other = KeyAuthority::Create();
  Participant open("");
  Participant open_witness("");
  Participant foreign(Keys(other, "other/service", Role::Service()));
  Participant foreign_witness(Keys(other, "other/agent", Role::Agent("a1")));
  const DataWriter<Sample> open_writer = open.Writer(topics::kFrame, session_);
  const DataReader<Sample> open_reader = open_witness.Reader(topics::kFrame, session_);
  const DataWriter<Sample> foreign_writer = foreign.Writer(topics::kFrame, session_);
  const DataReader<Sample> foreign_reader = foreign_witness.Reader(topics::kFrame, session_);
  Participant service(Keys(Role::Service()));
  Participant agent(Keys(Role::Agent("a1")));
  const DataWriter<Sample> frame = service.Writer(topics::kFrame, session_);
  const DataReader<Sample> frames = agent.Reader(topics::kFrame, session_);
  // The writer and the reader of a pair learn of each other at different times.
  EXPECT_TRUE(Eventually([&] { return MatchedBy(open_writer) >= 1 && MatchedBy(open_reader) >= 1; }));
  EXPECT_TRUE(Eventually([&] { return MatchedBy(foreign_writer) >= 1 && MatchedBy(foreign_reader) >= 1; }));
  EXPECT_TRUE(Eventually([&] { return MatchedBy(frame) >= 1 && MatchedBy(frames) >= 1; }));
  for (const DataWriter<Sample>* writer : {&open_writer, &foreign_writer, &frame}) EXPECT_EQ(MatchedBy(*writer), 1);
  for (const DataReader<Sample>* reader : {&open_reader, &foreign_reader, &frames}) EXPECT_EQ(MatchedBy(*reader), 1);
}

// Otherwise each of two runs in a domain would warn of every process of the other one.
TEST_F(PermissionsTest, ParticipantsOfTwoAuthoritiesDoNotDiscoverEachOther) {
  const auto with_keys = [](const std::string& enclave) {
    DomainConfig config = TestConfig();
    SetKeys(config, enclave);
    return config;
  };
  const Result<KeyAuthority> other = KeyAuthority::Create();
  const DomainConfig service_config = with_keys(Keys(Role::Service()));
  const DomainConfig agent_config = with_keys(Keys(Role::Agent("a1")));
  const DomainConfig foreign_config = with_keys(Keys(other, "other/service", Role::Service()));
  EXPECT_EQ(service_config.tag, agent_config.tag);
  EXPECT_NE(service_config.tag, foreign_config.tag);
  EXPECT_TRUE(with_keys("").tag.empty());
  std::mutex mutex;
  std::vector<std::string> lines;
  {
    const NetworkLog log([&](const std::string& line) {
      const std::lock_guard lock(mutex);
      lines.push_back(line);
    });
    Participant foreign(foreign_config);
    const DataWriter<Sample> foreign_frame = foreign.Writer(topics::kFrame, session_);
    Participant service(service_config);
    Participant agent(agent_config);
    const DataWriter<Sample> frame = service.Writer(topics::kFrame, session_);
    const DataReader<Sample> frames = agent.Reader(topics::kFrame, session_);
    EXPECT_TRUE(Eventually([&] { return MatchedBy(frame) == 1 && MatchedBy(frames) == 1; }));
    EXPECT_EQ(MatchedBy(foreign_frame), 0);
  }
  EXPECT_THAT(lines, testing::IsEmpty());
}

TEST_F(PermissionsTest, AForgedEndOfAParticipantCountsWithoutKeysOnly) {
  for (const bool secured : {false, true}) {
    DomainConfig config = ConfigWith(secured ? Keys(Role::Service()) : "");
    config.participant_index = secured ? 61 : 60;
    Participant service(config);
    Participant agent(secured ? Keys(Role::Agent("a1")) : "");
    const DataReader<Sample> joins = service.Reader(topics::kJoin, session_ + "/*");
    const DataReader<Sample> proposals = service.Reader(topics::kProposal, session_ + "/*");
    const DataWriter<Sample> join = agent.Writer(topics::kJoin, session_ + "/a1");
    EXPECT_TRUE(Eventually([&] { return MatchedBy(joins) == 1 && MatchedBy(join) == 1; }));
    SendTo(DiscoveryPort(config.domain, *config.participant_index), EndOfParticipant(agent.guid()));
    if (!secured) {
      EXPECT_TRUE(Eventually([&] { return MatchedBy(joins) == 0; }));
      continue;
    }
    // Discovered after the packet.
    const DataWriter<Sample> proposal = agent.Writer(topics::kProposal, session_ + "/a1");
    EXPECT_TRUE(Eventually([&] { return MatchedBy(proposals) == 1; }));
    EXPECT_EQ(MatchedBy(joins), 1);
  }
}

// Permissions of ROS 2's own tools name one domain.
TEST_F(PermissionsTest, ParticipantsWithTheNumberOfTheNetworkShareTheirDomain) {
  DomainConfig config = ConfigWith(Keys(Role::Service()));
  config.numbered_as_on_network = true;
  const DomainParticipant service(config);
  config.security_enclave = Keys(Role::Observer());
  {
    const DomainParticipant viewer(config);
    const DomainParticipant other(TestConfig());
    dds_domainid_t number = 0;
    Check(dds_get_domainid(viewer.handle(), &number), "reading a number");
    EXPECT_EQ(number, config.domain);
    Check(dds_get_domainid(other.handle(), &number), "reading a number");
    EXPECT_NE(number, config.domain);
  }
  config.lease_seconds = 3;
  EXPECT_THROW(DomainParticipant{config}, Exception);
}

TEST_F(PermissionsTest, AParticipantWithoutItsKeysNamesTheFile) {
  const std::string folder = Keys(Role::Service());
  std::filesystem::remove(folder + "/" + kPrivateKeyFile);
  try {
    const DomainParticipant participant(ConfigWith(folder));
    FAIL() << "expected an exception";
  } catch (const Exception& exception) {
    EXPECT_NE(std::string(exception.what()).find(folder + "/key.pem: error: "), std::string::npos) << exception.what();
  }
}

TEST_F(PermissionsTest, EveryNetworkProfileHasSecurity) {
  for (const char* profile : {"one-host", "lan", "unicast"}) {
    DomainConfig config = ConfigWith(Keys(authority_, std::string("$odd & <") + profile, Role::Observer()));
    config.network = profile;
    Participant viewer(config);
    EXPECT_THROW(viewer.Reader(topics::kJoin, session_), Exception) << profile;
  }
}

}  // namespace
}  // namespace troupe::dds
