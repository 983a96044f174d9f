#include "transport/security/certificate.h"

#include <openssl/bio.h>
#include <openssl/crypto.h>
#include <openssl/err.h>
#include <openssl/evp.h>
#include <openssl/pem.h>
#include <openssl/pkcs7.h>
#include <openssl/x509.h>
#include <openssl/x509v3.h>

#include <ctime>
#include <initializer_list>
#include <vector>

#include "common/base/identity.h"
#include "transport/protocol/messages.h"

namespace troupe {
namespace {

constexpr int kVersion3 = 2;  // versions count from 0
constexpr long kDay = 24L * 60 * 60;

struct BioDeleter {
  void operator()(BIO* bio) const { BIO_free_all(bio); }
};
using Bio = std::unique_ptr<BIO, BioDeleter>;

struct Pkcs7Deleter {
  void operator()(PKCS7* message) const { PKCS7_free(message); }
};

struct ExtensionDeleter {
  void operator()(X509_EXTENSION* extension) const { X509_EXTENSION_free(extension); }
};

// Takes OpenSSL's own account of the failure.
Error OpenSslFailure(const std::string& doing) {
  char reason[256] = "no reason given";
  if (const unsigned long code = ERR_get_error(); code != 0) ERR_error_string_n(code, reason, sizeof(reason));
  ERR_clear_error();
  return Failure("OpenSSL failed in " + doing + ": " + reason);
}

// Without a function for passwords OpenSSL would ask on the terminal.
int NoPassword(char*, int, int, void*) {
  return 0;
}

Bio ReadingBio(const std::string& text) {
  return Bio(BIO_new_mem_buf(text.data(), static_cast<int>(text.size())));
}

std::string ContentOf(const Bio& bio) {
  char* content = nullptr;
  const long size = BIO_get_mem_data(bio.get(), &content);
  return {content, static_cast<std::size_t>(size)};
}

bool SetName(X509_NAME* name, const std::string& common_name) {
  return X509_NAME_add_entry_by_txt(name, "CN", MBSTRING_UTF8,
                                    reinterpret_cast<const unsigned char*>(common_name.data()),
                                    static_cast<int>(common_name.size()), -1, 0) == 1;
}

bool AddExtension(X509* certificate, int nid, const char* value) {
  const std::unique_ptr<X509_EXTENSION, ExtensionDeleter> extension(X509V3_EXT_conf_nid(nullptr, nullptr, nid, value));
  return extension != nullptr && X509_add_ext(certificate, extension.get(), -1) == 1;
}

// All but issuer, times, extensions and signature.
Result<CertifiedKey> MakeUnsigned(const std::string& common_name) {
  // Without memory for it OpenSSL uses a lock that is not there.
  if (OSSL_LIB_CTX_get0_global_default() == nullptr) return OpenSslFailure("making a key");
  CertifiedKey made{std::unique_ptr<EVP_PKEY, OpenSslDeleter>(EVP_EC_gen("P-256")),
                    std::unique_ptr<X509, OpenSslDeleter>(X509_new())};
  X509* const certificate = made.certificate.get();
  const auto serial = static_cast<std::uint64_t>(MakeRandomId() >> 1);  // positive
  if (made.key == nullptr || certificate == nullptr || X509_set_version(certificate, kVersion3) != 1 ||
      ASN1_INTEGER_set_uint64(X509_get_serialNumber(certificate), serial) != 1 ||
      !SetName(X509_get_subject_name(certificate), common_name) || X509_set_pubkey(certificate, made.key.get()) != 1) {
    return OpenSslFailure("making a key");
  }
  return made;
}

// As "2030-12-31T23:59:59"; empty on failure.
std::string TimeText(const std::tm& time) {
  char text[32];
  return {text, std::strftime(text, sizeof(text), "%Y-%m-%dT%H:%M:%S", &time)};
}

std::string TimeText(const ASN1_TIME* time) {
  std::tm parts{};
  return ASN1_TIME_to_tm(time, &parts) == 1 ? TimeText(parts) : std::string();
}

Result<Validity> ValidityOf(const X509* certificate) {
  Validity validity{TimeText(X509_get0_notBefore(certificate)), TimeText(X509_get0_notAfter(certificate))};
  if (validity.not_before.empty() || validity.not_after.empty()) return OpenSslFailure("reading a certificate's times");
  return validity;
}

// Cyclone compares the number by which the process knows the domain, which can be any.
constexpr const char* kAllDomains = "<domains><id_range><min>0</min><max>230</max></id_range></domains>\n";

std::string TopicRule(const char* topic, const char* metadata_protection) {
  return std::string("<topic_rule>\n<topic_expression>") + topic +
         "</topic_expression>\n"
         "<enable_discovery_protection>true</enable_discovery_protection>\n"
         "<enable_liveliness_protection>true</enable_liveliness_protection>\n"
         "<enable_read_access_control>true</enable_read_access_control>\n"
         "<enable_write_access_control>true</enable_write_access_control>\n"
         "<metadata_protection_kind>" +
         metadata_protection +
         "</metadata_protection_kind>\n"
         "<data_protection_kind>NONE</data_protection_kind>\n"
         "</topic_rule>\n";
}

struct Access {
  std::vector<const char*> publish;
  std::vector<const char*> subscribe;
  std::string publish_partition = "*";
};

Access AccessOf(const Role& role) {
  using namespace topics;  // NOLINT(google-build-using-namespace): a table of topics
  switch (role.kind) {
    case Role::Kind::kService:
      return {{kSession, kFrame, kWholeFrame, kAdmission, kHistory, kStatus, kControlReply},
              {kJoin, kProposal, kControl, kFrameRequest, kSession}};
    case Role::Kind::kAgent:
      // Names have no wildcards, so the end of the partition is this agent's in any session.
      return {{kJoin, kProposal}, {kSession, kAdmission, kFrame, kHistory}, "*/" + role.agent_name};
    case Role::Kind::kOperator:
      return {{kControl, kFrameRequest}, {kSession, kStatus, kControlReply, kFrame, kWholeFrame}};
    case Role::Kind::kObserver:
      return {{kFrameRequest}, {kSession, kStatus, kFrame, kWholeFrame}};
  }
  return {};
}

std::string Criteria(const char* element, const std::vector<const char*>& topics, const std::string& partition) {
  std::string text = std::string("<") + element + "><topics>\n";
  for (const char* topic : topics) text += std::string("<topic>") + topic + "</topic>\n";
  return text + "</topics><partitions><partition>" + partition + "</partition></partitions></" + element + ">\n";
}

std::string Document(const char* schema, const std::string& content) {
  return std::string(
             "<?xml version=\"1.0\" encoding=\"utf-8\"?>\n"
             "<dds xmlns:xsi=\"http://www.w3.org/2001/XMLSchema-instance\" xsi:noNamespaceSchemaLocation="
             "\"https://www.omg.org/spec/DDS-SECURITY/20170901/") +
         schema + "\">\n" + content + "</dds>\n";
}

}  // namespace

void OpenSslDeleter::operator()(EVP_PKEY* key) const {
  EVP_PKEY_free(key);
}
void OpenSslDeleter::operator()(X509* certificate) const {
  X509_free(certificate);
}

Result<CertifiedKey> MakeAuthorityKey(const std::string& common_name, std::chrono::seconds lifetime) {
  Result<CertifiedKey> made = MakeUnsigned(common_name);
  if (!made.ok()) return made;
  X509* const certificate = made.value().certificate.get();
  if (X509_gmtime_adj(X509_getm_notBefore(certificate), -kDay) == nullptr ||
      X509_gmtime_adj(X509_getm_notAfter(certificate), static_cast<long>(lifetime.count())) == nullptr ||
      X509_set_issuer_name(certificate, X509_get_subject_name(certificate)) != 1 ||
      !AddExtension(certificate, NID_basic_constraints, "critical,CA:TRUE,pathlen:0") ||
      X509_sign(certificate, made.value().key.get(), EVP_sha256()) == 0) {
    return OpenSslFailure("making the certificate of an authority");
  }
  return made;
}

Result<CertifiedKey> MakeIdentityKey(const std::string& common_name, const CertifiedKey& authority) {
  Result<CertifiedKey> made = MakeUnsigned(common_name);
  if (!made.ok()) return made;
  X509* const certificate = made.value().certificate.get();
  X509* const issuer = authority.certificate.get();
  if (X509_set1_notBefore(certificate, X509_get0_notBefore(issuer)) != 1 ||
      X509_set1_notAfter(certificate, X509_get0_notAfter(issuer)) != 1 ||
      X509_set_issuer_name(certificate, X509_get_subject_name(issuer)) != 1 ||
      !AddExtension(certificate, NID_basic_constraints, "CA:FALSE") ||
      X509_sign(certificate, authority.key.get(), EVP_sha256()) == 0) {
    return OpenSslFailure("signing a certificate");
  }
  return made;
}

Result<CertifiedKey> ReadCertifiedKey(const std::string& key_pem, const std::string& certificate_pem) {
  CertifiedKey read;
  read.key.reset(PEM_read_bio_PrivateKey(ReadingBio(key_pem).get(), nullptr, NoPassword, nullptr));
  read.certificate.reset(PEM_read_bio_X509(ReadingBio(certificate_pem).get(), nullptr, NoPassword, nullptr));
  ERR_clear_error();
  if (read.certificate == nullptr) return Error{{}, "found no certificate in PEM"};
  if (read.key == nullptr) return Error{{}, "found no private key in PEM without password"};
  if (X509_check_private_key(read.certificate.get(), read.key.get()) != 1) {
    ERR_clear_error();
    return Error{{}, "the private key is not that of the certificate"};
  }
  return read;
}

Result<std::string> KeyPem(const CertifiedKey& key) {
  const Bio bio(BIO_new(BIO_s_mem()));
  if (bio == nullptr ||
      PEM_write_bio_PKCS8PrivateKey(bio.get(), key.key.get(), nullptr, nullptr, 0, nullptr, nullptr) != 1) {
    return OpenSslFailure("writing a private key");
  }
  return ContentOf(bio);
}

Result<std::string> CertificatePem(const CertifiedKey& key) {
  const Bio bio(BIO_new(BIO_s_mem()));
  if (bio == nullptr || PEM_write_bio_X509(bio.get(), key.certificate.get()) != 1) {
    return OpenSslFailure("writing a certificate");
  }
  return ContentOf(bio);
}

bool HasExpired(const CertifiedKey& key) {
  return X509_cmp_current_time(X509_get0_notAfter(key.certificate.get())) < 0;
}

Result<Validity> ValidityOf(const CertifiedKey& key) {
  return ValidityOf(key.certificate.get());
}

Result<Validity> ValidityOfCertificate(const std::string& certificate_pem) {
  const std::unique_ptr<X509, OpenSslDeleter> certificate(
      PEM_read_bio_X509(ReadingBio(certificate_pem).get(), nullptr, NoPassword, nullptr));
  if (certificate == nullptr) return OpenSslFailure("reading a certificate");
  return ValidityOf(certificate.get());
}

Status CheckClock(const Validity& validity, const std::string& now) {
  const std::string clock =
      ", but the clock of host " + HostName() + " says " + now + " (UTC): expected the right time";
  // Texts of this form are in the order of their times.
  if (now < validity.not_before) return Failure("the keys count from " + validity.not_before + " on" + clock);
  if (now > validity.not_after) return Failure("the keys count until " + validity.not_after + clock + ", or new keys");
  return {};
}

std::string TimeOfClock() {
  const std::time_t now = std::time(nullptr);
  std::tm parts{};
  gmtime_r(&now, &parts);
  return TimeText(parts);
}

Result<std::string> SignedDocument(const std::string& text, const CertifiedKey& authority) {
  constexpr int kFlags = PKCS7_TEXT | PKCS7_DETACHED | PKCS7_STREAM | PKCS7_NOSMIMECAP;
  const Bio content = ReadingBio(text);
  const Bio message(BIO_new(BIO_s_mem()));
  const std::unique_ptr<PKCS7, Pkcs7Deleter> signature(
      PKCS7_sign(authority.certificate.get(), authority.key.get(), nullptr, content.get(), kFlags));
  if (signature == nullptr || message == nullptr ||
      SMIME_write_PKCS7(message.get(), signature.get(), content.get(), kFlags) != 1) {
    return OpenSslFailure("signing a document");
  }
  return ContentOf(message);
}

std::string GovernanceDocument() {
  using namespace topics;  // NOLINT(google-build-using-namespace): a table of topics
  std::string rules;
  for (const char* topic : {kSession, kFrame, kWholeFrame, kHistory, kJoin, kControl, kControlReply, kStatus}) {
    rules += TopicRule(topic, "ENCRYPT");
  }
  for (const char* topic : {kProposal, kAdmission, kFrameRequest}) rules += TopicRule(topic, "SIGN");
  return Document("omg_shared_ca_governance.xsd",
                  std::string("<domain_access_rules><domain_rule>\n") + kAllDomains +
                      "<allow_unauthenticated_participants>false</allow_unauthenticated_participants>\n"
                      "<enable_join_access_control>true</enable_join_access_control>\n"
                      "<discovery_protection_kind>ENCRYPT</discovery_protection_kind>\n"
                      "<liveliness_protection_kind>SIGN</liveliness_protection_kind>\n"
                      "<rtps_protection_kind>NONE</rtps_protection_kind>\n"
                      "<topic_access_rules>\n" +
                      rules + "</topic_access_rules>\n</domain_rule></domain_access_rules>\n");
}

std::string PermissionsDocument(const Role& role, const std::string& subject, const Validity& validity) {
  const Access access = AccessOf(role);
  return Document("omg_shared_ca_permissions.xsd",
                  "<permissions><grant name=\"" + subject + "\">\n<subject_name>" + subject +
                      "</subject_name>\n<validity><not_before>" + validity.not_before + "</not_before><not_after>" +
                      validity.not_after + "</not_after></validity>\n<allow_rule>\n" + kAllDomains +
                      Criteria("publish", access.publish, access.publish_partition) +
                      Criteria("subscribe", access.subscribe, "*") +
                      "</allow_rule>\n<default>DENY</default>\n</grant></permissions>\n");
}

}  // namespace troupe
