#include "common/spatial/scene_cache.h"

namespace troupe {

void SceneCache::Add(const std::shared_ptr<const Scene>& scene) {
  const std::lock_guard lock(mutex_);
  std::erase_if(scenes_, [&](const auto& known) { return known.expired() || known.lock() == scene; });
  scenes_.push_back(scene);
}

std::shared_ptr<const Scene> SceneCache::Find(const Shared<WorldDescription>& world) const {
  const std::lock_guard lock(mutex_);
  for (const auto& known : scenes_) {
    std::shared_ptr<const Scene> scene = known.lock();
    if (scene != nullptr && &scene->world() == &*world) return scene;
  }
  return nullptr;
}

}  // namespace troupe
