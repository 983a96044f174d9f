#include "transport/security/key_authority.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <openssl/pem.h>
#include <openssl/pkcs7.h>
#include <openssl/x509.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>

#include "common/base/identity.h"
#include "common/base/paths.h"
#include "tests/support/files.h"
#include "tests/support/values.h"
#include "tests/support/without_memory.h"
#include "transport/protocol/message_texts.h"
#include "transport/security/certificate.h"
#include "transport/security/run_token.h"
#include "transport/security/session_keys.h"

namespace troupe::test {
namespace {

using testing::HasSubstr;
using testing::Not;

KeyAuthority Authority() {
  Result<KeyAuthority> authority = KeyAuthority::Create();
  EXPECT_TRUE(authority.ok());
  return std::move(authority).value();
}

struct Deleter {
  void operator()(BIO* bio) const { BIO_free_all(bio); }
  void operator()(X509* certificate) const { X509_free(certificate); }
  void operator()(EVP_PKEY* key) const { EVP_PKEY_free(key); }
  void operator()(X509_STORE* store) const { X509_STORE_free(store); }
  void operator()(X509_STORE_CTX* context) const { X509_STORE_CTX_free(context); }
  void operator()(PKCS7* message) const { PKCS7_free(message); }
};
template <typename T>
using Owned = std::unique_ptr<T, Deleter>;

Owned<BIO> Open(const std::string& path) {
  return Owned<BIO>(BIO_new_file(path.c_str(), "rb"));
}

Owned<X509> Certificate(const std::string& path) {
  return Owned<X509>(PEM_read_bio_X509(Open(path).get(), nullptr, nullptr, nullptr));
}

Owned<X509_STORE> StoreWith(X509* authority) {
  Owned<X509_STORE> store(X509_STORE_new());
  X509_STORE_add_cert(store.get(), authority);
  return store;
}

bool IsIssuedBy(X509* certificate, X509* authority) {
  const Owned<X509_STORE> store = StoreWith(authority);
  const Owned<X509_STORE_CTX> context(X509_STORE_CTX_new());
  X509_STORE_CTX_init(context.get(), store.get(), certificate, nullptr);
  return X509_verify_cert(context.get()) == 1;
}

// The text of a signed document; empty if the signature is not the authority's.
std::string Verified(const std::string& path, X509* authority) {
  BIO* content = nullptr;
  const Owned<PKCS7> message(SMIME_read_PKCS7(Open(path).get(), &content));
  const Owned<BIO> owned_content(content);
  if (message == nullptr) return {};
  const Owned<X509_STORE> store = StoreWith(authority);
  const Owned<BIO> text(BIO_new(BIO_s_mem()));
  if (PKCS7_verify(message.get(), nullptr, store.get(), content, text.get(), PKCS7_TEXT) != 1) return {};
  char* data = nullptr;
  const long size = BIO_get_mem_data(text.get(), &data);
  return {data, static_cast<std::size_t>(size)};
}

unsigned Mode(const std::string& path) {
  struct stat status {};
  EXPECT_EQ(stat(path.c_str(), &status), 0) << path;
  return status.st_mode & 0777u;
}

TEST(KeyAuthorityTest, WritesIdentitiesThatItHasSigned) {
  const TemporaryFolder folder;
  ASSERT_TRUE(Authority().WriteIdentity(folder.Path("new/agent"), Role::Agent("a1")).ok());
  EXPECT_TRUE(CheckEnclave(folder.Path("new/agent")).ok());
  const Owned<X509> authority = Certificate(folder.Path("new/agent/identity_ca.cert.pem"));
  const Owned<X509> identity = Certificate(folder.Path("new/agent/cert.pem"));
  ASSERT_NE(authority, nullptr);
  ASSERT_NE(identity, nullptr);
  EXPECT_TRUE(IsIssuedBy(identity.get(), authority.get()));
  char subject[64];
  X509_NAME_get_text_by_NID(X509_get_subject_name(identity.get()), NID_commonName, subject, sizeof(subject));
  EXPECT_STREQ(subject, "troupe-agent-a1");
  const Owned<EVP_PKEY> key(
      PEM_read_bio_PrivateKey(Open(folder.Path("new/agent/key.pem")).get(), nullptr, nullptr, nullptr));
  EXPECT_EQ(X509_check_private_key(identity.get(), key.get()), 1);

  const Owned<X509> permissions_ca = Certificate(folder.Path("new/agent/permissions_ca.cert.pem"));
  const std::string permissions = Verified(folder.Path("new/agent/permissions.p7s"), permissions_ca.get());
  EXPECT_THAT(permissions, HasSubstr("<subject_name>CN=troupe-agent-a1</subject_name>"));
  EXPECT_THAT(permissions, HasSubstr("<partition>*/a1</partition>"));
  EXPECT_THAT(permissions, HasSubstr("<default>DENY</default>"));
  const std::string governance = Verified(folder.Path("new/agent/governance.p7s"), permissions_ca.get());
  EXPECT_THAT(governance, HasSubstr("<allow_unauthenticated_participants>false</allow_unauthenticated_participants>"));
}

TEST(KeyAuthorityTest, SecretsAreTheOwnersOnly) {
  const TemporaryFolder folder;
  const KeyAuthority authority = Authority();
  ASSERT_TRUE(authority.Save(folder.Path("keys/authority")).ok());
  ASSERT_TRUE(authority.WriteIdentity(folder.Path("keys/service"), Role::Service()).ok());
  for (const char* made : {"keys", "keys/authority", "keys/service"}) EXPECT_EQ(Mode(folder.Path(made)), 0700u);
  for (const char* secret : {"keys/authority/ca.key.pem", "keys/service/key.pem"}) {
    EXPECT_EQ(Mode(folder.Path(secret)), 0600u);
  }
}

TEST(KeyAuthorityTest, KeysCountFromADayAgoUntilTheirAuthorityEnds) {
  const TemporaryFolder folder;
  ASSERT_TRUE(Authority().WriteIdentity(folder.Path("service"), Role::Service()).ok());
  const Owned<X509> identity = Certificate(folder.Path("service/cert.pem"));
  const Owned<X509> authority = Certificate(folder.Path("service/identity_ca.cert.pem"));
  int days = 0;
  int seconds = 0;
  ASSERT_EQ(ASN1_TIME_diff(&days, &seconds, X509_get0_notBefore(identity.get()), nullptr), 1);
  EXPECT_EQ(days, 1);
  ASSERT_EQ(ASN1_TIME_diff(&days, &seconds, nullptr, X509_get0_notAfter(identity.get())), 1);
  EXPECT_NEAR(days, KeyAuthority::kLifetime.count(), 1);
  EXPECT_EQ(ASN1_TIME_compare(X509_get0_notAfter(identity.get()), X509_get0_notAfter(authority.get())), 0);
}

TEST(KeyAuthorityTest, AClockBeforeOrAfterTheKeysIsAnErrorWithItsHost) {
  const Validity validity = {"2026-11-27T10:00:00", "2027-02-25T10:00:00"};
  EXPECT_TRUE(CheckClock(validity, "2026-11-27T10:00:00").ok());
  EXPECT_TRUE(CheckClock(validity, "2027-02-25T09:59:59").ok());
  EXPECT_EQ(CheckClock(validity, "2026-11-25T23:00:00").error().message,
            "the keys count from 2026-11-27T10:00:00 on, but the clock of host " + HostName() +
                " says 2026-11-25T23:00:00 (UTC): expected the right time");
  EXPECT_THAT(CheckClock(validity, "2027-02-25T10:00:01").error().message, HasSubstr("until 2027-02-25T10:00:00"));
}

TEST(KeyAuthorityTest, OverwritesNothing) {
  const TemporaryFolder folder;
  const KeyAuthority authority = Authority();
  ASSERT_TRUE(authority.WriteIdentity(folder.Path("observer"), Role::Observer()).ok());
  const std::string before = folder.Read("observer/key.pem");
  const Status again = authority.WriteIdentity(folder.Path("observer"), Role::Observer());
  ASSERT_FALSE(again.ok());
  EXPECT_THAT(again.error().ToString(), HasSubstr(folder.Path("observer") + ": error: exists already"));
  EXPECT_EQ(folder.Read("observer/key.pem"), before);
  EXPECT_FALSE(authority.Save(folder.Path("observer")).ok());
  EXPECT_EQ(folder.size(), 1u) << "nothing is left of the attempts";
}

TEST(KeyAuthorityTest, ASavedAuthorityGivesMoreKeysOfTheSameKind) {
  const TemporaryFolder folder;
  const KeyAuthority made = Authority();
  ASSERT_TRUE(made.Save(folder.Path("authority")).ok());
  ASSERT_TRUE(made.WriteIdentity(folder.Path("first"), Role::Agent("a1")).ok());
  ASSERT_TRUE(ValueOf(KeyAuthority::Load(folder.Path("authority")))
                  .WriteIdentity(folder.Path("second"), Role::Agent("a2"))
                  .ok());
  for (const char* same : {"identity_ca.cert.pem", "governance.p7s"}) {
    EXPECT_EQ(folder.Read(std::string("first/") + same), folder.Read(std::string("second/") + same));
  }
}

TEST(KeyAuthorityTest, LoadNamesTheFault) {
  const TemporaryFolder folder;
  EXPECT_THAT(KeyAuthority::Load(folder.Path("none")).error().ToString(),
              HasSubstr("none/ca.key.pem: error: cannot read"));
  ASSERT_TRUE(Authority().Save(folder.Path("one")).ok());
  ASSERT_TRUE(Authority().Save(folder.Path("other")).ok());
  std::ofstream(folder.Path("one/ca.key.pem")) << folder.Read("other/ca.key.pem");
  EXPECT_THAT(KeyAuthority::Load(folder.Path("one")).error().ToString(),
              HasSubstr("the private key is not that of the certificate"));
  std::ofstream(folder.Path("one/ca.key.pem")) << "nothing";
  EXPECT_THAT(KeyAuthority::Load(folder.Path("one")).error().ToString(), HasSubstr("found no private key"));
  ASSERT_TRUE(ValueOf(KeyAuthority::Create(std::chrono::seconds(-60))).Save(folder.Path("old")).ok());
  EXPECT_THAT(KeyAuthority::Load(folder.Path("old")).error().ToString(), HasSubstr("has expired"));
}

TEST(EnclaveTest, NamesTheFileThatIsMissing) {
  const TemporaryFolder folder;
  EXPECT_THAT(CheckEnclave(folder.Path("none")).error().ToString(), HasSubstr("none: error: found no such folder"));
  ASSERT_TRUE(Authority().WriteIdentity(folder.Path("service"), Role::Service()).ok());
  std::ofstream(folder.Path("service/cert.pem"));
  EXPECT_THAT(CheckEnclave(folder.Path("service")).error().ToString(), HasSubstr("service/cert.pem: error: "));
  std::filesystem::remove(folder.Path("service/permissions.p7s"));
  std::ofstream(folder.Path("service/cert.pem")) << "x";
  const Error error = CheckEnclave(folder.Path("service")).error();
  EXPECT_THAT(error.ToString(), HasSubstr("service/permissions.p7s: error: "));
  EXPECT_EQ(error.code, ErrorCode::kBadInput);
}

TEST(AgentNameTest, DependsOnTheNamesAndNotOnTheirOrder) {
  const std::string name = AgentName({"r0", "r1"});
  EXPECT_TRUE(IsAgentName(name));
  EXPECT_EQ(name.size(), 16u);
  EXPECT_EQ(name, AgentName({"r0", "r1"}));
  EXPECT_EQ(name, AgentName({"r1", "r0"}));
  EXPECT_NE(name, AgentName({"r0r", "1"}));
  EXPECT_FALSE(IsAgentName("*"));
  EXPECT_FALSE(IsAgentName("a/b"));
  EXPECT_FALSE(IsAgentName(""));
}

}  // namespace

}  // namespace troupe::test

