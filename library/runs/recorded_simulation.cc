#include "troupe/recorded_simulation.h"

#include <algorithm>
#include <deque>
#include <span>
#include <utility>
#include <vector>

#include "common/spatial/scene.h"
#include "recording/partial_recording.h"
#include "recording/recording.h"
#include "world-service/replay/state_reader.h"

namespace troupe {
namespace {

constexpr std::size_t kMaxKept = 256;
constexpr std::size_t kMaxKeptBytes = std::size_t{64} << 20;

struct KeptState {
  std::shared_ptr<const Scene> scene;
  std::shared_ptr<const WorldState> state;
  std::vector<Event> events;
};

}  // namespace

struct RecordedSimulation::Impl {
  explicit Impl(std::unique_ptr<StateReader> states) : reader(std::move(states)) {}

  void Keep(const ReplayedWorld& world);
  // The scene of a recorded world, without the controllers of its robots: their files may be elsewhere by now.
  const std::shared_ptr<const Scene>& WithoutControllers(const std::shared_ptr<const Scene>& recorded);

  const std::unique_ptr<StateReader> reader;
  std::shared_ptr<const Scene> recorded_scene;  // of `scene`
  std::shared_ptr<const Scene> scene;
  // The states that were passed last, one after another.
  std::uint64_t first_kept = 0;  // position
  std::deque<KeptState> kept;
  std::size_t kept_bytes = 0;
};

const std::shared_ptr<const Scene>& RecordedSimulation::Impl::WithoutControllers(
    const std::shared_ptr<const Scene>& recorded) {
  if (recorded == recorded_scene) return scene;
  WorldDescription world = recorded->world();
  for (RobotDescription& robot : world.robots) robot.controller = {};
  auto made = std::make_shared<Scene>(std::move(world));
  made->ShareMap([&](std::span<const std::byte> bytes) -> std::shared_ptr<const std::byte> {
    const std::span<const std::byte> shared = recorded->static_index().ray_map().bytes();
    if (!std::ranges::equal(bytes, shared)) return nullptr;
    return {recorded, shared.data()};
  });
  recorded_scene = recorded;
  scene = std::move(made);
  return scene;
}

void RecordedSimulation::Impl::Keep(const ReplayedWorld& world) {
  if (world.number() != first_kept + kept.size()) {
    kept.clear();
    kept_bytes = 0;
    first_kept = world.number();
  }
  kept.push_back(
      {WithoutControllers(world.scene()), std::make_shared<const WorldState>(world.state()), world.events()});
  kept_bytes += MemoryOf(*kept.back().state);
  while (kept.size() > kMaxKept || (kept.size() > 1 && kept_bytes > kMaxKeptBytes)) {
    kept_bytes -= MemoryOf(*kept.front().state);
    kept.pop_front();
    ++first_kept;
  }
}

RecordedSimulation::RecordedSimulation(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
RecordedSimulation::RecordedSimulation(RecordedSimulation&& other) noexcept = default;
RecordedSimulation& RecordedSimulation::operator=(RecordedSimulation&& other) noexcept = default;
RecordedSimulation::~RecordedSimulation() = default;

Result<RecordedSimulation> RecordedSimulation::Open(const std::string& file) {
  Result<Recording> recording = Recording::Open(file);
  if (!recording.ok()) return recording.error();
  Result<std::unique_ptr<StateReader>> reader = StateReader::Create({std::move(recording).value(), {}, true});
  if (!reader.ok()) return reader.error();
  return RecordedSimulation(std::make_unique<Impl>(std::move(reader).value()));
}

std::size_t RecordedSimulation::size() const {
  return impl_->reader->places().size();
}

Tick RecordedSimulation::TickAt(std::size_t position) const {
  return impl_->reader->places()[position].tick;
}

std::optional<std::size_t> RecordedSimulation::Find(Tick tick) const {
  return impl_->reader->PositionOf(tick);
}

const std::optional<std::string>& RecordedSimulation::damage() const {
  return impl_->reader->damage();
}

const std::string& RecordedSimulation::program_version() const {
  return impl_->reader->run().recording.run().program_version;
}

const std::string& RecordedSimulation::world_file() const {
  return impl_->reader->run().recording.run().file;
}

Result<Simulation> RecordedSimulation::At(std::size_t position) {
  const auto is_kept = [&] {
    return position >= impl_->first_kept && position - impl_->first_kept < impl_->kept.size();
  };
  if (!is_kept()) {
    Status failure =
        impl_->reader->Seek(position, [this](const ReplayedWorld& world, const RecordedTick&) { impl_->Keep(world); });
    if (!failure.ok()) return failure.error();
    if (!is_kept()) impl_->Keep(impl_->reader->world());  // the reader was there
  }
  const KeptState& kept = impl_->kept[position - impl_->first_kept];
  return Simulation::AtState(kept.scene, kept.state, kept.events);
}

}  // namespace troupe
