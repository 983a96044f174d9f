#include "world-service/replay/replayed_world.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "common/geometry/limits.h"
#include "common/model/states.h"
#include "common/spatial/check_order.h"
#include "world-service/core/step.h"
#include "world-service/service/apply_edit.h"

namespace troupe {
namespace {

// Stepping on is quicker than starting at a keyframe for at most this many states.
constexpr std::uint64_t kStepOn = 100;

Error BadState(const std::string& problem) {
  return {{}, "found a state with " + problem};
}

bool IsWithin(const Pose& pose) {
  return std::abs(pose.x) <= kMaxMagnitude && std::abs(pose.y) <= kMaxMagnitude && std::abs(pose.z) <= kMaxMagnitude &&
         std::abs(pose.heading) <= std::numbers::pi;
}

bool IsWithin(const Twist& twist) {
  return std::abs(twist.vx) <= kMaxMagnitude && std::abs(twist.vy) <= kMaxMagnitude &&
         std::abs(twist.wz) <= kMaxMagnitude;
}

// The object that a model is a part of, by model.
std::vector<std::optional<std::size_t>> ObjectsOfModels(const WorldDescription& world) {
  std::vector<std::optional<std::size_t>> objects(world.models.size());
  for (std::size_t i = 0; i < world.objects.size(); ++i) objects[world.objects[i].index()] = i;
  for (std::size_t i = 0; i < world.models.size(); ++i) {
    const std::optional<ModelId>& parent = world.models[i].parent;
    if (parent && !objects[i]) objects[i] = objects[parent->index()];  // a parent's id is smaller
  }
  return objects;
}

// Whether supports form a cycle. A step moves an object with its support, along the chain; a cycle would never end.
// Linear: objects whose chain was followed to its end are marked, and end the chains that reach them.
bool HasCycle(const WorldDescription& world, const WorldState& state) {
  const std::vector<std::optional<std::size_t>> object_of = ObjectsOfModels(world);
  std::vector<bool> checked(state.objects.size(), false);
  for (std::size_t i = 0; i < state.objects.size(); ++i) {
    std::size_t steps = 0;
    for (std::optional<std::size_t> at = i; at && !checked[*at];) {
      if (++steps > state.objects.size()) return true;
      const std::optional<ModelId>& support = state.objects[*at].support;
      at = support ? object_of[support->index()] : std::nullopt;
    }
    for (std::optional<std::size_t> at = i; at && !checked[*at];) {
      checked[*at] = true;
      const std::optional<ModelId>& support = state.objects[*at].support;
      at = support ? object_of[support->index()] : std::nullopt;
    }
  }
  return false;
}

// Success if a step may start from a recorded state: CheckState, poses and joints within their bounds, and no cycle of
// objects that support each other.
Status CheckStartState(const WorldDescription& world, const WorldState& state) {
  if (Status problem = CheckState(world, state); !problem.ok()) return problem;
  for (const RobotState& robot : state.robots) {
    if (!IsWithin(robot.X_WR) || !IsWithin(robot.twist)) return BadState("a robot beyond the bounds of a world");
  }
  for (std::size_t i = 0; i < state.joints.size(); ++i) {
    const Interval& bounds = world.joints[i].position;
    const double position = state.joints[i].position;
    // Joints are clamped in floating point by the step, which may leave them a rounding error beyond their bounds.
    const double slack = 1e-6 * (1.0 + std::abs(bounds.min) + std::abs(bounds.max));
    if (position < bounds.min - slack || position > bounds.max + slack) return BadState("a joint beyond its bounds");
  }
  for (const PersonState& person : state.people) {
    if (!IsWithin(person.X_WP) || !IsWithin(Twist{person.vx, person.vy, 0.0})) {
      return BadState("a person beyond the bounds of a world");
    }
  }
  for (const ObjectState& object : state.objects) {
    if (!IsWithin(object.X_WO) || std::abs(object.fall_speed) > kMaxMagnitude) {
      return BadState("an object beyond the bounds of a world");
    }
    if (object.support && object.mode != ObjectMode::kResting)
      return BadState("a support of an object that does not rest");
  }
  for (std::size_t i = 0; i < state.objects.size(); ++i) {
    const std::optional<GripperId>& holder = state.objects[i].holder;
    if (holder && state.grippers[holder->index()].clamped != ObjectId(i)) {
      return BadState("an object whose gripper does not hold it");
    }
  }
  if (HasCycle(world, state)) return BadState("objects that support each other");
  return {};
}

// The model of each row of a kind, as far as the rows belong to models.
template <typename Row>
std::vector<ModelId> ModelsOf(const WorldDescription& world) {
  std::vector<ModelId> models;
  const auto add = [&](const auto& places, const auto& model_of) {
    for (const auto& place : places) models.push_back(model_of(place));
  };
  const auto robot_of = [&](const SensorPlace& place) { return world.robot(place.robot).root; };
  if constexpr (std::is_same_v<Row, RobotState>) add(world.robots, [](const auto& robot) { return robot.root; });
  if constexpr (std::is_same_v<Row, JointState>) add(world.joints, [](const auto& joint) { return joint.model; });
  if constexpr (std::is_same_v<Row, GripperState>) add(world.grippers, [](const auto& g) { return g.model; });
  if constexpr (std::is_same_v<Row, ObjectState>) models = world.objects;
  if constexpr (std::is_same_v<Row, StoreState>) models = FindStores(world);
  if constexpr (std::is_same_v<Row, ImuState>) add(FindImus(world), robot_of);
  if constexpr (std::is_same_v<Row, LightState>) add(FindLights(world), [](const auto& light) { return light.model; });
  if constexpr (std::is_same_v<Row, CameraState>) add(FindCameras(world), robot_of);
  if constexpr (std::is_same_v<Row, DoorState>) add(world.doors, [](const auto& door) { return door.model; });
  if constexpr (std::is_same_v<Row, LiftState>) add(world.lifts, [](const auto& lift) { return lift.model; });
  if constexpr (std::is_same_v<Row, PersonState>) add(world.people, [](const auto& person) { return person.root; });
  return models;
}

class ValueText {
 public:
  explicit ValueText(const WorldDescription& world) : world_(world) {}