namespace troupe {
namespace {

namespace fs = std::filesystem;

constexpr std::uint32_t kDomain = 42;

class RunKeysFolderTest : public testing::Test {
 protected:
  RunKeysFolderTest() {
    if (const char* before = std::getenv("XDG_RUNTIME_DIR")) before_ = before;
    setenv("XDG_RUNTIME_DIR", folder_.c_str(), 1);
  }
  ~RunKeysFolderTest() override {
    before_.empty() ? unsetenv("XDG_RUNTIME_DIR") : setenv("XDG_RUNTIME_DIR", before_.c_str(), 1);
  }

  // A process makes keys, publishes them, and is killed.
  static void KillAfterPublishing(const std::string& session) {
    const pid_t child = fork();
    if (child == 0) {
      const Result<RunKeysFolder> keys = RunKeysFolder::Make();
      const Result<PublishedKeys> published =
          keys.ok() ? PublishedKeys::Publish(kDomain, session, keys.value().path()) : keys.error();
      _exit(published.ok() ? 0 : 1);  // without destructors
    }
    int status = 0;
    ASSERT_EQ(waitpid(child, &status, 0), child);
    ASSERT_EQ(status, 0);
  }
  std::ptrdiff_t CountFiles() const {
    return std::distance(fs::directory_iterator(SessionsFolder().value()), fs::directory_iterator());
  }

