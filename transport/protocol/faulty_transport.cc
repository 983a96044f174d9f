#include "transport/protocol/faulty_transport.h"

#include <atomic>
#include <charconv>
#include <functional>
#include <map>
#include <optional>
#include <string_view>
#include <utility>

#include "transport/protocol/delivery.h"
#include "troupe/random.h"

namespace troupe {
namespace {

// The stream of random numbers of the first observer; the others follow. An agent's stream has its id.
constexpr std::uint64_t kFirstObserverStream = std::uint64_t{1} << 63;

enum class Kind : std::uint8_t { kSession, kJoin, kAdmission, kFrame, kHistory, kProposal, kStatus };

// The faults of the messages to one endpoint. Called from one thread at a time.
class FaultyLine {
 public:
  FaultyLine(DeliveryThread& delivery, const Faults& faults, std::uint64_t stream)
      : delivery_(delivery), faults_(faults), stream_(stream), target_(delivery.AddTarget()) {}

  // No delivery runs any more when it returns.
  void Close() { delivery_.RemoveTarget(target_); }

  // Delivers now or later, once, twice or not at all.
  void Pass(Kind kind, std::function<void()> deliver) {
    // The order of the draws is fixed, so that a seed gives the same faults for the same sequence of messages.
    if (Happens(faults_.loss)) return;
    if (Happens(faults_.duplicate)) delivery_.Post(target_, deliver, Delay());
    std::function<void()>& held = postponed_[kind];
    // At most one message of a kind waits; if no further one comes, it is lost.
    if (!held && Happens(faults_.reorder)) {
      held = std::move(deliver);
      return;
    }
    delivery_.Post(target_, std::move(deliver), Delay());
    if (held) delivery_.Post(target_, std::exchange(held, nullptr), Delay());
  }
  void PassDelayed(std::function<void()> deliver) { delivery_.Post(target_, std::move(deliver), Delay()); }
  void PassIntact(std::function<void()> deliver) { delivery_.Post(target_, std::move(deliver)); }

 private:
  double Draw() { return RandomUniform({faults_.seed, stream_, draws_++}); }
  bool Happens(double probability) { return probability > 0.0 && Draw() < probability; }
  double Delay() {
    double delay = Happens(faults_.delay_probability) ? Draw() * faults_.delay_seconds : 0.0;
    if (faults_.latency_seconds > 0.0) {
      delay += faults_.latency_seconds * (1.0 + faults_.latency_jitter * (2.0 * Draw() - 1.0));
    }
    return delay;
  }

  DeliveryThread& delivery_;
  const Faults faults_;
  const std::uint64_t stream_;
  const DeliveryThread::Target target_;
  std::uint64_t draws_ = 0;
  std::map<Kind, std::function<void()>> postponed_;  // waits for the next message of its kind
};

template <typename Handler, typename Message>
std::function<void()> Delivery(Handler* handler, void (Handler::*receive)(const Message&), const Message& message) {
  return [handler, receive, shared = std::make_shared<const Message>(message)] { (handler->*receive)(*shared); };
}

class FaultyServiceEndpoint final : public ServiceEndpoint, private ServiceHandler {
 public:
  FaultyServiceEndpoint(std::unique_ptr<ServiceEndpoint> inner, DeliveryThread& delivery, const Faults& faults)
      : line_(delivery, faults, 0), inner_(std::move(inner)) {}
  ~FaultyServiceEndpoint() override {
    line_.Close();  // first, because a delivery may send
    inner_.reset();
  }

  void Start(ServiceHandler& handler) override {
    handler_ = &handler;
    inner_->Start(*this);
  }
  void SendSession(const SessionMessage& session) override { inner_->SendSession(session); }
  void SendAdmissions(const std::vector<AdmissionMessage>& admissions) override { inner_->SendAdmissions(admissions); }
  void SendFrame(const FrameMessage& frame) override { inner_->SendFrame(frame); }
  void SendHistory(const HistoryMessage& history) override { inner_->SendHistory(history); }
  void SendStatus(const StatusMessage& status) override { inner_->SendStatus(status); }
  void SendControlReply(const ControlReply& reply) override { inner_->SendControlReply(reply); }
  void Flush(double seconds) override { inner_->Flush(seconds); }

