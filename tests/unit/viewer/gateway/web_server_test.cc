// Clients that do not behave like a browser.
#include "viewer/gateway/web_server.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <condition_variable>
#include <fstream>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "tests/support/values.h"
#include "tests/unit/viewer/gateway/web_client.h"
#include "viewer/gateway/access.h"

namespace troupe {
namespace {

using test::WebClient;
using ::testing::HasSubstr;
using ::testing::StartsWith;

constexpr PageFile kFiles[] = {{"/", "text/html", "the page", false}, {"/viewer.js", "text/javascript", "code", false}};

// Sends each viewer `message` once, and an echo of each text.
class EchoHandler : public WebHandler {
 public:
  void OnPage() override { ++pages; }
  std::optional<WebDownload> OnDownload(std::string_view path) override {
    if (path != "/made") return std::nullopt;
    ++made;
    return WebDownload{"text/plain", std::make_shared<const std::string>("made")};
  }
  void OnOpened(WebLoop&, ViewerId viewer, std::string_view) override {
    ++open;
    const std::lock_guard lock(mutex);
    if (message) next[viewer].push_back({message, false});
  }
  void OnClosed(WebLoop&, ViewerId) override {
    --open;
    Count(closed);
  }
  bool OnMessage(WebLoop& loop, ViewerId viewer, std::string_view message_of_viewer, bool is_text) override {
    if (!is_text) return !message_of_viewer.empty();
    if (message_of_viewer == "refuse") return false;
    next[viewer].push_back({std::make_shared<const std::string>(message_of_viewer), true});
    loop.RequestMessage(viewer);
    return true;
  }
  std::optional<WebMessage> NextMessage(ViewerId viewer) override {
    Count(asked);
    if (next[viewer].empty()) return std::nullopt;
    WebMessage first = next[viewer].front();
    next[viewer].erase(next[viewer].begin());
    return first;
  }
  void OnPeriod(WebLoop&) override {}
  void OnWake(WebLoop&) override { ++woken; }

  void AwaitClosed(int count) { Await(closed, count); }
  void AwaitAsked(int count) { Await(asked, count); }  // for messages

  std::shared_ptr<const std::string> message;
  std::atomic<int> pages = 0;
  std::atomic<int> made = 0;
  std::atomic<int> open = 0;
  std::atomic<int> closed = 0;
  std::atomic<int> asked = 0;
  std::atomic<int> woken = 0;
  std::mutex mutex;
  std::condition_variable changed;
  std::map<ViewerId, std::vector<WebMessage>> next;  // of the server's thread

 private:
  void Count(std::atomic<int>& counter) {
    const std::lock_guard lock(mutex);
    ++counter;
    changed.notify_all();
  }
  void Await(const std::atomic<int>& counter, int count) {
    std::unique_lock lock(mutex);
    EXPECT_TRUE(
        changed.wait_for(lock, std::chrono::milliseconds(test::kWebDeadline), [&] { return counter >= count; }));
  }
};

class WebServerTest : public testing::Test {
 protected:
  void Serve(const std::string& token = "") {
    WebServer::Options options;
    options.access.token = token;
    options.files = kFiles;
    options.longest_text = 1000;
    server_ = test::ValueOf(WebServer::Create(options));
    server_->Serve(handler_);
  }
  // Sends each viewer more than its connection takes.
  void ServeALongMessage() {
    handler_.message = std::make_shared<const std::string>(50'000'000, 'x');
    Serve();
  }
  // The server works as on its first day.
  void ExpectHealthy() {
    WebClient client(server_->port());
    client.Upgrade();
    ASSERT_TRUE(client.SendText("hello"));
    const auto echo = client.Read();
    ASSERT_TRUE(echo.has_value());
    EXPECT_EQ(echo->content, "hello");
  }

