// RosKeystore: a keystore with enclaves, in the layout of ROS 2's own tools (sros2): the keys of an enclave are files
// in its folder, and the authority's certificate and the governance are symbolic links there.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "common/base/paths.h"
#include "transport/security/certificate.h"

namespace troupe::test {

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

}  // namespace troupe::test