  const test::TemporaryFolder temporary_;
  const std::string folder_ = temporary_.path();
  std::string before_;
};

TEST_F(RunKeysFolderTest, DeletesTheKeysThatKilledProcessesHaveLeft) {
  KillAfterPublishing("first");
  ASSERT_EQ(CountFiles(), 2);
  ASSERT_EQ(FindSessionKeys(kDomain).size(), 1u);
  {
    const RunKeysFolder keys = RunKeysFolder::Make().value();
    const PublishedKeys published = PublishedKeys::Publish(kDomain, "second", keys.path()).value();
    EXPECT_EQ(CountFiles(), 2);
    EXPECT_TRUE(fs::exists(keys.path()));
    ASSERT_EQ(FindSessionKeys(kDomain).size(), 1u);
    EXPECT_EQ(FindSessionKeys(kDomain)[0].session, "second");
  }
  EXPECT_EQ(CountFiles(), 0);
}

TEST_F(RunKeysFolderTest, DeletesTheNameThatAKilledServiceHasLeft) {
  {
    const RunKeysFolder keys = RunKeysFolder::Make().value();
    std::filesystem::create_symlink(keys.path(), SessionsFolder().value() + "/42-killed");
    ASSERT_EQ(FindSessionKeys(kDomain).size(), 1u);
  }
  EXPECT_EQ(CountFiles(), 0);
}

TEST_F(RunKeysFolderTest, KeysAndTheirNamesAreDeletedWithoutMemory) {
  std::optional<RunKeysFolder> keys(RunKeysFolder::MakeWithToken().value());
  std::optional<PublishedKeys> published(PublishedKeys::Publish(kDomain, "first", keys->path()).value());
  ASSERT_EQ(CountFiles(), 2);
  EXPECT_EQ(test::StatusWithoutMemory([&] {
              published.reset();
              keys.reset();
            }),
            0);
  EXPECT_EQ(CountFiles(), 0);
}

TEST_F(RunKeysFolderTest, NamesOfKeysThatExistStay) {
  fs::create_directory(folder_ + "/keys");  // of a user, or of `troupe host`
  const PublishedKeys first = PublishedKeys::Publish(kDomain, "first", folder_ + "/keys").value();
  const PublishedKeys gone = PublishedKeys::Publish(kDomain, "gone", folder_ + "/gone").value();
  ASSERT_EQ(CountFiles(), 2);
  const PublishedKeys second = PublishedKeys::Publish(kDomain, "second", folder_ + "/keys").value();
  EXPECT_EQ(CountFiles(), 2);
  EXPECT_EQ(FindSessionKeys(kDomain).size(), 2u);
}

using testing::HasSubstr;

constexpr const char* kParticipant = "0110a1b2c3d4e5f601020304";

class RunTokenTest : public testing::Test {
 protected:
  const test::TemporaryFolder temporary_;
  const std::string folder_ = temporary_.path();
};

TEST_F(RunTokenTest, IsMadeWithoutMemory) {
  EXPECT_EQ(test::StatusWithoutMemory([] {
              if (!RunToken::Make().ok()) _exit(1);
            }),
            0);
}

TEST_F(RunTokenTest, AProofIsOfOneParticipantAndOneToken) {
  const RunToken token = RunToken::Make().value();
  const std::string proof = token.Proof(kParticipant);
  EXPECT_EQ(proof.size(), 64u);
  EXPECT_TRUE(token.Accepts(kParticipant, proof));
  EXPECT_FALSE(token.Accepts("0110a1b2c3d4e5f601020305", proof));
  EXPECT_FALSE(token.Accepts(kParticipant, proof.substr(0, 63)));
  EXPECT_FALSE(token.Accepts(kParticipant, ""));
  EXPECT_FALSE(RunToken::Make().value().Accepts(kParticipant, proof));
}

TEST_F(RunTokenTest, ReturnsFromItsFile) {
  EXPECT_FALSE(RunToken::IsIn(folder_));
  const RunToken token = RunToken::Make().value();
  ASSERT_TRUE(token.WriteTo(folder_).ok());
  EXPECT_TRUE(RunToken::IsIn(folder_));
  EXPECT_EQ(RunToken::ReadFrom(folder_).value(), token);
  const std::filesystem::path file = std::filesystem::path(folder_) / kTokenFolder / kTokenFile;
  EXPECT_EQ(std::filesystem::status(file).permissions(),
            std::filesystem::perms::owner_read | std::filesystem::perms::owner_write);
}

TEST_F(RunTokenTest, AnotherTextIsAnErrorWithItsFile) {
  ASSERT_TRUE(RunToken::Make().value().WriteTo(folder_).ok());
  for (const char* text : {"", "abc", "zz345678901234567890123456789012345678901234567890123456789012"}) {
    std::ofstream(folder_ + "/token/token.hex") << text;
    const Result<RunToken> token = RunToken::ReadFrom(folder_);
    ASSERT_FALSE(token.ok()) << text;
    EXPECT_THAT(token.error().ToString(), HasSubstr("token.hex: error: found another text"));
  }
}

// The HMAC itself is OpenSSL's.
TEST_F(RunTokenTest, TheProofIsHmacSha256) {
  std::filesystem::create_directory(folder_ + "/token");
  std::ofstream(folder_ + "/token/token.hex") << std::string(64, '0');
  // printf %s 0110a1b2c3d4e5f601020304 | openssl dgst -sha256 -mac HMAC -macopt hexkey:00...00 (32 bytes)
  EXPECT_EQ(RunToken::ReadFrom(folder_).value().Proof(kParticipant),
            "4b7bd05c2348a0968fb17ef41f524d5992d39c378c90a77788858cd6a452ab32");
}

}  // namespace
}  // namespace troupe
