// SceneCache: the scenes that are in use in a process, by their descriptions, so that its service, agents and viewers
// prepare a world once. A description of the service's process is the same object for all of them (WorldOf); one that
// came from another process is only equal, and has a scene of its own: comparing costs about as much as making one.
//
// Threads: any.
#pragma once

#include <memory>
#include <mutex>
#include <vector>

#include "common/spatial/scene.h"
#include "troupe/shared.h"
#include "troupe/world_description.h"

namespace troupe {

class SceneCache {
 public:
  // Find returns the scene while something else holds it.
  void Add(const std::shared_ptr<const Scene>& scene);

  // The scene of this very description; null: there is none.
  std::shared_ptr<const Scene> Find(const Shared<WorldDescription>& world) const;

 private:
  mutable std::mutex mutex_;
  std::vector<std::weak_ptr<const Scene>> scenes_;  // each once
};

}  // namespace troupe
