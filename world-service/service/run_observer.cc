#include "world-service/service/run_observer.h"

namespace troupe {

Status RunObserver::OnBegin(const RunStart&) {
  return Status();
}

Status RunObserver::OnEnd() {
  return Status();
}

Status RunObserver::OnCommit(const CommittedTick&, const RunProgress&) {
  return {};
}

Status RunObserver::OnProgress(const RunProgress&) {
  return {};
}

Status RunObserver::OnTick(const CommittedTick&) {
  return Status();
}

bool RunObserver::IsReady() {
  return true;
}

void RunObserver::OnWorldChange(const std::shared_ptr<const Scene>&, Edition) {}

void RunObserver::OnStarted(double) {}

void RunObserver::OnStatus(const StatusMessage&) {}

void RunObserver::OnEvent(const Event&, const std::string&) {}

void RunObserver::OnNewRobots(const std::vector<std::string>&, Edition) {}

void RunObserver::OnNotice(const std::string&) {}

}  // namespace troupe