  EchoHandler handler_;
  std::unique_ptr<WebServer> server_;
};

// 0 with sanitizers, which keep freed memory for a while.
double ResidentMib() {
#ifdef TROUPE_SANITIZED
  return 0.0;
#endif
  std::ifstream file("/proc/self/statm");
  double size = 0.0;
  double resident = 0.0;
  file >> size >> resident;
  return resident * 4096.0 / (1 << 20);
}

TEST_F(WebServerTest, ServesTheFilesOfItsTableOnly) {
  Serve();
  const std::string page = WebClient(server_->port()).Get("/");
  EXPECT_THAT(page, StartsWith("HTTP/1.1 200"));
  EXPECT_THAT(page, HasSubstr("content-security-policy: default-src 'none'"));
  EXPECT_THAT(WebClient(server_->port()).Get("/viewer.js"), HasSubstr("text/javascript"));
  for (const char* path : {"/etc/passwd", "/../etc/passwd", "/..%2f..%2fetc/passwd", "/%2e%2e/%2e%2e/etc/passwd",
                           "//etc/passwd", "/viewer.js/", "/viewer.js%00.html", "/socket", "/index.html"}) {
    EXPECT_THAT(WebClient(server_->port()).Get(path), Not(HasSubstr("200 OK"))) << path;
  }
  ExpectHealthy();
}

TEST_F(WebServerTest, RefusesOtherMethodsAndRequestsThatAreNone) {
  Serve();
  const std::string host = "Host: 127.0.0.1\r\n";
  for (const std::string& request :
       {"POST / HTTP/1.1\r\n" + host + "Content-Length: 100000000\r\n\r\nabc", "PUT / HTTP/1.1\r\n" + host + "\r\n",
        "DELETE / HTTP/1.1\r\n" + host + "\r\n", "CONNECT example.org:80 HTTP/1.1\r\n" + host + "\r\n",
        std::string("GET http://example.org/ HTTP/1.1\r\nHost: example.org\r\n\r\n"), std::string("\r\n\r\n\r\n"),
        std::string("PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n"),
        std::string("\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03garbage"), std::string(3000, '\0'),
        "GET / HTTP/1.1\r\nUpgrade: h2c\r\nConnection: Upgrade, HTTP2-Settings\r\n" + host +
            "HTTP2-Settings: AAMAAABkAAQAAP__\r\n\r\n"}) {
    WebClient client(server_->port());
    client.Send(request);
    EXPECT_THAT(client.ReadHead(), Not(HasSubstr("200 OK"))) << request.substr(0, 60);
  }
  ExpectHealthy();
}

TEST_F(WebServerTest, LongHeadersAreRefused) {
  Serve();
  WebClient client(server_->port());
  client.Send("GET / HTTP/1.1\r\nHost: 127.0.0.1\r\nCookie: " + std::string(1'000'000, 'x') + "\r\n\r\n");
  EXPECT_THAT(client.ReadHead(), Not(HasSubstr("200 OK")));
  ExpectHealthy();
}

TEST_F(WebServerTest, ANameThatPointsHereIsNoNameOfTheServer) {
  Serve();
  EXPECT_THAT(WebClient(server_->port()).Get("/", "Host: evil.example\r\n"), HasSubstr(" 403 "));
  EXPECT_THAT(WebClient(server_->port()).Get("/", ""), Not(HasSubstr("200 OK")));
}

TEST_F(WebServerTest, APageOfAnotherSiteGetsNoSocket) {
  Serve();
  WebClient client(server_->port());
  const std::string head = client.Get("/socket", WebClient::UpgradeHeaders(client.host(), "http://evil.example"));
  EXPECT_THAT(head, HasSubstr(" 403 "));
  WebClient rebound(server_->port());
  EXPECT_THAT(rebound.Get("/socket", WebClient::UpgradeHeaders("evil.example", "http://evil.example")),
              HasSubstr(" 403 "));
  EXPECT_EQ(handler_.open, 0);
}

TEST_F(WebServerTest, ASocketIsAtItsPathAndForTheProtocolOfThePage) {
  Serve();
  WebClient elsewhere(server_->port());
  EXPECT_THAT(elsewhere.Get("/", WebClient::UpgradeHeaders(elsewhere.host(), "http://" + elsewhere.host())),
              Not(StartsWith("HTTP/1.1 101")));
  WebClient other(server_->port());
  std::string headers = WebClient::UpgradeHeaders(other.host(), "http://" + other.host());
  headers = headers.substr(0, headers.find("Sec-WebSocket-Protocol"));
  EXPECT_THAT(other.Get("/socket", headers), Not(StartsWith("HTTP/1.1 101")));
  EXPECT_EQ(handler_.open, 0);
}

TEST_F(WebServerTest, ProgramsOfOtherSitesNeedTheToken) {
  const std::string foxglove = "foxglove.sdk.v1, foxglove.websocket.v1";
  const auto upgrade = [&](const std::string& path, const std::string& origin) {
    WebClient client(server_->port());
    std::string headers = WebClient::UpgradeHeaders(client.host(), origin, foxglove);
    if (origin.empty()) headers.erase(headers.find("Origin"), headers.find("Upgrade:") - headers.find("Origin"));
    return client.Get(path, headers);
  };
  Serve();
  EXPECT_THAT(upgrade("/", ""), StartsWith("HTTP/1.1 101")) << "no browser";
  EXPECT_THAT(upgrade("/", "https://evil.example"), HasSubstr(" 403 "));
  EXPECT_THAT(upgrade("/elsewhere", ""), HasSubstr(" 404 "));
  server_.reset();
  Serve("secret");
  EXPECT_THAT(upgrade("/", ""), HasSubstr(" 403 "));
  EXPECT_THAT(upgrade("/?token=secret", ""), StartsWith("HTTP/1.1 101"));
  EXPECT_THAT(upgrade("/?token=secret", "https://app.example"), StartsWith("HTTP/1.1 101"));
  // The page's protocol is for the page only, in whatever company.
  WebClient client(server_->port());
  EXPECT_THAT(client.Get("/socket?token=secret",
                         WebClient::UpgradeHeaders(client.host(), "https://app.example", "foxglove.sdk.v1, troupe")),
              HasSubstr(" 403 "));
}

TEST_F(WebServerTest, PathsWithDotsAreNoFiles) {
  Serve();
  for (const char* path : {"/../viewer.js", "/..", "/%2e%2e/etc/passwd", "/....//etc/passwd", "//etc/passwd",
                           "/viewer.js/../", "/\\..\\etc", "/viewer.js%00.html", "http://evil.example/../etc/passwd"}) {
    WebClient client(server_->port());
    EXPECT_THAT(client.Get(path), Not(HasSubstr("passwd"))) << path;
  }
  ExpectHealthy();
}

TEST_F(WebServerTest, HalfOpenSocketsAreClosedInTime) {
  Serve();
  std::vector<std::unique_ptr<WebClient>> half_open;  // of which one side has ended, or nothing was sent
  for (int i = 0; i < 2 * WebServer::kMaxConnections; ++i) {
    half_open.push_back(std::make_unique<WebClient>(server_->port()));
    if (i % 2 == 0) half_open.back()->Send("GET /");
    if (i % 4 == 1) half_open.back()->EndSending();
  }
  // They are closed after kRequestSeconds.
  for (const auto& client : half_open) EXPECT_TRUE(client->ReadAll().has_value());
  ExpectHealthy();
}

// Another user of the host can hold all connections, again and again.
TEST_F(WebServerTest, ConnectionsWithoutTheTokenKeepNoOwnerAway) {
  Serve("secret");
  std::vector<std::unique_ptr<WebClient>> idle;
  const auto flood = [&] {
    for (int i = 0; i < WebServer::kMaxConnections; ++i) idle.push_back(std::make_unique<WebClient>(server_->port()));
  };
  flood();
  EXPECT_THAT(WebClient(server_->port()).Get("/?token=secret"), StartsWith("HTTP/1.1 200"));
  WebClient viewer(server_->port());
  viewer.Upgrade("/socket?token=secret");
  flood();
  flood();
  WebClient second(server_->port());
  second.Upgrade("/socket?token=secret");
  ASSERT_TRUE(viewer.SendText("still open"));
  const auto echo = viewer.Read();
  ASSERT_TRUE(echo.has_value());
  EXPECT_EQ(echo->content, "still open");
}

TEST_F(WebServerTest, WithoutTheTokenThereIsNeitherPageNorSocket) {
  Serve("secret");
  for (const char* query : {"", "?token=", "?token=secreT", "?token=secretsecret", "?other=secret"}) {
    EXPECT_THAT(WebClient(server_->port()).Get(std::string("/") + query), HasSubstr(" 403 ")) << query;
    WebClient client(server_->port());
    EXPECT_THAT(
        client.Get(std::string("/socket") + query, WebClient::UpgradeHeaders(client.host(), "http://" + client.host())),
        HasSubstr(" 403 "))
        << query;
  }
  WebClient(server_->port()).Get("/viewer.js");
  EXPECT_EQ(handler_.pages, 0) << "a request without a token starts nothing";
  EXPECT_THAT(WebClient(server_->port()).Get("/?token=secret"), StartsWith("HTTP/1.1 200"));
  EXPECT_EQ(handler_.pages, 1);
  WebClient viewer(server_->port());
  viewer.Upgrade("/socket?token=secret");
}

// A scraper keeps the token out of the address, and knows the server by any name.
TEST_F(WebServerTest, AFileThatIsMadeOnRequestNeedsTheTokenInTheAddressOrInAHeader) {
  Serve("secret");
  const auto get = [this](const std::string& path, const std::string& host, const std::string& header) {
    return WebClient(server_->port()).Get(path, "Host: " + host + "\r\n" + header);
  };
  const std::string bearer = "Authorization: Bearer ";
  for (const std::string& refused :
       {get("/made", "localhost", ""), get("/made?token=secreT", "localhost", ""),
        get("/made", "localhost", bearer + "secreT\r\n"), get("/made", "localhost", "Authorization: secret\r\n"),
        get("/made?token=secret", "world.example", ""), get("/", "world.example", bearer + "secret\r\n")}) {
    EXPECT_THAT(refused, HasSubstr(" 403 "));
  }
  EXPECT_EQ(handler_.made, 0) << "a request without a token starts nothing";
  for (const std::string& granted :
       {get("/made?token=secret", "localhost", ""), get("/made", "world.example:8470", bearer + "secret\r\n")}) {
    EXPECT_THAT(granted, StartsWith("HTTP/1.1 200"));
    EXPECT_THAT(granted, HasSubstr("content-type: text/plain"));
  }
  EXPECT_EQ(handler_.made, 2);
  EXPECT_THAT(get("/other", "localhost", bearer + "secret\r\n"), HasSubstr(" 404 "));
}

TEST_F(WebServerTest, ABearerOpensNothingWhereNoTokenIsNeeded) {
  Serve();
  WebClient client(server_->port());
  EXPECT_THAT(client.Get("/made", "Host: world.example\r\nAuthorization: Bearer x\r\n"), HasSubstr(" 403 "));
}

TEST_F(WebServerTest, AMessageOf100MegabytesEndsTheConnectionAtOnce) {
  Serve();
  const double before = ResidentMib();
  {
    WebClient client(server_->port());
    client.Upgrade();
    // The length is announced; the content would follow.
    client.Send(WebClient::Frame(0x81, std::string(2000, 'x'), 100'000'000));
    const auto close = client.Read();
    ASSERT_TRUE(close.has_value());
    EXPECT_EQ(close->close_status(), 1009);
  }
  handler_.AwaitClosed(1);
  EXPECT_LT(ResidentMib() - before, 10.0);
  ExpectHealthy();
}

TEST_F(WebServerTest, EndlessFragmentsEndTheConnection) {
  Serve();
  {
    WebClient client(server_->port());
    client.Upgrade();
    ASSERT_TRUE(client.Send(WebClient::Frame(0x01, std::string(100, 'x'))));
    for (int i = 0; i < 1000; ++i) client.Send(WebClient::Frame(0x00, std::string(100, 'x')));
    const auto close = client.Read();
    ASSERT_TRUE(close.has_value());
    EXPECT_EQ(close->close_status(), 1009);
  }
  handler_.AwaitClosed(1);
  ExpectHealthy();
}

TEST_F(WebServerTest, FramesThatThePageDoesNotSendEndTheConnection) {
  Serve();
  int count = 0;
  for (const std::string& bytes :
       {WebClient::Frame(0x82, "binary"), WebClient::Frame(0x81, "refuse"), std::string("\x81\x05hello", 7),  // no mask
        WebClient::Frame(0xf1, "reserved bits"), WebClient::Frame(0x83, "reserved opcode"),
        WebClient::Frame(0x81, "x", 0xffffffffffffffffULL), WebClient::Frame(0x09, std::string(60, 'x')),
        WebClient::Frame(0x81, "\xff\xfe\xc0")}) {
    {
      WebClient client(server_->port());
      client.Upgrade();
      client.Send(bytes);
      client.Send(WebClient::Frame(0x81, "refuse"));  // at the latest
      // The server says goodbye, or hangs up.
      for (auto message = client.Read(); message && message->opcode != 8;) message = client.Read();
    }
    handler_.AwaitClosed(++count);
  }
  ExpectHealthy();
}

TEST_F(WebServerTest, AClientThatIsSilentIsDisconnected) {
  Serve();
  WebClient silent(server_->port());
  WebClient slow(server_->port());
  slow.Send("GET / HTTP/1.1\r\nHost: 127.0.0.1\r\nX-Slow: ");
  EXPECT_TRUE(silent.ReadAll().has_value());
  EXPECT_TRUE(slow.ReadAll().has_value());
}

TEST_F(WebServerTest, TenThousandConnectionsLeaveNothingBehind) {
  Serve();
  const auto connect = [&](int count) {
    for (int i = 0; i < count; ++i) {
      WebClient client(server_->port());
      ASSERT_TRUE(client.connected()) << i;
      if (i % 3 == 0) client.Send("GET /nothing HTTP/1.1\r\n");
      if (i % 3 == 1) client.Get("/");
    }
  };
  connect(500);
  ExpectHealthy();
  const double before = ResidentMib();
  connect(10'000);
  ExpectHealthy();
  EXPECT_LT(ResidentMib() - before, 5.0);
}

TEST_F(WebServerTest, ViewersBeyondTheLimitAreTurnedAway) {
  Serve();
  std::vector<std::unique_ptr<WebClient>> viewers;
  for (int i = 0; i < WebServer::kMaxViewers; ++i) {
    viewers.push_back(std::make_unique<WebClient>(server_->port()));
    viewers.back()->Upgrade();
  }
  WebClient late(server_->port());
  EXPECT_THAT(late.Get("/socket", WebClient::UpgradeHeaders(late.host(), "http://" + late.host())), HasSubstr(" 503 "));
  viewers.clear();
  handler_.AwaitClosed(WebServer::kMaxViewers);
  ExpectHealthy();
}

TEST_F(WebServerTest, AViewerThatDoesNotReadDelaysNoOther) {
  ServeALongMessage();
  WebClient sleeping(server_->port());
  sleeping.Upgrade();
  WebClient reading(server_->port());
  reading.Upgrade();
  const auto message = reading.Read();
  ASSERT_TRUE(message.has_value());
  EXPECT_EQ(message->content, *handler_.message);
  handler_.message.reset();
  ExpectHealthy();
  // What the sleeping one has not received is not copied: one message, in pieces.
  const auto late = sleeping.Read();
  ASSERT_TRUE(late.has_value());
  EXPECT_EQ(late->content.size(), 50'000'000u);
}

TEST_F(WebServerTest, ARefusedViewerHasTheStatusAlsoInTheMiddleOfAMessage) {
  ServeALongMessage();
  WebClient viewer(server_->port());
  viewer.Upgrade();
  handler_.AwaitAsked(1);
  ASSERT_TRUE(viewer.SendText("refuse"));
  const auto close = viewer.Read();
  ASSERT_TRUE(close.has_value());
  EXPECT_EQ(close->close_status(), 1008);
  // What it still sends is not heard, until it closes its side.
  EXPECT_TRUE(viewer.SendText("refuse"));
  EXPECT_EQ(handler_.closed, 0);
  EXPECT_TRUE(viewer.Send(WebClient::Frame(0x88, close->content)));
  handler_.AwaitClosed(1);
}

TEST_F(WebServerTest, ARefusedViewerThatDoesNotReadIsDisconnected) {
  ServeALongMessage();
  WebClient viewer(server_->port());
  viewer.Upgrade();
  handler_.AwaitAsked(1);
  ASSERT_TRUE(viewer.SendText("refuse"));
  handler_.AwaitClosed(1);
  handler_.message.reset();
  ExpectHealthy();
}

TEST_F(WebServerTest, APortInUseIsAnErrorOrReplacedByAnother) {
  Serve();
  WebServer::Options options;
  options.port = server_->port();
  options.any_port = false;
  const auto refused = WebServer::Create(options);
  ASSERT_FALSE(refused.ok());
  EXPECT_THAT(refused.error().message, HasSubstr("the port is in use"));
  options.any_port = true;
  const auto moved = test::ValueOf(WebServer::Create(options));
  EXPECT_NE(moved->port(), server_->port());
  EXPECT_NE(moved->port(), 0);
}

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
