#include "transport/security/key_authority.h"

#include <fmt/format.h>

#include <filesystem>
#include <utility>

#include "common/base/identity.h"
#include "common/base/paths.h"
#include "transport/security/certificate.h"
#include "transport/security/run_token.h"
#include "troupe/check.h"

namespace troupe {
namespace {

constexpr const char* kAuthorityCertificate = "ca.cert.pem";
constexpr const char* kAuthorityKey = "ca.key.pem";

// The common name of a certificate; unique in an authority, because no two identities have the same role and name by
// intent.
std::string CommonName(const Role& role) {
  switch (role.kind) {
    case Role::Kind::kService:
      return "troupe-service";
    case Role::Kind::kAgent:
      return "troupe-agent-" + role.agent_name;
    case Role::Kind::kOperator:
      return "troupe-operator";
    case Role::Kind::kObserver:
      return "troupe-observer";
  }
  return {};
}

}  // namespace

KeyAuthority::KeyAuthority(std::unique_ptr<const CertifiedKey> key, std::string governance)
    : key_(std::move(key)), governance_(std::move(governance)) {}
KeyAuthority::KeyAuthority(KeyAuthority&& other) noexcept = default;
KeyAuthority& KeyAuthority::operator=(KeyAuthority&& other) noexcept = default;
KeyAuthority::~KeyAuthority() = default;

Result<KeyAuthority> KeyAuthority::Create(std::chrono::seconds lifetime) {
  // Authorities have different names, so that messages tell them apart.
  Result<CertifiedKey> key = MakeAuthorityKey(fmt::format("troupe-authority-{:016x}", MakeRandomId()), lifetime);
  if (!key.ok()) return key.error();
  Result<std::string> governance = SignedDocument(GovernanceDocument(), key.value());
  if (!governance.ok()) return governance.error();
  return KeyAuthority(std::make_unique<const CertifiedKey>(std::move(key).value()), std::move(governance).value());
}

Result<KeyAuthority> KeyAuthority::Load(const std::string& folder) {
  const std::filesystem::path path(folder);
  const Result<std::string> key_pem = ReadFileOfKeys((path / kAuthorityKey).string());
  if (!key_pem.ok()) return key_pem.error();
  const Result<std::string> certificate_pem = ReadFileOfKeys((path / kAuthorityCertificate).string());
  if (!certificate_pem.ok()) return certificate_pem.error();
  Result<std::string> governance = ReadFileOfKeys((path / kGovernanceFile).string());
  if (!governance.ok()) return governance.error();
  Result<CertifiedKey> key = ReadCertifiedKey(key_pem.value(), certificate_pem.value());
  if (!key.ok()) return Error{{folder}, key.error().message, key.error().code};
  if (HasExpired(key.value())) return Error{{folder}, "the authority's certificate has expired; make new keys"};
  return KeyAuthority(std::make_unique<const CertifiedKey>(std::move(key).value()), std::move(governance).value());
}

Status KeyAuthority::Save(const std::string& folder) const {
  Result<std::string> key_pem = KeyPem(*key_);
  if (!key_pem.ok()) return key_pem.error();
  Result<std::string> certificate_pem = CertificatePem(*key_);
  if (!certificate_pem.ok()) return certificate_pem.error();
  return WritePrivateFolder(folder, {{kAuthorityKey, std::move(key_pem).value()},
                                     {kAuthorityCertificate, std::move(certificate_pem).value()},
                                     {kGovernanceFile, governance_}});
}

Status KeyAuthority::WriteIdentity(const std::string& folder, const Role& role) const {
  TROUPE_CHECK(role.kind != Role::Kind::kAgent || IsAgentName(role.agent_name));
  const std::string name = CommonName(role);
  const Result<CertifiedKey> identity = MakeIdentityKey(name, *key_);
  if (!identity.ok()) return identity.error();
  const Result<Validity> validity = ValidityOf(*key_);
  if (!validity.ok()) return validity.error();
  const Result<std::string> permissions =
      SignedDocument(PermissionsDocument(role, "CN=" + name, validity.value()), *key_);
  if (!permissions.ok()) return permissions.error();
  const Result<std::string> authority_pem = CertificatePem(*key_);
  if (!authority_pem.ok()) return authority_pem.error();
  const Result<std::string> certificate_pem = CertificatePem(identity.value());
  if (!certificate_pem.ok()) return certificate_pem.error();
  const Result<std::string> key_pem = KeyPem(identity.value());
  if (!key_pem.ok()) return key_pem.error();
  return WritePrivateFolder(folder, {{kIdentityCaFile, authority_pem.value()},
                                     {kPermissionsCaFile, authority_pem.value()},
                                     {kCertificateFile, certificate_pem.value()},
                                     {kPrivateKeyFile, key_pem.value()},
                                     {kGovernanceFile, governance_},
                                     {kPermissionsFile, permissions.value()}});
}

}  // namespace troupe
