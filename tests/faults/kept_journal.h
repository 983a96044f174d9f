// KeptJournal: the part of a run's journal that a service needs to continue it, in memory.
#pragma once

#include <functional>
#include <memory>
#include <optional>

#include "world-service/service/run_history.h"
#include "world-service/service/run_observer.h"

namespace troupe::faults {

class KeptJournal final : public RunObserver {
 public:
  explicit KeptJournal(const std::shared_ptr<const Scene>& scene) : original_(scene), scene_(scene) {}

  // Called once after the next commit.
  void SetOnCommit(std::function<void()> call) { on_commit_ = std::move(call); }

  ResumedRun Resume(RunId run) const {
    return {.run = run,
            .incarnation = incarnation_ + 1,
            .original = original_,
            .scene = scene_,
            .frame = frame_,
            .progress = progress_};
  }
  // Another service continues.
  void SetIncarnation(Incarnation incarnation) { incarnation_ = incarnation; }

  Status OnCommit(const CommittedTick& tick, const RunProgress& progress) override {
    frame_ = tick.frame;
    progress_ = progress;
    if (tick.edit != nullptr && tick.edit->request.command == ControlCommand::kLoadWorld) original_ = scene_;
    if (on_commit_) std::exchange(on_commit_, nullptr)();
    return {};
  }
  Status OnProgress(const RunProgress& progress) override {
    progress_ = progress;
    return {};
  }
  void OnWorldChange(const std::shared_ptr<const Scene>& scene, Edition) override { scene_ = scene; }

 private:
  std::shared_ptr<const Scene> original_;
  std::shared_ptr<const Scene> scene_;
  std::optional<FrameMessage> frame_;
  RunProgress progress_;
  Incarnation incarnation_ = 0;
  std::function<void()> on_commit_;
};

}  // namespace troupe::faults
