// Runs in a ROS domain with security, as ROS 2's own tools set it up (SROS 2).
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <stdlib.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>

#include "common/base/paths.h"
#include "ros/connection/ros_endpoints.h"
#include "tests/process/programs.h"
#include "tests/support/dds_domain.h"
#include "tests/support/files.h"
#include "tests/support/ros_graph.h"
#include "transport/security/certificate.h"

namespace troupe::test {
namespace {

// RosKeystore: a keystore with enclaves, in the layout of ROS 2's own tools (sros2): the keys of an enclave are files
// in its folder, and the authority's certificate and the governance are symbolic links there.
class RosKeystore {
 public:
  // `folder`: an existing one. Rules and permissions count for the one domain, as those of ROS's tools do.
  RosKeystore(std::string folder, std::uint32_t domain) : folder_(std::move(folder)), domain_(domain) {
    Result<CertifiedKey> authority = MakeAuthorityKey("sros2CA", std::chrono::hours(24));
    EXPECT_TRUE(authority.ok());
    authority_ = std::move(authority).value();
    for (const char* part : {"public", "private", "enclaves"}) std::filesystem::create_directory(folder_ / part);
    Write(folder_ / "public/ca.cert.pem", CertificatePem(authority_).value());
    Write(folder_ / "private/ca.key.pem", KeyPem(authority_).value());
    for (const char* use : {"identity_ca", "permissions_ca"}) {
      std::filesystem::create_symlink("ca.cert.pem", folder_ / "public" / (std::string(use) + ".cert.pem"));
      std::filesystem::create_symlink("ca.key.pem", folder_ / "private" / (std::string(use) + ".key.pem"));
    }
    Write(folder_ / "enclaves/governance.p7s", SignedDocument(Governance(), authority_).value());
  }

  // `name`: "/world". Its permissions allow all topics, as those of `ros2 security create_enclave` do.
  void AddEnclave(const std::string& name) const {
    const std::filesystem::path enclave = folder_ / "enclaves" / name.substr(1);
    std::filesystem::create_directories(enclave);
    const Result<CertifiedKey> identity = MakeIdentityKey(name, authority_);
    ASSERT_TRUE(identity.ok());
    Write(enclave / kCertificateFile, CertificatePem(identity.value()).value());
    Write(enclave / kPrivateKeyFile, KeyPem(identity.value()).value());
    Write(enclave / kPermissionsFile, SignedDocument(Permissions(name), authority_).value());
    std::filesystem::create_symlink("../../public/identity_ca.cert.pem", enclave / kIdentityCaFile);
    std::filesystem::create_symlink("../../public/permissions_ca.cert.pem", enclave / kPermissionsCaFile);
    std::filesystem::create_symlink("../governance.p7s", enclave / kGovernanceFile);
  }

  std::string path() const { return folder_.string(); }

 private:
  static void Write(const std::filesystem::path& path, const std::string& content) { std::ofstream(path) << content; }

  std::string Domains() const { return "<domains><id>" + std::to_string(domain_) + "</id></domains>"; }

  std::string Governance() const {
    return "<?xml version=\"1.0\" encoding=\"UTF-8\"?><dds><domain_access_rules><domain_rule>" + Domains() +
           "<allow_unauthenticated_participants>false</allow_unauthenticated_participants>"
           "<enable_join_access_control>true</enable_join_access_control>"
           "<discovery_protection_kind>ENCRYPT</discovery_protection_kind>"
           "<liveliness_protection_kind>ENCRYPT</liveliness_protection_kind>"
           "<rtps_protection_kind>ENCRYPT</rtps_protection_kind>"
           "<topic_access_rules><topic_rule><topic_expression>*</topic_expression>"
           "<enable_discovery_protection>true</enable_discovery_protection>"
           "<enable_liveliness_protection>true</enable_liveliness_protection>"
           "<enable_read_access_control>true</enable_read_access_control>"
           "<enable_write_access_control>true</enable_write_access_control>"
           "<metadata_protection_kind>ENCRYPT</metadata_protection_kind>"
           "<data_protection_kind>ENCRYPT</data_protection_kind>"
           "</topic_rule></topic_access_rules></domain_rule></domain_access_rules></dds>";
  }

  std::string Permissions(const std::string& name) const {
    const Validity validity = ValidityOf(authority_).value();
    const std::string all = "<topics><topic>*</topic></topics>";
    return "<?xml version=\"1.0\" encoding=\"UTF-8\"?><dds><permissions><grant name=\"" + name +
           "\"><subject_name>CN=" + name + "</subject_name><validity><not_before>" + validity.not_before +
           "</not_before><not_after>" + validity.not_after + "</not_after></validity><allow_rule>" + Domains() +
           "<publish>" + all + "</publish><subscribe>" + all +
           "</subscribe></allow_rule><default>DENY</default></grant></permissions></dds>";
  }

  const std::filesystem::path folder_;
  const std::uint32_t domain_;
  CertifiedKey authority_;
};

using testing::HasSubstr;
using testing::IsEmpty;

constexpr const char* kNamespaces[] = {"/r0", "/r1", "/r2", "/r3"};

std::vector<std::string> InRosDomain(std::vector<std::string> arguments) {
  const ros::RosNetwork options = TestRosNetwork();
  arguments.insert(arguments.end(), {"--ros", "--ros-domain=" + std::to_string(options.domain), "--ros-interface=lo"});
  return arguments;
}

class RosSecurity : public testing::Test {
 protected:
  void TearDown() override {
    for (const char* name : {"ROS_SECURITY_ENABLE", "ROS_SECURITY_STRATEGY", "ROS_SECURITY_KEYSTORE"}) unsetenv(name);
  }

