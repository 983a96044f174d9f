// StreamedRun: a simulation of another process, which has started this one and sends its states over the standard input
// (library/runs/state_stream.h), for the gateway as if it were a run. The end of the input is the end of this program.
//
// The sender (a Python notebook, a test) steps at its own pace and never waits for viewers. There is no service to be
// asked: the page shows and plots, and every request to change the run is refused.
//
// Threads: any; a thread of its own reads the input.
#pragma once

#include <memory>
#include <mutex>
#include <optional>
#include <thread>

#include "transport/protocol/messages.h"
#include "viewer/gateway/viewer_gateway.h"

namespace troupe {

class StreamedRun final : public RunLink {
 public:
  // Reads the version of the sender. The error is another one than this program's, or no sender.
  static Result<std::unique_ptr<StreamedRun>> Open(int input);
  ~StreamedRun() override;
  StreamedRun(const StreamedRun&) = delete;
  StreamedRun& operator=(const StreamedRun&) = delete;

  Result<std::unique_ptr<RunObservation>> Observe(ObserverHandler& handler) override;
  // The states that were missed are nowhere else.
  bool follows_always() const override { return true; }
  // Refused: the process that has the simulation steps it.
  Result<ControlReply> Ask(const control::Request& request) override;

 private:
  class Observation;
  explicit StreamedRun(int input);
  void Run();
  // One message; false at the end of them.
  bool Receive();

  const int input_;
  std::mutex mutex_;  // guards the next three
  ObserverHandler* handler_ = nullptr;
  std::optional<SessionMessage> session_;
  std::shared_ptr<const FrameMessage> frame_;  // null: none yet
  std::thread thread_;                         // last
};

}  // namespace troupe
