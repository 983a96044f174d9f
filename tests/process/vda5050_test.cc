// `troupe run --vda5050` with Debian's broker on the loopback interface: the test is the fleet control.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "fleet/codec.h"
#include "fleet/state_message.h"
#include "launcher/process/local_broker.h"
#include "tests/process/programs.h"
#include "tests/support/files.h"
#include "transport/mqtt/mqtt_connections.h"

namespace troupe::test {
namespace {

using testing::HasSubstr;

constexpr char kCart[] = "uagv/v2/Troupe/cart_1/";

std::string ScenarioPath() {
  return std::string(std::getenv("TROUPE_SOURCE_DIR")) + "/worlds/scenarios/vda5050.json";
}

// An order of version 2.1 along y = 0 for a vehicle that stands at x = -3.
std::string OrderTo(double x) {
  fleet::Order order;
  order.header = {1, "2026-01-01T00:00:00.00Z", "2.1.0", "Troupe", "cart_1"};
  order.order_id = "o1";
  for (std::uint32_t i = 0; i < 2; ++i) {
    fleet::Node node;
    node.id = i == 0 ? "from" : "to";
    node.sequence_id = 2 * i;
    node.released = true;
    node.position.emplace();
    node.position->x = i == 0 ? -3.0 : x;
    node.position->map_id = "hall";
    order.nodes.push_back(node);
  }
  fleet::Edge edge;
  edge.id = "e";
  edge.sequence_id = 1;
  edge.released = true;
  edge.start_node_id = "from";
  edge.end_node_id = "to";
  order.edges = {edge};
  return fleet::Encode(order, fleet::Version::k2_1);
}

// The side of the fleet control, as another program has it.
class FleetClient {
 public:
  explicit FleetClient(const std::string& url) : connections_(mqtt::ParseBrokerUrl(url).value()) {
    client_ = connections_.Add({.id = {}, .subscriptions = {"uagv/v2/Troupe/#", "troupe/lockstep/tick"}}).value();
    EXPECT_TRUE(Await([&] { return connections_.IsConnected(client_); }));
  }

  void Send(const std::string& topic, const std::string& text) {
    EXPECT_TRUE(connections_.Publish(client_, {topic, text, 1}));
  }

  // Receives until it is true; false after the longest time to an answer.
  bool Await(const std::function<bool()>& is_true) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(kSeconds);
    while (!is_true()) {
      if (std::chrono::steady_clock::now() > end) return false;
      for (const mqtt::Event& event : connections_.Wait(0.1)) {
        if (const auto* const received = std::get_if<mqtt::Received>(&event)) Receive(received->message);
      }
    }
    return true;
  }

  // Of cart_1.
  const std::optional<fleet::State>& state() const { return state_; }
  bool HasError(const std::string& type) const {
    return state_ && std::any_of(state_->errors.begin(), state_->errors.end(),
                                 [&](const fleet::VehicleError& error) { return error.type == type; });
  }
  const std::string& connection() const { return connection_; }
  bool has_factsheet() const { return has_factsheet_; }
  // Sent as an answer to the first state of cart_1.
  void AnswerFirstState(const std::string& order) { answer_ = order; }

 private:
  void Receive(const mqtt::Message& message) {
    if (message.topic == "troupe/lockstep/tick") {
      connections_.Publish(client_, {"troupe/lockstep/done", message.payload, 1});
    }
    if (message.topic == std::string(kCart) + "connection") connection_ = message.payload;
    if (message.topic == std::string(kCart) + "factsheet") has_factsheet_ = true;
    if (message.topic != std::string(kCart) + "state") return;
    const fleet::Decoded<fleet::State> decoded = fleet::Decode<fleet::State>(message.payload, fleet::Version::k2_1);
    EXPECT_TRUE(decoded.ok()) << message.payload;
    state_ = decoded.message;
    if (answer_.empty()) return;
    connections_.Publish(client_, {std::string(kCart) + "order", answer_, 1});
    answer_.clear();
  }

