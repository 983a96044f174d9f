#include <utility>

#include "library/simulation_impl.h"
#include "troupe/simulation.h"

namespace troupe {

Tick Snapshot::tick() const {
  return content_->state.tick;
}

Result<Snapshot::Content> Snapshot::Content::Copy() const {
  Content copy{scene, state, events, {}, commands, failures};
  copy.robots.reserve(robots.size());
  for (const std::unique_ptr<Robot>& robot : robots) {
    Result<std::unique_ptr<Robot>> clone = robot->Clone();
    if (!clone.ok()) return clone.error();
    copy.robots.push_back(std::move(clone).value());
  }
  return copy;
}

Result<Snapshot> Simulation::Save() const {
  Result<Snapshot::Content> copy = impl_->now.Copy();
  if (!copy.ok()) return copy.error();
  return Snapshot(std::make_shared<const Snapshot::Content>(std::move(copy).value()));
}

Status Simulation::Restore(const Snapshot& snapshot) {
  Result<Snapshot::Content> copy = snapshot.content_->Copy();
  if (!copy.ok()) return copy.error();
  impl_->Assign(std::move(copy).value());
  return {};
}

}  // namespace troupe