  // For the programs that the test starts.
  void SetEnvironment(const char* strategy, const std::string& keystore) {
    setenv("ROS_SECURITY_ENABLE", "true", 1);
    setenv("ROS_SECURITY_STRATEGY", strategy, 1);
    setenv("ROS_SECURITY_KEYSTORE", keystore.c_str(), 1);
  }

  ros::RosNetwork SecuredOptions() const {
    ros::RosNetwork options = TestRosNetwork();
    options.security = {ros::SecurityStrategy::kEnforce, keystore_.path(), {}, {}};
    return options;
  }

  // With the keys of a tool, all of the graph is visible; without keys, nothing.
  void ExpectVisibleWithKeysOnly(const std::vector<std::string>& arguments) {
    keystore_.AddEnclave("/tool");
    RosGraph secured(SecuredOptions(), "/tool");
    RosGraph open;
    Program run = RunPen(InRosDomain(arguments));
    EXPECT_TRUE(Eventually([&] {
      const std::set<std::string> topics = secured.Topics("/");
      return topics.contains("/clock") && topics.contains("/r0/odom") && topics.contains("/r3/odom");
    })) << run.output();
    EXPECT_TRUE(Eventually([&] {
      const std::vector<std::string> nodes = secured.Nodes();
      return std::count(nodes.begin(), nodes.end(), "/world") == 1 &&
             std::count(nodes.begin(), nodes.end(), "/r0/robot") == 1;
    }));
    EXPECT_THAT(open.Topics("/"), IsEmpty());
    EXPECT_THAT(open.Nodes(), IsEmpty());
    run.Interrupt();
  }

  const TemporaryFolder folder_;
  const RosKeystore keystore_{folder_.Path(""), TestRosNetwork().domain};
};

TEST_F(RosSecurity, ARunIsVisibleWithKeysOnly) {
  keystore_.AddEnclave("/world");
  for (const char* robot : kNamespaces) keystore_.AddEnclave(robot);
  SetEnvironment("Enforce", keystore_.path());
  ExpectVisibleWithKeysOnly({"--speed", "10"});
}

TEST_F(RosSecurity, ARunInOneProcessIsVisibleWithKeysOnly) {
  keystore_.AddEnclave("/world");
  SetEnvironment("Enforce", keystore_.path());
  // Cyclone's plugins do not free some tokens of participants that share a domain in a process: 180 bytes for each.
  setenv("ASAN_OPTIONS", "detect_leaks=0", 1);
  ExpectVisibleWithKeysOnly({"--speed", "10", "--in-process"});
  unsetenv("ASAN_OPTIONS");
}

TEST_F(RosSecurity, AllProcessesCanHaveOneEnclave) {
  keystore_.AddEnclave("/swarm");
  SetEnvironment("Enforce", keystore_.path());
  ExpectVisibleWithKeysOnly({"--speed", "10", "--ros-enclave", "/swarm"});
}

TEST_F(RosSecurity, RequiredKeysThatAreMissingEndTheRunWithOneLine) {
  keystore_.AddEnclave("/world");
  keystore_.AddEnclave("/r0");
  std::filesystem::remove(folder_.Path("enclaves/r0/key.pem"));
  SetEnvironment("Enforce", keystore_.path());
  const std::string robot = OutputOf(RunPen(InRosDomain({"--ticks", "5"})), 2);
  EXPECT_THAT(robot, HasSubstr(folder_.Path("enclaves/r0/key.pem") + ": error: cannot read"));
  EXPECT_EQ(std::count(robot.begin(), robot.end(), '\n'), 1);
  std::filesystem::remove_all(folder_.Path("enclaves/world"));
  for (const char* mode : {"--headless", "--in-process"}) {
    const std::string run = OutputOf(RunPen(InRosDomain({"--ticks", "5", mode})), 2);
    EXPECT_THAT(run, HasSubstr(folder_.Path("enclaves/world") + ": error: found no such folder")) << mode;
    EXPECT_EQ(std::count(run.begin(), run.end(), '\n'), 1);
  }
}

TEST_F(RosSecurity, TheProgramsLookForTheirKeysThemselves) {
  SetEnvironment("Enforce", keystore_.path());
  EXPECT_THAT(OutputOf(Program({ProgramPath("world-service"), WorldPath("pen.world"), "--session", TestSession("keys"),
                                "--domain", std::to_string(TestDomain()), "--ros"}),
                       2),
              HasSubstr(folder_.Path("enclaves/world") + ": error: found no such folder"));
  EXPECT_THAT(OutputOf(Program({ProgramPath("robot-agent"), "--session", TestSession("keys"), "--domain",
                                std::to_string(TestDomain()), "--robot", "r0", "--ros"}),
                       2),
              HasSubstr(folder_.Path("enclaves/r0") + ": error: found no such folder"));
}

TEST_F(RosSecurity, OptionalKeysThatAreMissingAreAWarning) {
  SetEnvironment("Permissive", keystore_.path());
  for (const char* mode : {"--headless", "--in-process"}) {
    const std::string run = OutputOf(RunPen(InRosDomain({"--ticks", "5", mode})));
    EXPECT_THAT(run, HasSubstr(folder_.Path("enclaves/world") + ": warning: ")) << mode;
    EXPECT_THAT(run, HasSubstr("continuing without security")) << mode;
  }
}

TEST_F(RosSecurity, BadValuesAreErrorsOfRunsWithRosOnly) {
  SetEnvironment("Strict", keystore_.path());
  const std::string run = OutputOf(RunPen(InRosDomain({"--ticks", "5"})), 2);
  EXPECT_EQ(run, "error: ROS_SECURITY_STRATEGY: found 'Strict', expected Enforce or Permissive\n");
  EXPECT_EQ(Finish(RunPen({"--ticks", "5", "--in-process"})).exit_status, 0);
}

}  // namespace
}  // namespace troupe::test
