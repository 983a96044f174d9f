// Key pairs with certificates, and signed documents: the part of OpenSSL that DDS Security needs. Errors have the code
// kFailure, except where a text that was read is not understood.
//
// Keys are of the curve P-256 with SHA-256, as DDS Security 1.1 has them. Private keys are in memory and in files of
// mode 0600 only. Times are generous (a day before now), because the clocks of hosts differ.
#pragma once

#include <openssl/types.h>

#include <chrono>
#include <memory>
#include <string>

#include "transport/security/session_keys.h"
#include "troupe/result.h"

namespace troupe {

// Validity: the time during which a certificate or a document counts.
// UTC, as "2030-12-31T23:59:59".
struct Validity {
  std::string not_before;
  std::string not_after;
};

struct OpenSslDeleter {
  void operator()(EVP_PKEY* key) const;
  void operator()(X509* certificate) const;
};

// A private key on the curve P-256, and the certificate of its public half.
struct CertifiedKey {
  std::unique_ptr<EVP_PKEY, OpenSslDeleter> key;
  std::unique_ptr<X509, OpenSslDeleter> certificate;
};

// Signed by itself, for signing certificates and documents. Valid from a day ago, because hosts' clocks differ.
Result<CertifiedKey> MakeAuthorityKey(const std::string& common_name, std::chrono::seconds lifetime);

// Signed by the authority, and valid for as long as the authority is.
Result<CertifiedKey> MakeIdentityKey(const std::string& common_name, const CertifiedKey& authority);

// Reads both from PEM. Fails if the key is not that of the certificate.
Result<CertifiedKey> ReadCertifiedKey(const std::string& key_pem, const std::string& certificate_pem);

Result<std::string> KeyPem(const CertifiedKey& key);
Result<std::string> CertificatePem(const CertifiedKey& key);

// The certificate's validity has ended.
bool HasExpired(const CertifiedKey& key);

Result<Validity> ValidityOf(const CertifiedKey& key);
Result<Validity> ValidityOfCertificate(const std::string& certificate_pem);

// An error that names this host and its clock unless `now` is within the validity. `now`: UTC, as in Validity.
Status CheckClock(const Validity& validity, const std::string& now);
// The time of this host's clock.
std::string TimeOfClock();

// An S/MIME message with the text and a detached signature: the contents of a .p7s file.
Result<std::string> SignedDocument(const std::string& text, const CertifiedKey& authority);

// The two documents of DDS Security 1.1, before they are signed: the rules of the simulation domain, which are the same
// for all participants, and the permissions of one participant.

std::string GovernanceDocument();

// `subject`: that of the participant's certificate, as "CN=name". All that is not allowed is denied.
std::string PermissionsDocument(const Role& role, const std::string& subject, const Validity& validity);

}  // namespace troupe