 private:
  void OnJoin(const JoinMessage& join) override {
    line_.Pass(Kind::kJoin, Delivery(handler_, &ServiceHandler::OnJoin, join));
  }
  void OnProposal(const ProposalMessage& proposal) override {
    line_.Pass(Kind::kProposal, Delivery(handler_, &ServiceHandler::OnProposal, proposal));
  }
  void OnAgentGone(AgentId agent) override {
    line_.PassIntact([handler = handler_, agent] { handler->OnAgentGone(agent); });
  }
  void OnAgentSilent(AgentId agent) override {
    line_.PassIntact([handler = handler_, agent] { handler->OnAgentSilent(agent); });
  }
  void OnRivalService(const SessionMessage& rival) override {
    line_.PassDelayed(Delivery(handler_, &ServiceHandler::OnRivalService, rival));
  }
  void OnControl(const ControlRequest& request) override {
    line_.PassIntact([handler = handler_, request] { handler->OnControl(request); });
  }
  void OnOutOfMemory() override { handler_->OnOutOfMemory(); }

  FaultyLine line_;
  ServiceHandler* handler_ = nullptr;
  std::unique_ptr<ServiceEndpoint> inner_;
};

class FaultyAgentEndpoint final : public AgentEndpoint, private AgentHandler {
 public:
  FaultyAgentEndpoint(std::unique_ptr<AgentEndpoint> inner, DeliveryThread& delivery, const Faults& faults,
                      AgentId agent)
      : line_(delivery, faults, agent), inner_(std::move(inner)) {}
  ~FaultyAgentEndpoint() override {
    line_.Close();  // first, because a delivery may send
    inner_.reset();
  }

  void Start(AgentHandler& handler) override {
    handler_ = &handler;
    inner_->Start(*this);
  }
  void SendJoin(const JoinMessage& join) override { inner_->SendJoin(join); }
  void SendProposal(const ProposalMessage& proposal) override { inner_->SendProposal(proposal); }
  std::optional<PreparedWorld> FindWorld(const WorldDescription& world) override { return inner_->FindWorld(world); }

 private:
  void OnSession(const SessionMessage& session) override {
    line_.PassDelayed(Delivery(handler_, &AgentHandler::OnSession, session));
  }
  void OnAdmission(const AdmissionMessage& admission) override {
    line_.Pass(Kind::kAdmission, Delivery(handler_, &AgentHandler::OnAdmission, admission));
  }
  void OnFrame(const FrameMessage& frame) override {
    line_.Pass(Kind::kFrame, Delivery(handler_, &AgentHandler::OnFrame, frame));
  }
  void OnHistory(const HistoryMessage& history) override {
    line_.Pass(Kind::kHistory, Delivery(handler_, &AgentHandler::OnHistory, history));
  }
  void OnServiceGone() override {
    line_.PassIntact([handler = handler_] { handler->OnServiceGone(); });
  }
  void OnServiceLost() override {
    line_.PassIntact([handler = handler_] { handler->OnServiceLost(); });
  }
  void OnOutOfMemory() override { handler_->OnOutOfMemory(); }

  FaultyLine line_;
  AgentHandler* handler_ = nullptr;
  std::unique_ptr<AgentEndpoint> inner_;
};

class FaultyObserverEndpoint final : public ObserverEndpoint, private ObserverHandler {
 public:
  FaultyObserverEndpoint(std::unique_ptr<ObserverEndpoint> inner, DeliveryThread& delivery, const Faults& faults,
                         std::uint64_t stream)
      : line_(delivery, faults, stream), inner_(std::move(inner)) {}
  ~FaultyObserverEndpoint() override {
    line_.Close();                // it posts to the queue
    if (queue_) queue_->Close();  // while the handler may still call this endpoint
    inner_.reset();
  }

  void Start(ObserverHandler& handler) override {
    queue_.emplace(handler);
    inner_->Start(*this);
  }
  void RequestFrame() override { inner_->RequestFrame(); }

 private:
  // The thread of the faults serves all endpoints, so it only posts to the queue of this observer.
  void OnSession(const SessionMessage& session) override {
    line_.PassDelayed(
        [this, shared = std::make_shared<const SessionMessage>(session)] { queue_->PostSession(shared); });
  }
  void OnFrame(const SharedFrame& frame) override {
    line_.Pass(Kind::kFrame, [this, frame] { queue_->PostFrame(frame); });
  }
  void OnStatus(const StatusMessage& status) override {
    line_.Pass(Kind::kStatus,
               [this, shared = std::make_shared<const StatusMessage>(status)] { queue_->PostStatus(shared); });
  }
  void OnServiceGone() override {
    line_.PassIntact([this] { queue_->PostServiceGone(); });
  }