  mqtt::Connections connections_;
  std::size_t client_ = 0;
  std::optional<fleet::State> state_;
  std::string connection_;
  bool has_factsheet_ = false;
  std::string answer_;
};

class Vda5050RunTest : public testing::Test {
 protected:
  void SetUp() override {
    Result<std::unique_ptr<LocalBroker>> broker = LocalBroker::Start(folder_.Path(""));
    if (!broker.ok() && broker.error().message.find("no program mosquitto") != std::string::npos) {
      GTEST_SKIP() << "mosquitto is not installed";
    }
    ASSERT_TRUE(broker.ok()) << broker.error().message;
    broker_ = std::move(broker).value();
  }

  std::vector<std::string> Arguments(const std::vector<std::string>& more) const {
    std::vector<std::string> arguments = {"run", ScenarioPath(), "--headless", "--vda5050", broker_->Url()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }

  TemporaryFolder folder_;
  std::unique_ptr<LocalBroker> broker_;
};

TEST_F(Vda5050RunTest, AFleetControlDrivesAVehicle) {
  const std::string recording = folder_.Path("run.mcap");
  Program run = Troupe(Arguments({"--speed", "5", "--record", recording}));
  FleetClient fleet(broker_->Url());
  ASSERT_TRUE(fleet.Await([&] { return fleet.state() && fleet.has_factsheet(); })) << run.output();
  EXPECT_THAT(fleet.connection(), HasSubstr("ONLINE"));
  fleet.Send(std::string(kCart) + "order", OrderTo(-1.0));
  ASSERT_TRUE(fleet.Await([&] { return fleet.state()->last_node_id == "to" && !fleet.state()->driving; }));
  EXPECT_NEAR(fleet.state()->position->x, -1.0, 0.03);

  // What is wrong is told, and goes on.
  fleet.Send(std::string(kCart) + "order", "{\"orderId\":");
  ASSERT_TRUE(fleet.Await([&] { return !fleet.state()->errors.empty(); }));
  EXPECT_EQ(fleet.state()->errors.front().type, "validationError");
  fleet.Send("uagv/v2/Troupe/cart_9/order", OrderTo(0.0));
  EXPECT_THAT(run.WaitForLine("cart_9"), HasSubstr("which is of no vehicle of this run"));
  fleet.Send(std::string(kCart) + "order", std::string(300'000, 'x'));
  EXPECT_THAT(run.WaitForLine("300000 bytes"), HasSubstr("cart_1"));
  fleet.Send(std::string(kCart) + "instantActions", std::string(std::size_t{10} << 20, ' '));
  // The client sends the rest of so long a message while it waits.
  ASSERT_TRUE(fleet.Await([&] { return run.HasPrinted("instantActions for cart_1 of 10485760 bytes"); }))
      << run.output();
  ASSERT_TRUE(fleet.Await([&] { return fleet.HasError("INVALID_INSTANT_ACTION"); }));

  run.Interrupt();
  ASSERT_TRUE(fleet.Await([&] { return fleet.connection().find("OFFLINE") != std::string::npos; }));
  // Without the broker.
  broker_.reset();
  EXPECT_THAT(OutputOf(Troupe({"replay", recording})), HasSubstr("replayed"));
}

TEST_F(Vda5050RunTest, AVehicleThatLosesTheBrokerGoesOn) {
  Program run = Troupe(Arguments({"--speed", "5"}));
  FleetClient fleet(broker_->Url());
  ASSERT_TRUE(fleet.Await([&] { return fleet.state().has_value(); })) << run.output();
  broker_.reset();
  EXPECT_THAT(run.WaitForLine("cart_1 has lost the broker"), HasSubstr("tries to reach it again"));
  EXPECT_FALSE(run.HasEnded());
  run.Interrupt();
}

TEST_F(Vda5050RunTest, AFleetControlInLockstepMakesEqualRuns) {
  std::vector<std::string> hashes;
  for (const char* const way : {"--in-process", "--robots-per-process=1"}) {
    const std::string log = folder_.Path("hashes");
    FleetClient fleet(broker_->Url());
    fleet.AnswerFirstState(OrderTo(0.0));
    Program run = Troupe(Arguments({way, "--ticks", "200", "--speed", hashes.empty() ? "max" : "20", "--vda5050-wait",
                                    "lockstep", "--hash-log", log}));
    ASSERT_TRUE(fleet.Await([&] { return run.HasEnded(); }));
    EXPECT_EQ(run.Wait(), 0) << run.output();
    EXPECT_EQ(fleet.state()->last_node_id, "to");
    hashes.push_back(folder_.Read("hashes"));
  }
  EXPECT_FALSE(hashes[0].empty());
  EXPECT_EQ(hashes[0], hashes[1]);
}

TEST_F(Vda5050RunTest, ARunInLockstepSaysThatItWaitsForAFleetControl) {
  Program run = Troupe(Arguments({"--in-process", "--vda5050-wait", "lockstep", "--ticks", "20"}));
  EXPECT_THAT(run.WaitForLine("waits for a fleet control"), HasSubstr("VDA 5050: tick 0 waits"));
  FleetClient fleet(broker_->Url());  // late
  ASSERT_TRUE(fleet.Await([&] { return run.HasEnded(); }));
  EXPECT_EQ(run.Wait(), 0) << run.output();
}

TEST_F(Vda5050RunTest, ARunThatWaitsForQuietGoesOn) {
  Program run = Troupe(Arguments({"--in-process", "--vda5050-wait", "1", "--ticks", "20"}));
  EXPECT_EQ(run.Wait(), 0) << run.output();
}

TEST(Vda5050Options, AreRefusedWithOneLine) {
  const auto refusal = [](const std::vector<std::string>& more, int status) {
    std::vector<std::string> arguments = {"run", ScenarioPath(), "--headless"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return OutputOf(Troupe(arguments), status);
  };
  EXPECT_THAT(refusal({"--vda5050", "http://x"}, 2), HasSubstr("expected mqtt://HOST[:PORT]"));
  EXPECT_THAT(refusal({"--vda5050", "mqtt://x:0"}, 2), HasSubstr("the port '0'"));
  EXPECT_THAT(refusal({"--vda5050", "mqtt://127.0.0.1", "--vda5050-user", "/none"}, 2), HasSubstr("/none"));
  EXPECT_THAT(refusal({"--vda5050-wait", "5"}, 2), HasSubstr("--vda5050"));
  EXPECT_THAT(refusal({"--vda5050", "mqtt://127.0.0.1", "--vda5050-wait", "soon"}, 2),
              HasSubstr("found 'soon', expected a number from 0, or lockstep"));
  EXPECT_THAT(OutputOf(Troupe({"run", WorldPath("pen.world"), "--headless", "--vda5050", "mqtt://127.0.0.1"}), 2),
              HasSubstr("the world has no vehicle"));
  // Settings of vehicles.
  const TemporaryFolder folder;
  const auto refusal_of = [&](const std::string& first, const std::string& second) {
    const std::string world = std::string(std::getenv("TROUPE_SOURCE_DIR")) + "/worlds/fleet_hall.world";
    const std::string text = R"({"world": ")" + world + R"(", "robots": [
      {"name": "cart_1", "controller": {"name": "vda5050", "parameters": )" +
                             first + R"(}},
      {"name": "cart_2", "controller": {"name": "vda5050", "parameters": )" +
                             second + "}}]}";
    return OutputOf(Troupe({"run", folder.Write("run.json", text), "--headless", "--vda5050", "mqtt://127.0.0.1:1"}),
                    2);
  };
  EXPECT_THAT(refusal_of(R"({"version": "4.0"})", "{}"), HasSubstr("expected 2.0, 2.1 or 3.0"));
  EXPECT_THAT(refusal_of(R"({"serial_number": "a/b"})", "{}"), HasSubstr("the serial_number 'a/b'"));
  EXPECT_THAT(refusal_of(R"({"epoch": "noon"})", "{}"), HasSubstr("the epoch 'noon'"));
  EXPECT_THAT(refusal_of(R"({"serial_number": "1"})", R"({"serial_number": "1"})"), HasSubstr("have the same topics"));
}

}  // namespace
}  // namespace troupe::test