  std::string operator()(double number) const { return fmt::format("{}", number); }
  std::string operator()(bool flag) const { return flag ? "true" : "false"; }
  template <typename Number>
  requires(std::is_integral_v<Number> || std::is_enum_v<Number>) std::string operator()(Number number) const {
    return std::to_string(static_cast<std::uint64_t>(number));
  }
  std::string operator()(const std::vector<std::uint8_t>& bytes) const {
    return std::to_string(bytes.size()) + " bytes";
  }
  template <typename Value>
  std::string operator()(const std::optional<Value>& value) const {
    return value ? (*this)(*value) : "none";
  }
  std::string operator()(ModelId model) const { return NameOf(world_.models, model.index()); }
  std::string operator()(RobotId robot) const { return NameOf(world_.robots, robot.index()); }
  std::string operator()(ObjectId object) const {
    return object.index() < world_.objects.size() ? (*this)(world_.objects[object.index()]) : kUnknown;
  }
  std::string operator()(GripperId gripper) const {
    return gripper.index() < world_.grippers.size() ? (*this)(world_.grippers[gripper.index()].model) : kUnknown;
  }

 private:
  static constexpr const char* kUnknown = "an unknown model";

  template <typename Named>
  static std::string NameOf(const std::vector<Named>& list, std::size_t index) {
    return index < list.size() ? list[index].name : kUnknown;
  }