  std::optional<ObserverQueue> queue_;  // once started
  FaultyLine line_;
  std::unique_ptr<ObserverEndpoint> inner_;
};

class FaultyTransport final : public Transport {
 public:
  FaultyTransport(std::unique_ptr<Transport> inner, const Faults& faults) : faults_(faults), inner_(std::move(inner)) {}

  std::unique_ptr<ServiceEndpoint> MakeServiceEndpoint() override {
    return std::make_unique<FaultyServiceEndpoint>(inner_->MakeServiceEndpoint(), delivery_, faults_);
  }
  std::unique_ptr<AgentEndpoint> MakeAgentEndpoint(AgentId agent) override {
    return std::make_unique<FaultyAgentEndpoint>(inner_->MakeAgentEndpoint(agent), delivery_, faults_, agent);
  }
  std::unique_ptr<ObserverEndpoint> MakeObserverEndpoint() override {
    return std::make_unique<FaultyObserverEndpoint>(inner_->MakeObserverEndpoint(), delivery_, faults_,
                                                    kFirstObserverStream + observers_++);
  }

 private:
  const Faults faults_;
  std::atomic<std::uint64_t> observers_ = 0;  // that were made
  std::unique_ptr<Transport> inner_;
  DeliveryThread delivery_;
};

template <typename Number>
std::optional<Number> ParseNumber(std::string_view text) {
  Number number{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return number;
}

std::optional<double> ParseProbability(std::string_view text) {
  const std::optional<double> number = ParseNumber<double>(text);
  return number && *number >= 0.0 && *number <= 1.0 ? number : std::nullopt;
}

Error FaultError(std::string_view found, const char* expected) {
  return {{}, "faults: found \"" + std::string(found) + "\", expected " + expected};
}

// One "name=value" into `faults`.
Status ParseFault(std::string_view item, Faults& faults) {
  const std::size_t equals = item.find('=');
  const std::string_view name = item.substr(0, equals);
  const std::string_view value = equals == std::string_view::npos ? std::string_view() : item.substr(equals + 1);
  if (name == "seed") {
    const auto seed = ParseNumber<std::uint64_t>(value);
    if (!seed) return FaultError(item, "seed=N with a whole number N");
    faults.seed = *seed;
    return Status();
  }
  if (name == "delay") {
    const std::size_t colon = value.find(':');
    const auto probability = ParseProbability(value.substr(0, colon));
    const auto seconds = colon == std::string_view::npos ? std::nullopt : ParseNumber<double>(value.substr(colon + 1));
    if (!probability || !seconds || !(*seconds >= 0.0 && *seconds <= 60.0)) {
      return FaultError(item, "delay=PROBABILITY:SECONDS with a probability from 0 to 1 and seconds from 0 to 60");
    }
    faults.delay_probability = *probability;
    faults.delay_seconds = *seconds;
    return Status();
  }
  if (name == "latency") {
    const std::size_t colon = value.find(':');
    const auto seconds = ParseNumber<double>(value.substr(0, colon));
    const auto jitter = colon == std::string_view::npos ? 0.0 : ParseProbability(value.substr(colon + 1));
    if (!seconds || !(*seconds >= 0.0 && *seconds <= 60.0) || !jitter) {
      return FaultError(item, "latency=SECONDS:JITTER with seconds from 0 to 60 and a jitter from 0 to 1");
    }
    faults.latency_seconds = *seconds;
    faults.latency_jitter = *jitter;
    return Status();
  }
  double* const probability = name == "loss"        ? &faults.loss
                              : name == "duplicate" ? &faults.duplicate
                              : name == "reorder"   ? &faults.reorder
                                                    : nullptr;
  if (probability == nullptr) return FaultError(item, "loss, duplicate, reorder, delay, latency or seed");
  const auto parsed = ParseProbability(value);
  if (!parsed) return FaultError(item, "a probability from 0 to 1 after the equals sign");
  *probability = *parsed;
  return Status();
}

}  // namespace

Result<Faults> ParseFaults(const std::string& text) {
  Faults faults;
  std::string_view rest = text;
  while (!rest.empty()) {
    const std::size_t comma = rest.find(',');
    if (Status error = ParseFault(rest.substr(0, comma), faults); !error.ok()) return error.error();
    rest = comma == std::string_view::npos ? std::string_view() : rest.substr(comma + 1);
  }
  return faults;
}

std::unique_ptr<Transport> MakeFaultyTransport(std::unique_ptr<Transport> inner, const Faults& faults) {
  return std::make_unique<FaultyTransport>(std::move(inner), faults);
}

}  // namespace troupe
