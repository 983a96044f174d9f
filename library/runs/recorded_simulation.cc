#include "troupe/recorded_simulation.h"

#include <algorithm>
#include <span>
#include <utility>
#include <vector>

#include "common/spatial/scene.h"
#include "recording/recording.h"
#include "recording/timeline/timeline.h"
#include "world-service/replay/stepped_timeline.h"

namespace troupe {
namespace {

constexpr std::size_t kMaxKeptBytes = std::size_t{64} << 20;

}  // namespace

struct RecordedSimulation::Impl {
  // The scene of a recorded world, without the controllers of its robots: their files may be elsewhere by now.
  const std::shared_ptr<const Scene>& WithoutControllers(const std::shared_ptr<const TimelineWorld>& recorded);

  WorldCache worlds;
  std::unique_ptr<SteppedTimeline> timeline;            // not null
  std::shared_ptr<const TimelineWorld> recorded_world;  // of `scene`
  std::shared_ptr<const Scene> scene;
};

const std::shared_ptr<const Scene>& RecordedSimulation::Impl::WithoutControllers(
    const std::shared_ptr<const TimelineWorld>& recorded) {
  if (recorded == recorded_world) return scene;
  WorldDescription world = recorded->description();
  // A state of a recording is for reading; a controller's memory is not recorded, so that it could not continue.
  for (RobotDescription& robot : world.robots) robot.controller = {};
  auto made = std::make_shared<Scene>(std::move(world));
  // Equal maps are shared: the ray map is a large part of a scene.
  made->ShareMap([&](std::span<const std::byte> bytes) -> std::shared_ptr<const std::byte> {
    const std::span<const std::byte> shared = recorded->scene->static_index().ray_map().bytes();
    if (!std::equal(bytes.begin(), bytes.end(), shared.begin(), shared.end())) return nullptr;
    return {recorded->scene, shared.data()};
  });
  recorded_world = recorded;
  scene = std::move(made);
  return scene;
}

RecordedSimulation::RecordedSimulation(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
RecordedSimulation::RecordedSimulation(RecordedSimulation&& other) noexcept = default;
RecordedSimulation& RecordedSimulation::operator=(RecordedSimulation&& other) noexcept = default;
RecordedSimulation::~RecordedSimulation() = default;

Result<RecordedSimulation> RecordedSimulation::Open(const std::string& file) {
  Result<Recording> recording = Recording::Open(file);
  if (!recording.ok()) return recording.error();
  auto impl = std::make_unique<Impl>();
  Result<std::unique_ptr<SteppedTimeline>> timeline =
      SteppedTimeline::Create(std::move(recording).value(), impl->worlds, kMaxKeptBytes);
  if (!timeline.ok()) return timeline.error();
  impl->timeline = std::move(timeline).value();
  return RecordedSimulation(std::move(impl));
}

std::size_t RecordedSimulation::size() const {
  return impl_->timeline->Spans()->last() + 1;
}

Tick RecordedSimulation::TickAt(std::size_t position) const {
  return impl_->timeline->Spans()->TickAt(position);
}

std::optional<std::size_t> RecordedSimulation::Find(Tick tick) const {
  return impl_->timeline->Spans()->Last(tick);
}

const std::optional<std::string>& RecordedSimulation::damage() const {
  return impl_->timeline->damage();
}

const std::string& RecordedSimulation::program_version() const {
  return impl_->timeline->recording().run().program_version;
}

const std::string& RecordedSimulation::world_file() const {
  return impl_->timeline->recording().run().file;
}

Result<Simulation> RecordedSimulation::At(std::size_t position) {
  const Result<SharedState> found = impl_->timeline->At(position);
  if (!found.ok()) return found.error();
  const TimelineState& state = *found.value();
  return Simulation::AtState(impl_->WithoutControllers(state.world), state.state,
                             state.events == nullptr ? std::vector<Event>() : StepEventsOf(*state.events));
}

}  // namespace troupe
