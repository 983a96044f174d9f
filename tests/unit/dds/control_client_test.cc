// ControlClient, with a world service of this process.
#include "transport/dds/tools/control_client.h"

#include <gtest/gtest.h>

#include <atomic>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "tests/support/dds_domain.h"
#include "transport/dds/transport/dds_service_endpoint.h"

namespace troupe {
namespace {

using test::TestConfig;
using test::TestDomain;
using test::TestSession;

// Replies to each request but steps, from the thread that has received it.
class ReplyingService : public ServiceHandler {
 public:
  explicit ReplyingService(const std::string& session) : connection_(Config(), session, {}) {
    endpoint_.emplace(std::vector<const dds::DdsConnection*>{&connection_}, false);
    endpoint_->Start(*this);
  }
  ~ReplyingService() override { endpoint_.reset(); }

  void OnJoin(const JoinMessage&) override {}
  void OnProposal(const ProposalMessage&) override {}
  void OnAgentGone(AgentId) override {}
  void OnRivalService(const SessionMessage&) override {}
  void OnControl(const ControlRequest& request) override {
    if (request.command == ControlCommand::kStep) {
      is_stepping_ = true;
      is_stepping_.notify_all();
      return;
    }
    ControlReply reply{.client = request.client, .number = request.number, .done = true};
    endpoint_->SendControlReply(reply);
    if (request.command != ControlCommand::kPlay) return;
    has_replied_ = true;
    has_replied_.notify_all();
  }

  void AwaitStep() { is_stepping_.wait(false); }
  void AwaitReply() {
    has_replied_.wait(false);
    endpoint_->Flush(20.0);
  }

 private:
  static dds::DomainConfig Config() {
    dds::DomainConfig config = TestConfig();
    config.heartbeat_seconds = 0.1;  // the service ends when its reply is acknowledged
    return config;
  }

  dds::DdsConnection connection_;
  std::optional<dds::DdsServiceEndpoint> endpoint_;
  std::atomic<bool> is_stepping_ = false;
  std::atomic<bool> has_replied_ = false;
};

NetworkSettings Network(const std::string& session) {
  NetworkSettings network{.domain = TestDomain(), .session = session, .security = kSecurityOff};
  return network;
}

TEST(ControlClient, TakesTheReplyOfAServiceThatEndsRightAfterIt) {
  for (int trial = 0; trial < 20; ++trial) {
    const std::string session = TestSession("ends-" + std::to_string(trial));
    std::optional<ReplyingService> service(session);
    ControlClient client(Network(session));
    ASSERT_TRUE(client.WaitForService(20.0).ok());
    std::thread end([&] {
      service->AwaitReply();
      service.reset();
    });
    const Result<ControlReply> reply = client.Call(ControlCommand::kPlay, 0, 20.0);
    end.join();
    ASSERT_TRUE(reply.ok()) << "trial " << trial << ": " << reply.error().message;
    EXPECT_TRUE(reply.value().done);
  }
}

TEST(ControlClient, ReportsThatAServiceEndsWithoutAReply) {
  const std::string session = TestSession("silent");
  std::optional<ReplyingService> service(session);
  ControlClient client(Network(session));
  ASSERT_TRUE(client.WaitForService(20.0).ok());
  service.reset();
  const Result<ControlReply> reply = client.Call(ControlCommand::kStatus, 0, 20.0);
  ASSERT_FALSE(reply.ok());
  EXPECT_EQ(reply.error().message, "the world service of session '" + session + "' is gone");
}

// A tool without a limit of time would wait for ever: the request is lost with the service.
TEST(ControlClient, ReportsThatAServiceEndsWithoutAReplyWhenAnotherOneContinuesTheRun) {
  const std::string session = TestSession("successor");
  std::optional<ReplyingService> service(session);
  ControlClient client(Network(session));
  ASSERT_TRUE(client.WaitForService(20.0).ok());
  std::optional<ReplyingService> successor;
  std::thread end([&] {
    service->AwaitStep();
    successor.emplace(session);
    service.reset();
  });
  const Result<ControlReply> reply = client.Call(ControlCommand::kStep, 1, 20.0);
  end.join();
  ASSERT_FALSE(reply.ok());
  EXPECT_EQ(reply.error().message, "the world service of session '" + session + "' is gone");
  EXPECT_TRUE(client.WaitForService(20.0).ok());
  EXPECT_TRUE(client.Call(ControlCommand::kStatus, 0, 20.0).ok());
}

}  // namespace
}  // namespace troupe
