#include "launcher/commands/in_process_viewer.h"

#include <fmt/format.h>

#include <chrono>
#include <cstdio>
#include <future>
#include <thread>
#include <utility>

#include "viewer/gateway/access.h"
#include "viewer/gateway/viewer_gateway.h"

namespace troupe {
namespace {

constexpr auto kLongestReply = std::chrono::seconds(10);
constexpr int kShowEndMilliseconds = 300;  // for viewers to receive the end of the run
constexpr int kLookMilliseconds = 10;

class MemoryObservation : public RunObservation {
 public:
  MemoryObservation(Transport& transport, ObserverHandler& handler) : endpoint_(transport.MakeObserverEndpoint()) {
    endpoint_->Start(handler);
  }

 private:
  std::unique_ptr<ObserverEndpoint> endpoint_;
};

class InProcessViewer final : public RunObserver, private RunLink {
 public:
  InProcessViewer(Transport& transport, std::string session) : transport_(transport), session_(std::move(session)) {}

  Status OnBegin(const RunStart& start) override {
    control_ = &start.control;
    ViewerGatewayOptions options;
    options.session = session_;
    options.token = MakeToken();
    Result<std::unique_ptr<ViewerGateway>> gateway = ViewerGateway::Start(options, *this);
    if (!gateway.ok()) {
      fmt::print(stderr, "no viewer: {}\n", gateway.error().message);
      return {};
    }
    gateway_ = std::move(gateway).value();
    fmt::print("viewer: {}\n", gateway_->Address());
    std::fflush(stdout);
    return {};
  }

  Status OnEnd() override {
    if (gateway_ == nullptr) return {};
    for (int ms = 0; ms < kShowEndMilliseconds && !gateway_->HasShownEnd(); ms += kLookMilliseconds) {
      std::this_thread::sleep_for(std::chrono::milliseconds(kLookMilliseconds));
    }
    gateway_.reset();
    return {};
  }

 private:
  Result<std::unique_ptr<RunObservation>> Observe(ObserverHandler& handler) override {
    return std::unique_ptr<RunObservation>(std::make_unique<MemoryObservation>(transport_, handler));
  }

  Result<ControlReply> Ask(const ControlRequest& request) override {
    // The reply may come after the wait.
    auto promise = std::make_shared<std::promise<ControlReply>>();
    std::future<ControlReply> reply = promise->get_future();
    control_->Request(request, [promise](const ControlReply& made) { promise->set_value(made); });
    if (reply.wait_for(kLongestReply) != std::future_status::ready) return Failure("the run has not replied in time");
    return reply.get();
  }

  Transport& transport_;
  const std::string session_;
  WorldControl* control_ = nullptr;
  std::unique_ptr<ViewerGateway> gateway_;
};

}  // namespace

std::unique_ptr<RunObserver> MakeInProcessViewer(Transport& transport, const std::string& session) {
  return std::make_unique<InProcessViewer>(transport, session);
}

}  // namespace troupe
