#include "launcher/commands/streamed_run.h"

#include <signal.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cstdio>
#include <exception>
#include <string>
#include <utility>
#include <variant>

#include "common/base/identity.h"
#include "common/base/or_failure.h"
#include "common/base/print.h"
#include "library/runs/state_stream.h"

namespace troupe {

// One observation at a time: the run has one handler.
class StreamedRun::Observation final : public RunObservation {
 public:
  explicit Observation(StreamedRun& run) : run_(run) {}
  ~Observation() override {
    const std::lock_guard lock(run_.mutex_);
    run_.handler_ = nullptr;
  }
  Observation(const Observation&) = delete;
  Observation& operator=(const Observation&) = delete;

 private:
  StreamedRun& run_;
};

// The layout of messages is not stable between versions, so that sender and receiver are of the same one.
Result<std::unique_ptr<StreamedRun>> StreamedRun::Open(int input) {
  const std::string expected = VersionText();
  const Result<StreamedMessage> first = ReceiveState(input);
  const std::string* const version = first.ok() ? std::get_if<std::string>(&first.value()) : nullptr;
  if (version == nullptr) return Error{{}, "found no states on the standard input, expected those of a simulation"};
  if (*version != expected) {
    return Error{{}, "found the states of troupe " + *version + ", expected those of " + expected};
  }
  return std::unique_ptr<StreamedRun>(new StreamedRun(input));
}

StreamedRun::StreamedRun(int input) : input_(input), thread_([this] { Run(); }) {}

// shutdown wakes the thread from its read.
StreamedRun::~StreamedRun() {
  shutdown(input_, SHUT_RDWR);
  thread_.join();
}

// The signal ends the main thread's wait as Ctrl-C does: files and sockets are closed in order.
void StreamedRun::Run() {
  try {
    const Status outcome = OrFailure([this]() -> Status {
      while (Receive()) {
      }
      return {};
    });
    if (!outcome.ok()) PrintPlain(stderr, "{}\n", outcome.error().ToString());
  } catch (const std::exception&) {  // no memory for the message either
    std::fputs("error: there is not enough memory\n", stderr);
  }
  kill(getpid(), SIGTERM);
}

bool StreamedRun::Receive() {
  Result<StreamedMessage> message = ReceiveState(input_);
  if (!message.ok() || std::holds_alternative<EndOfStream>(message.value())) return false;
  const std::lock_guard lock(mutex_);
  if (auto* const session = std::get_if<SessionMessage>(&message.value())) {
    session_ = std::move(*session);
    if (handler_ != nullptr) handler_->OnSession(*session_);
  } else if (auto* const frame = std::get_if<FrameMessage>(&message.value())) {
    frame_ = std::make_shared<const FrameMessage>(std::move(*frame));
    if (handler_ != nullptr) handler_->OnFrame(frame_);
  }
  return true;
}

// A new observer begins with the newest state; the others are gone.
Result<std::unique_ptr<RunObservation>> StreamedRun::Observe(ObserverHandler& handler) {
  const std::lock_guard lock(mutex_);
  handler_ = &handler;
  if (session_) handler.OnSession(*session_);
  if (frame_ != nullptr) handler.OnFrame(frame_);
  return std::unique_ptr<RunObservation>(std::make_unique<Observation>(*this));
}

Result<ControlReply> StreamedRun::Ask(const control::Request& request) {
  (void)request;
  return Failure("this page shows a simulation within a program, which steps it; the page cannot change it");
}

}  // namespace troupe