  const WorldDescription& world_;
};

std::string Spaced(std::string_view name) {
  std::string text(name);
  std::replace(text.begin(), text.end(), '_', ' ');
  return text;
}

// "joint velocity"; of robots and objects, whose models the difference names, just "x".
template <typename Row>
std::string FieldName(std::string_view table, std::string_view leaf) {
  if constexpr (std::is_same_v<Row, RobotState> || std::is_same_v<Row, ObjectState>) return Spaced(leaf);
  return std::string(table.substr(0, table.size() - 1)) + " " + Spaced(leaf);
}

}  // namespace

ReplayedWorld::ReplayedWorld(std::shared_ptr<const Scene> scene)
    : original_(scene), scene_(std::move(scene)), bodies_(*scene_) {}

void ReplayedWorld::Begin() {
  SetState(InitialState(*scene_));
}

FrameMessage ReplayedWorld::Frame() const {
  FrameMessage frame;
  frame.state = state_;
  frame.state_hash = state_hash_;
  frame.edition = edition_;
  frame.world_edition = world_edition_;
  frame.fresh_edition = fresh_edition_;
  return frame;
}

void ReplayedWorld::SetState(WorldState state) {
  state_ = std::move(state);
  state_hash_ = StateHash(state_);
  bodies_.Assign(state_);
}

Status ReplayedWorld::Restore(const RecordedTick& tick) {
  if (!tick.keyframe) return Error{{}, "found no keyframe"};
  const FrameMessage& keyframe = *tick.keyframe;
  if (Status problem = CheckStartState(world(), keyframe.state); !problem.ok()) return problem;
  number_ = tick.number;
  SetState(keyframe.state);
  world_edition_ = keyframe.world_edition;
  edition_ = keyframe.edition;
  fresh_edition_ = keyframe.fresh_edition;
  events_.clear();
  return {};
}

Status ReplayedWorld::Apply(const RecordedTick& tick) {
  events_.clear();
  number_ = tick.number;
  if (tick.edit) return Edit(*tick.edit, tick.edition, WorldState(state_));
  return tick.is_step() ? Step(tick) : Status();
}

Status ReplayedWorld::Step(const RecordedTick& tick) {
  for (const Proposal& proposal : tick.proposals) {
    if (Status problem = ValidateProposal(*scene_, state_, proposal); !problem.ok()) {
      const std::size_t robot = proposal.robot.index();
      const std::string name = robot < world().robots.size() ? world().robots[robot].name : std::to_string(robot);
      return Error{{}, "the proposal of robot " + name + " is refused: " + problem.error().message};
    }
  }
  for (const Input& input : tick.inputs) {
    if (Status problem = CheckInput(*scene_, input); !problem.ok()) return problem;
  }
  StepResult next = troupe::Step(*scene_, state_, tick.proposals, bodies_, nullptr, tick.inputs);
  events_ = std::move(next.events);
  SetState(std::move(next.state));
  return {};
}

Status ReplayedWorld::ApplyAlone(std::uint64_t number, const RecordedEdit& edit) {
  if (Status problem = CheckStartState(world(), edit.before.state); !problem.ok()) return problem;
  number_ = number;
  return Edit(edit, edit.before.edition + 1, edit.before.state);
}

Status ReplayedWorld::Edit(const RecordedEdit& edit, Edition edition, const WorldState& before) {
  if (control::KindOf(edit.request) != RequestKind::kEdit) return Error{{}, "found a request that is no edit"};
  const bool rewinds = control::Is<control::Rewind>(edit.request);
  if (rewinds && edit.world && edit.restored) {
    if (Status problem = CheckStartState(*edit.world, edit.restored->state); !problem.ok()) return problem;
  }
  Result<EditedWorld> edited =
      ApplyEdit({edit.request, edit.world ? &*edit.world : nullptr, edit.restored ? &edit.restored->state : nullptr},
                original_, scene_, before);
  if (!edited.ok()) return Error{{}, "the edit is refused: " + edited.error().message};
  if (edited.value().scene != scene_) {
    scene_ = edited.value().scene;
    world_edition_ = edition;
    bodies_ = BodyIndex(*scene_);
  }
  edition_ = edition;
  if (rewinds) rewound_until_ = number_ + edit.copies;
  if (ReplacesWorld(edit.request)) original_ = scene_;
  if (const auto* const change = std::get_if<control::Change>(&edit.request)) {
    const Result<WorldChanges> changes = WorldChanges::FromText(change->changes);
    if (changes.ok()) original_ = std::make_shared<const Scene>(changes.value().AppliedTo(original_->world()));
  }
  if (edit.original) original_ = std::make_shared<const Scene>(*edit.original);
  if (edited.value().fresh) fresh_edition_ = edition;
  events_ = std::move(edited.value().events);
  SetState(std::move(edited.value().state));
  return {};
}

Result<ReplayCursor> ReplayCursor::At(const Recording& recording, std::size_t chunk) {
  ReplayCursor cursor(recording);
  if (Status damage = cursor.Restart(chunk); !damage.ok()) return damage.error();
  return cursor;
}

Result<ReplayCursor> ReplayCursor::AtTick(const Recording& recording, const std::optional<Tick>& tick) {
  const std::optional<std::uint64_t> position = tick ? recording.spans().Last(*tick) : Recording::kEnd;
  if (!position) return NoSuchTick(recording, *tick);
  Result<ReplayCursor> made = At(recording, recording.KeyframeUpTo(*position));
  if (!made.ok()) return made;
  Status failure = made.value().StepTo(*position);
  const bool is_there = made.value().has_state() && (!tick || made.value().tick().tick == *tick);
  if (failure.ok() && !is_there) failure = Error{{}, "the ticks are not those that their times say"};
  if (!failure.ok()) return Error{{recording.name()}, failure.error().message, ErrorCode::kFailure};
  return made;
}

Status ReplayCursor::Restart(std::size_t chunk) {
  world_ = ReplayedWorld(first_);
  reader_ = TickReader(*recording_, chunk);
  begins_run_ = chunk == 0;
  has_state_ = has_next_ = has_ended_ = is_lost_ = false;
  if (begins_run_) world_.Begin();
  Status edited = recording_->VisitEdits(
      chunk, [this](std::uint64_t number, const RecordedEdit& edit) { return world_.ApplyAlone(number, edit); });
  if (edited.ok()) return edited;
  return Error{{recording_->name()}, edited.error().message, ErrorCode::kFailure};
}

Result<const RecordedTick*> ReplayCursor::Next() {
  if (!has_next_ && !has_ended_) {
    const Result<bool> more = reader_.Next(next_);
    is_lost_ = !more.ok();
    if (is_lost_) return more.error();
    has_next_ = more.value();
    has_ended_ = !more.value();
  }
  return has_next_ ? &next_ : nullptr;
}

Status ReplayCursor::Fail(Fault fault, const std::string& problem) {
  fault_ = fault;
  is_lost_ = true;
  return Error{{}, fmt::format("tick {}: {}", has_next_ ? next_.tick : tick_.tick, problem), ErrorCode::kFailure};
}

Status ReplayCursor::Apply() {
  if (!has_state_ && !begins_run_) {
    if (Status refused = world_.Restore(next_); !refused.ok()) return Fail(Fault::kDamage, refused.error().message);
  } else if (Status refused = world_.Apply(next_); !refused.ok()) {
    return Fail(Fault::kNamedDifference, refused.error().message);
  }
  std::swap(tick_, next_);
  has_state_ = true;
  has_next_ = false;
  return {};
}

Status ReplayCursor::Advance() {
  if (next_.edit && has_state_) {
    const std::string difference = DifferenceFrom(next_.edit->before);
    if (!difference.empty()) return Fail(Fault::kNamedDifference, difference);
  }
  const Status applied = Apply();
  return applied.ok() ? Compare() : applied;
}

Result<bool> ReplayCursor::Step() {
  const Result<const RecordedTick*> next = Next();
  if (!next.ok()) return next.error();
  if (next.value() == nullptr) return false;
  const Status advanced = Advance();
  return advanced.ok() ? Result<bool>(true) : advanced.error();
}

Status ReplayCursor::StepTo(std::uint64_t position) {
  while (!has_state_ || this->position() < position) {
    const Result<bool> more = Step();
    if (!more.ok()) return more.error();
    if (more.value()) continue;
    if (position == Recording::kEnd) return {};
    return Error{{}, "found the end of the recording, expected another tick"};
  }
  return {};
}

Status ReplayCursor::Approach(std::uint64_t position) {
  const bool is_near =
      has_state_ && !is_lost_ && this->position() <= position && position - this->position() <= kStepOn;
  return is_near ? Status() : Restart(recording_->KeyframeUpTo(position));
}

Status ReplayCursor::Compare() {
  if (world_.state().tick != tick_.tick || world_.state_hash() != tick_.state_hash) {
    const std::string model = tick_.keyframe ? DifferenceFrom(*tick_.keyframe) : std::string();
    return Fail(model.empty() ? Fault::kDifference : Fault::kNamedDifference,
                fmt::format("found the state hash {:016x}, expected {:016x}{}{}", world_.state_hash(), tick_.state_hash,
                            model.empty() ? "" : "; ", model));
  }
  if (!tick_.keyframe) return {};
  const std::string difference = DifferenceFrom(*tick_.keyframe);
  return difference.empty() ? Status() : Fail(Fault::kNamedDifference, difference);
}

std::string ReplayCursor::DifferenceFrom(const FrameMessage& recorded) const {
  const std::optional<StateDifference> difference = FindDifference(world_.world(), world_.state(), recorded.state);
  if (!difference) return {};
  return fmt::format("the {} of {} is {}, expected {}", difference->field, difference->model, difference->found,
                     difference->expected);
}

Status CheckStepVersion(const Recording& recording) {
  const RecordedRun& run = recording.run();
  if (run.step_version == kStepVersion) return {};
  return Error{
      {recording.name()},
      fmt::format("found a recording of step version {} (troupe {}), expected {}: this program steps otherwise",
                  run.step_version, run.program_version, kStepVersion)};
}

std::vector<Event> StepEventsOf(const std::vector<Event>& events) {
  std::vector<Event> repeated = events;
  std::erase_if(repeated, [](const Event& event) {
    return event.type == EventType::kJoined || event.type == EventType::kLeft ||
           event.type == EventType::kProposalRejected || event.type == EventType::kReported;
  });
  return repeated;
}

std::optional<ControllerCheckpoint> PreviousOf(const RecordedTick& tick) {
  if (tick.number == 0) return std::nullopt;
  if (tick.edit) return ControllerCheckpoint{tick.edition - 1, tick.edit->before.state.tick, false};
  return ControllerCheckpoint{tick.edition, tick.tick - 1, true};
}

Result<Recording> OpenToReplay(const std::string& path) {
  Result<Recording> recording = Recording::Open(path);
  if (!recording.ok()) return recording;
  if (Status other = CheckStepVersion(recording.value()); !other.ok()) return other.error();
  return recording;
}

Error NoSuchTick(const Recording& recording, Tick tick) {
  return {
      {recording.name()},
      fmt::format("found tick {}, expected at most {}, the last of the recording", tick, recording.spans().greatest())};
}

std::optional<StateDifference> FindDifference(const WorldDescription& world, const WorldState& found,
                                              const WorldState& expected) {
  const ValueText text(world);
  std::optional<StateDifference> first;
  if (found.tick != expected.tick) {
    return StateDifference{"the world", "tick", text(found.tick), text(expected.tick)};
  }
  ForEachTable([&]<typename Row>(const Field<WorldState, std::vector<Row>>& table) {
    const std::vector<Row>& found_rows = table.Of(found);
    const std::vector<Row>& expected_rows = table.Of(expected);
    if (first) return;
    if (found_rows.size() != expected_rows.size()) {
      first = {"the world", "number of " + std::string(table.name), text(found_rows.size()),
               text(expected_rows.size())};
      return;
    }
    const auto [a, b] = std::mismatch(found_rows.begin(), found_rows.end(), expected_rows.begin());
    if (a == found_rows.end()) return;
    const std::vector<ModelId> models = ModelsOf<Row>(world);
    const auto row = static_cast<std::size_t>(a - found_rows.begin());
    const std::string model = row < models.size() ? text(models[row]) : "the world";
    ForEachLeaf<Row>([&, &from = *a, &to = *b](const auto& leaf) {
      if (first || leaf.Of(from) == leaf.Of(to)) return;
      // The first difference only: what differs later mostly follows from it.
      first = {model, FieldName<Row>(table.name, leaf.name), text(leaf.Of(from)), text(leaf.Of(to))};
    });
  });
  return first;
}

}  // namespace troupe
