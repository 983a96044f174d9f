#include "viewer/gateway/access.h"

#include <gtest/gtest.h>

namespace troupe {
namespace {

AccessRules Local(const std::string& token = "") {
  return {.loopback_only = true, .names = {}, .token = token};
}

AccessRules Remote() {
  return {.loopback_only = false, .names = {"bench7"}, .token = "secret"};
}

TEST(AccessTest, ALocalGatewayServesAllLocalAddressesAtAnyForwardedPort) {
  for (const char* host : {"127.0.0.1:8470", "localhost:8470", "LOCALHOST:9000", "127.0.0.1", "127.1.2.3:1"}) {
    EXPECT_EQ(Local().ForPage(host, ""), Access::kGranted) << host;
  }
}

TEST(AccessTest, ANameThatASitePointsAtThisMachineIsRefused) {
  for (const char* host : {"evil.example:8470", "127.0.0.1.evil.example:8470", "", ":", "192.168.1.7:8470",
                           "localhost.evil.example", "bench7:8470"}) {
    EXPECT_EQ(Local().ForPage(host, ""), Access::kWrongHost) << host;
    EXPECT_EQ(Local().ForSocket(host, std::string("http://") + host, ""), Access::kWrongHost) << host;
  }
}

TEST(AccessTest, ARemoteGatewayServesAddressesAndItsOwnNameOnly) {
  for (const char* host : {"192.168.1.7:8470", "bench7:8470", "localhost:8470"}) {
    EXPECT_EQ(Remote().ForPage(host, "secret"), Access::kGranted) << host;
  }
  EXPECT_EQ(Remote().ForPage("evil.example:8470", "secret"), Access::kWrongHost);
}

TEST(AccessTest, TheTokenMustBeTheWholeToken) {
  for (const char* token : {"", "s", "secreT", "secret2", "SECRET"}) {
    EXPECT_EQ(Remote().ForPage("192.168.1.7:8470", token), Access::kWrongToken) << token;
    EXPECT_EQ(Local("secret").ForPage("localhost:8470", token), Access::kWrongToken) << token;
  }
}

TEST(AccessTest, ASocketIsOnlyForThePageOfThisHost) {
  const std::string host = "127.0.0.1:8470";
  EXPECT_EQ(Local().ForSocket(host, "http://127.0.0.1:8470", ""), Access::kGranted);
  EXPECT_EQ(Local().ForSocket(host, "https://127.0.0.1:8470", ""), Access::kGranted);
  for (const char* origin : {"", "null", "http://evil.example", "http://127.0.0.1:9", "http://localhost:8470",
                             "file://", "http://127.0.0.1:8470.evil.example", "127.0.0.1:8470"}) {
    EXPECT_EQ(Local().ForSocket(host, origin, ""), Access::kWrongOrigin) << origin;
  }
}

TEST(AccessTest, TokensAreLongAndDiffer) {
  EXPECT_EQ(MakeToken().size(), 32u);
  EXPECT_NE(MakeToken(), MakeToken());
}

TEST(AccessTest, LoopbackAddressesAreRecognized) {
  EXPECT_TRUE(IsLoopback("127.0.0.1"));
  EXPECT_TRUE(IsLoopback("127.255.0.9"));
  for (const char* address : {"0.0.0.0", "128.0.0.1", "10.0.0.127", "localhost", "", "127.0.0.1.example"}) {
    EXPECT_FALSE(IsLoopback(address)) << address;
  }
}

}  // namespace
}  // namespace troupe
