#include "troupe/simulation_recorder.h"

#include <optional>
#include <utility>
#include <vector>

#include "common/base/identity.h"
#include "common/model/states.h"
#include "common/spatial/scene.h"
#include "library/simulation_content.h"
#include "recording/recording_writer.h"
#include "troupe/version.h"
#include "world-service/core/step.h"

namespace troupe {

// The friend of Simulation.
struct SimulationRecorder::Impl {
  Impl(RecordingWriter made, std::string path, Tick interval)
      : writer(std::move(made)), file(std::move(path)), keyframe_interval(interval) {}

  Status Begin(const Simulation& simulation);
  Status BeforeStep(const Simulation& simulation);
  Status AfterStep(const Simulation& simulation);
  Status Close();

  // Of the newest state.
  RecordedTick NextTick() const;
  FrameMessage Frame() const;
  // A state that no step has made.
  Status AddChange(const Simulation& simulation);
  Status Add(RecordedTick tick);

  RecordingWriter writer;
  const std::string file;
  const Tick keyframe_interval;
  RunId run = 0;
  std::uint64_t next_number = 0;
  Edition edition = 0;
  Edition world_edition = 0;
  Edition fresh_edition = 0;
  std::shared_ptr<const Scene> scene;       // of the newest state, which is recorded
  std::shared_ptr<const WorldState> state;  // not null after Begin
  std::uint64_t state_hash = 0;
  bool is_closed = false;
};

Status SimulationRecorder::Impl::Begin(const Simulation& simulation) {
  // A recording begins as a run does; a simulation that has another state goes on from it.
  scene = simulation.scene();
  state = std::make_shared<const WorldState>(InitialState(*scene));
  state_hash = StateHash(*state);
  RecordedTick first = NextTick();
  first.keyframe = Frame();
  if (Status failure = Add(std::move(first)); !failure.ok()) return failure;
  if (simulation.state_hash() != state_hash) return AddChange(simulation);
  state = simulation.shared_state();
  return {};
}

RecordedTick SimulationRecorder::Impl::NextTick() const {
  RecordedTick tick;
  tick.number = next_number;
  tick.tick = state->tick;
  tick.edition = edition;
  tick.state_hash = state_hash;
  return tick;
}

FrameMessage SimulationRecorder::Impl::Frame() const {
  FrameMessage frame;
  frame.run = run;
  frame.state = *state;
  frame.state_hash = state_hash;
  frame.edition = edition;
  frame.world_edition = world_edition;
  frame.fresh_edition = fresh_edition;
  return frame;
}

Status SimulationRecorder::Impl::Add(RecordedTick tick) {
  if (is_closed) return Failure("the recording " + file + " is closed");
  ++next_number;
  return writer.Add(tick);
}

Status SimulationRecorder::Impl::AddChange(const Simulation& simulation) {
  RecordedEdit edit;
  edit.before = Frame();
  edit.request = control::Rewind{simulation.tick()};
  edit.copied_from = fresh_edition;
  edit.world = simulation.world();
  scene = simulation.scene();
  state = simulation.shared_state();
  state_hash = simulation.state_hash();
  world_edition = fresh_edition = ++edition;
  edit.restored = Frame();
  RecordedTick tick = NextTick();
  tick.events = simulation.events();
  tick.edit = std::move(edit);
  return Add(std::move(tick));
}

Status SimulationRecorder::Impl::BeforeStep(const Simulation& simulation) {
  if (simulation.shared_state() == state && simulation.scene() == scene) return {};
  return AddChange(simulation);
}

Status SimulationRecorder::Impl::AfterStep(const Simulation& simulation) {
  const Simulation::Impl& content = *simulation.impl_;
  if (simulation.tick() != state->tick + 1) {
    return Failure("found tick " + std::to_string(simulation.tick()) + ", expected " + std::to_string(state->tick + 1));
  }
  state = simulation.shared_state();
  state_hash = simulation.state_hash();
  RecordedTick tick = NextTick();
  tick.proposals = content.proposals;
  tick.inputs = content.inputs;
  tick.events = simulation.events();
  if (state->tick % keyframe_interval == 0) tick.keyframe = Frame();
  return Add(std::move(tick));
}

Status SimulationRecorder::Impl::Close() {
  if (std::exchange(is_closed, true)) return {};
  return writer.Close();
}

SimulationRecorder::SimulationRecorder(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
SimulationRecorder::SimulationRecorder(SimulationRecorder&& other) noexcept = default;
SimulationRecorder& SimulationRecorder::operator=(SimulationRecorder&& other) noexcept = default;
SimulationRecorder::~SimulationRecorder() {
  if (impl_ != nullptr) static_cast<void>(impl_->Close());
}

Result<SimulationRecorder> SimulationRecorder::Create(const std::string& file, const Simulation& simulation,
                                                      const SimulationRecorderOptions& options) {
  if (options.keyframe_interval < 1) return BadInput("found a keyframe interval of 0, expected 1 or more");
  Result<std::unique_ptr<mcap::ByteSink>> sink = mcap::CreateFileSink(file);
  if (!sink.ok()) return sink.error();
  RecordedRun run;
  run.run = MakeRandomId();
  run.program_version = VersionText();
  run.step_version = kStepVersion;
  run.file = simulation.impl_->now.origin->world.path;
  run.keyframe_interval = options.keyframe_interval;
  run.world = simulation.world();
  Result<RecordingWriter> writer = RecordingWriter::Create(std::move(sink).value(), run);
  if (!writer.ok()) return writer.error();
  auto impl = std::make_unique<Impl>(std::move(writer).value(), file, options.keyframe_interval);
  impl->run = run.run;
  if (Status failure = impl->Begin(simulation); !failure.ok()) return failure.error();
  return SimulationRecorder(std::move(impl));
}

Status SimulationRecorder::BeforeStep(const Simulation& simulation) {
  return impl_->BeforeStep(simulation);
}

Status SimulationRecorder::AfterStep(const Simulation& simulation) {
  return impl_->AfterStep(simulation);
}

Status SimulationRecorder::Close() {
  return impl_->Close();
}

}  // namespace troupe
