#include "world-service/replay/replayed_world.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/geometry/limits.h"
#include "common/model/states.h"
#include "common/spatial/check_order.h"
#include "world-service/core/step.h"
#include "world-service/service/apply_edit.h"

namespace troupe {
namespace {

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

// An object that is on itself, whatever is between.
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
  template <typename Tag>
  std::string operator()(const std::optional<Id<Tag>>& id) const {
    return id ? (*this)(*id) : "none";
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

ReplayedWorld::ReplayedWorld(const Recording& recording)
    : ReplayedWorld(std::make_shared<const Scene>(recording.run().world)) {
  SetState(InitialState(*scene_));
}

Result<ReplayedWorld> ReplayedWorld::At(const Recording& recording, std::size_t chunk) {
  if (chunk == 0) return ReplayedWorld(recording);
  ReplayedWorld world(std::make_shared<const Scene>(recording.run().world));
  const Status edited = recording.VisitEdits(
      chunk, [&](std::uint64_t number, const RecordedEdit& edit) { return world.ApplyAlone(number, edit); });
  if (!edited.ok()) return Error{{recording.name()}, edited.error().message, ErrorCode::kFailure};
  world.has_state_ = false;  // that after the last edit
  return world;
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
  has_state_ = true;
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

Status ReplayedWorld::Follow(const RecordedTick& tick) {
  if (Status refused = has_state_ ? Apply(tick) : Restore(tick); !refused.ok()) return refused;
  if (state_.tick == tick.tick && state_hash_ == tick.state_hash) return {};
  return Error{{}, fmt::format("found the state hash {:016x}, expected {:016x}", state_hash_, tick.state_hash)};
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
  if (!IsEdit(edit.request.command)) return Error{{}, "found a request that is no edit"};
  const bool rewinds = edit.request.command == ControlCommand::kRewind;
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
  if (ReplacesWorld(edit.request.command)) original_ = scene_;
  if (edit.request.command == ControlCommand::kChange) {
    const Result<WorldChanges> changes = WorldChanges::FromText(edit.request.source);
    if (changes.ok()) original_ = std::make_shared<const Scene>(changes.value().AppliedTo(original_->world()));
  }
  if (edit.original) original_ = std::make_shared<const Scene>(*edit.original);
  if (edited.value().fresh) fresh_edition_ = edition;
  events_ = std::move(edited.value().events);
  SetState(std::move(edited.value().state));
  return {};
}

Result<ReplayCursor> ReplayCursor::At(const Recording& recording, std::size_t chunk) {
  Result<ReplayedWorld> world = ReplayedWorld::At(recording, chunk);
  if (!world.ok()) return world.error();
  ReplayCursor cursor(std::move(world).value(), TickReader(recording, chunk));
  if (Status damage = cursor.ReadNext(); !damage.ok()) return damage.error();
  return cursor;
}

Status ReplayCursor::Advance() {
  if (Status problem = world_.Follow(*next_); !problem.ok()) {
    return Error{{}, fmt::format("tick {}: {}", next_->tick, problem.error().message), ErrorCode::kFailure};
  }
  return ReadNext();
}

Status ReplayCursor::ReadNext() {
  RecordedTick tick;
  const Result<bool> more = reader_.Next(tick);
  if (!more.ok()) return more.error();
  next_.reset();
  if (more.value()) next_ = std::move(tick);
  return {};
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
      first = {model, FieldName<Row>(table.name, leaf.name), text(leaf.Of(from)), text(leaf.Of(to))};
    });
  });
  return first;
}

}  // namespace troupe
