#include "world-service/service/robot_memories.h"

#include <algorithm>

namespace troupe {

void RobotMemories::OnNewRobots(const std::vector<std::string>& robots, Edition edition) {
  for (const std::string& robot : robots) spawned_[robot] = edition;
}

void RobotMemories::OnFreshStart(Edition edition) {
  fresh_edition_ = edition;
  spawned_.clear();
}

std::optional<HistoryRequest> RobotMemories::MissingFor(const JoinMessage& join, const FrameMessage& newest) const {
  // An agent makes all its robots at once, so the oldest of them decides from where it needs the states.
  Edition made = newest.edition;
  for (const std::string& robot : join.robots) {
    const auto spawned = spawned_.find(robot);
    made = std::min(made, spawned == spawned_.end() ? fresh_edition_ : spawned->second);
  }
  if (!previous_ || IsFirstOf(made, newest)) return std::nullopt;
  // A memory of before the fresh start is worthless: the robots are made again and see the whole history.
  if (!join.memory || join.memory->edition < made) return HistoryRequest{{}, made};
  // The newest state itself comes with the frame after the admission.
  if (*join.memory >= *previous_) return std::nullopt;
  return HistoryRequest{join.memory, 0};
}

}  // namespace troupe
