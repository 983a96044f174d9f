#include "transport/shared_memory/world_image.h"

#include <algorithm>
#include <bit>
#include <map>
#include <mutex>
#include <new>
#include <utility>
#include <variant>
#include <vector>

namespace troupe {
namespace {

struct Root {
  explicit Root(Shared<WorldDescription> description) : scene(std::move(description)), hash(Hash(scene.world())) {}
  Scene scene;
  std::uint64_t hash;
};

// The copy of a part that several have in common, once for those that follow each other closely: else it costs memory.
template <typename T>
class Copies {
 public:
  std::shared_ptr<const T> Of(const T& part) {
    const std::size_t first = copies_.size() - std::min(copies_.size(), kSought);
    for (std::size_t i = copies_.size(); i > first; --i) {
      if (copies_[i - 1].first == &part) return copies_[i - 1].second;
    }
    return copies_.emplace_back(&part, std::make_shared<const T>(part)).second;
  }

 private:
  static constexpr std::size_t kSought = 16;  // as many kinds of robots as a world may have in turn
  std::vector<std::pair<const T*, std::shared_ptr<const T>>> copies_;
};

// A copy that has no part in common with another world.
WorldDescription DetachedCopy(const WorldDescription& world) {
  WorldDescription copy = world;
  Copies<std::vector<RaySensorDescription>> ray_sensors;
  for (RobotDescription& robot : copy.robots) {
    for (SensorDescription& sensor : robot.sensors) {
      auto* const ranger = std::get_if<RangerParameters>(&sensor.parameters);
      if (ranger != nullptr) ranger->ray_sensors = ray_sensors.Of(*ranger->ray_sensors);
    }
  }
  Copies<DenseCover> covers;
  for (Shape& shape : copy.shapes) {
    if (shape.area) {
      shape.area = PixelArea(covers.Of(shape.area->cover()), shape.area->x(), shape.area->y(), shape.area->X_MA());
    }
  }
  return copy;
}

// The scenes of all images that are attached in this process, one for each, whichever agents use it.
std::mutex scenes_mutex;
std::map<const Scene*, std::weak_ptr<const Scene>>& Scenes() {
  static auto* const scenes = new std::map<const Scene*, std::weak_ptr<const Scene>>();  // for users that end later
  return *scenes;
}

// The scene in a mapping, which ends with all that is in it. The parts that this process makes are in memory of its own
// and end with the last user.
std::shared_ptr<const Scene> SceneIn(std::shared_ptr<const MappedMemory> memory, const Scene* scene) {
  const std::lock_guard lock(scenes_mutex);
  std::weak_ptr<const Scene>& known = Scenes()[scene];
  if (std::shared_ptr<const Scene> found = known.lock()) return found;
  const auto end = [memory = std::move(memory)](const Scene* used) {
    const std::lock_guard ending(scenes_mutex);
    const auto entry = Scenes().find(used);
    if (entry == Scenes().end() || !entry->second.expired()) return;  // attached again meanwhile
    Scenes().erase(entry);
    used->FreeMadeParts();
  };
  std::shared_ptr<const Scene> attached(scene, end);
  known = attached;
  return attached;
}

}  // namespace

Result<std::unique_ptr<WorldImage>> WorldImage::Make(const Shared<WorldDescription>& world) {
  if (Status status = Validate(*world); !status.ok()) return status.error();
  Result<PlacedMemory> memory = PlacedMemory::Create("troupe-world");
  if (!memory.ok()) return memory.error();
  std::unique_ptr<WorldImage> image(new WorldImage(std::move(memory).value()));
  SharedArena arena(image->memory_, 0, kPlaceBytes);
  try {
    const SharedArena::Scope scope(arena);
    const auto* const root = new Root(DetachedCopy(*world));
    image->root_ = root;
    image->scene_ = &root->scene;
  } catch (const std::bad_alloc&) {
    // What was made so far ends with the memory.
    return Failure("no memory for the world");
  }
  image->bytes_ = arena.end();
  return image;
}

WorldImagePlace WorldImage::place() const {
  return {static_cast<std::uint32_t>(memory_.memory.descriptor()), reinterpret_cast<std::uintptr_t>(memory_.begin),
          bytes_, reinterpret_cast<std::uintptr_t>(root_)};
}

Result<PreparedWorld> AttachWorld(pid_t owner, const WorldImagePlace& place) {
  const bool is_inside =
      place.root >= place.place && place.root - place.place + sizeof(Root) <= place.bytes && place.bytes <= kPlaceBytes;
  if (!is_inside) return Failure("the world service shares no memory with the world");
  auto memory =
      SharedMemory::Open(owner, static_cast<int>(place.descriptor), kPlaceBytes, SharedMemory::Peers::kMayRead);
  if (!memory.ok()) return memory.error();
  auto mapped = Attach(memory.value(), place.place, place.bytes, Attachment::kCopyOnWrite);
  if (!mapped.ok()) return mapped.error();
  auto* const root = std::bit_cast<const Root*>(place.root);
  return PreparedWorld{SceneIn(std::move(mapped).value(), &root->scene), root->hash};
}

}  // namespace troupe
