#include "world-service/service/apply_edit.h"

#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>
#include <span>
#include <utility>

#include "common/base/json_reader.h"
#include "common/base/json_writer.h"
#include "common/base/text.h"
#include "common/model/goal_text.h"
#include "common/model/lane_rules.h"
#include "common/model/states.h"
#include "common/model/zones.h"
#include "common/signals/state_tables.h"
#include "common/spatial/check_order.h"
#include "world-service/core/step.h"

namespace troupe {
namespace {

EditedWorld Load(const WorldDescription& world) {
  EditedWorld loaded;
  loaded.scene = std::make_shared<const Scene>(world);
  loaded.state = InitialState(*loaded.scene);
  // Ids of the world before mean nothing in this one: agents, memories and events begin again.
  loaded.fresh = true;
  return loaded;
}

constexpr double kInfinity = std::numeric_limits<double>::infinity();

EntityBox NoBox() {
  return {Rectangle::Nothing(), {kInfinity, -kInfinity}};
}

void Extend(EntityBox& box, const Pose& X_EM, std::span<const Vec2> points, const ZRange& z) {
  for (const Vec2& point : points) box.area.Extend(Transform2(X_EM) * point);
  box.z.min = std::min(box.z.min, X_EM.z + z.min);
  box.z.max = std::max(box.z.max, X_EM.z + z.max);
}

void Extend(EntityBox& box, const Pose& X_EM, const Shape& shape) {
  for (const Block& block : shape.blocks) Extend(box, X_EM, block.outline, block.z);
  for (const Rectangle& rectangle : shape.rectangles) Extend(box, X_EM, Corners(rectangle), shape.rectangles_z);
  if (shape.area) Extend(box, X_EM * shape.area->X_MA(), Corners(shape.area->bounds()), shape.rectangles_z);
}

// Applies an edit of its type.
class EditApplication {
 public:
  EditApplication(const AppliedEdit& edit, const std::shared_ptr<const Scene>& original,
                  const std::shared_ptr<const Scene>& scene, const WorldState& state)
      : edit_(edit), original_(original), scene_(scene), state_(state) {}

  template <typename Request>
  Result<EditedWorld> operator()(const Request&) const {
    return Error{{}, "found no edit"};
  }
  Result<EditedWorld> operator()(const control::Reset& reset) const {
    // All scopes at once also restore deleted entities, for which the single scopes have no bit.
    if (reset.scopes == kResetAll) return ResetWorld(original_, scene_, state_, {});
    return ResetWorld(original_, scene_, state_,
                      {.time = (reset.scopes & kResetTime) != 0,
                       .state = (reset.scopes & kResetState) != 0,
                       .spawned = (reset.scopes & kResetSpawned) != 0,
                       .deleted = false});
  }
  Result<EditedWorld> operator()(const control::SetPose& move) const {
    return troupe::SetPose(scene_, state_, move.name, move.pose);
  }
  Result<EditedWorld> operator()(const control::Delete& removal) const {
    return DeleteEntity(scene_, state_, removal.name);
  }
  Result<EditedWorld> operator()(const control::Spawn& spawn) const {
    if (edit_.world == nullptr) return Error{{}, "found nothing to spawn"};
    return SpawnEntity(scene_, state_, *edit_.world, spawn.name, spawn.pose);
  }
  Result<EditedWorld> operator()(const control::LoadWorld&) const {
    if (edit_.world == nullptr) return Error{{}, "found no world"};
    return Load(*edit_.world);
  }
  Result<EditedWorld> operator()(const control::Change& change) const {
    const Result<WorldChanges> changes = WorldChanges::FromText(change.changes);
    if (!changes.ok()) return changes.error();
    return EditedWorld{std::make_shared<const Scene>(changes.value().AppliedTo(scene_->world())), state_, {}, false};
  }
  Result<EditedWorld> operator()(const control::Rewind&) const {
    if (edit_.world == nullptr || edit_.restored == nullptr) return Error{{}, "found no state to restore"};
    // The state is not recalculated: the recording's bits are restored.
    return EditedWorld{std::make_shared<const Scene>(*edit_.world), *edit_.restored, {}, true};
  }

 private:
  const AppliedEdit& edit_;
  const std::shared_ptr<const Scene>& original_;
  const std::shared_ptr<const Scene>& scene_;
  const WorldState& state_;
};

Error NotFound(const std::string& kind, const std::string& name, const std::vector<std::string>& names) {
  return Error{{}, "the world has no " + kind + " '" + name + "'" + DidYouMean(name, names)};
}

// Of those that have not been removed.
template <typename Part>
std::vector<std::string> NamesOfParts(const WorldDescription& world, const std::vector<Part>& parts) {
  std::vector<std::string> names;
  for (const Part& part : parts) {
    const ModelDescription& model = world.model(part.model);
    if (!model.removed) names.push_back(model.name);
  }
  return names;
}

// Finds what an input is for.
struct InputSearch {
  const Scene& scene;
  const WorldDescription& world = scene.world();

  template <typename Request>
  Result<Input> operator()(const Request&) const {
    return Error{{}, "found no input"};
  }
  Result<Input> operator()(const control::SetTwist& turn) const {
    const Result<ModelId> root = FindEntity(world, turn.name);
    if (!root.ok()) return root.error();
    const std::optional<RobotId> robot = FindRobot(world, turn.name);
    if (!robot) return Error{{}, "'" + turn.name + "' is no robot: it has no drive"};
    return Input{robot, TwistOrder{turn.twist}};
  }
  Result<Input> operator()(const control::Door& request) const {
    const std::optional<std::size_t> door = FindDoor(world, request.name);
    if (!door) return NotFound("door", request.name, NamesOfParts(world, world.doors));
    return Input{{}, DoorOrder{*door, request.opening}};
  }
  Result<Input> operator()(const control::Lift& call) const {
    const std::optional<std::size_t> number = FindLift(world, call.name);
    if (!number) return NotFound("lift", call.name, NamesOfParts(world, world.lifts));
    const std::vector<LiftFloor>& floors = world.lifts[*number].floors;
    std::string names;
    for (std::size_t i = 0; i < floors.size(); ++i) {
      if (floors[i].name == call.floor) return Input{{}, LiftOrder{*number, i}};
      names += (i == 0 ? "" : ", ") + floors[i].name;
    }
    return Error{{}, "lift '" + call.name + "' has no floor '" + call.floor + "', expected " + names};
  }
  Result<Input> operator()(const control::Light& light) const {
    const std::span<const LightPlace> lights = scene.lights();
    for (std::size_t i = 0; i < lights.size(); ++i) {
      const ModelDescription& model = world.model(lights[i].model);
      if (model.removed || model.name != light.name) continue;
      return Input{lights[i].robot, LightOrder{i - scene.first_light_of(lights[i].robot), light.on}};
    }
    return Error{{}, "the world has no light '" + light.name + "' on a robot"};
  }
  // The first lane between the two: an order is for all lanes on one line.
  Result<Input> operator()(const control::Lane& request) const {
    const std::optional<std::uint32_t> lane = FindLane(world, request.from, request.to);
    if (!lane) return Error{{}, "the world has no lane from '" + request.from + "' to '" + request.to + "'"};
    return Input{{}, LaneOrder{*lane, request.speed_limit}};
  }
  Result<Input> operator()(const control::Zone& request) const {
    const std::optional<std::size_t> zone = FindZone(world, request.name);
    if (!zone) {
      std::vector<std::string> names;
      for (const ZoneDescription& each : world.zones) names.push_back(each.name);
      return NotFound("zone", request.name, names);
    }
    if (world.zones[*zone].kind == ZoneKind::kOneWay) {
      return Error{{}, "the zone '" + request.name + "' is a one_way zone, which is on for the whole run"};
    }
    return Input{{}, ZoneOrder{*zone, request.on}};
  }
};

}  // namespace

Result<EditedWorld> ApplyEdit(const AppliedEdit& edit, const std::shared_ptr<const Scene>& original,
                              const std::shared_ptr<const Scene>& scene, const WorldState& state) {
  if (Status malformed = control::CheckRequest(edit.request); !malformed.ok()) return malformed.error();
  return std::visit(EditApplication(edit, original, scene, state), edit.request);
}

Result<Input> InputOf(const Scene& scene, const control::Request& request) {
  Result<Input> input = std::visit(InputSearch{scene}, request);
  if (!input.ok()) return input;
  if (Status problem = CheckInput(scene, input.value()); !problem.ok()) return problem.error();
  return input;
}

using Json = nlohmann::json;

WorldDescription WorldChanges::AppliedTo(WorldDescription world) const {
  if (seed) world.seed = *seed;
  for (RobotDescription& robot : world.robots) {
    // By name, because ids may differ between the recording and the world that it is branched to.
    const auto changed = controllers.find(robot.name);
    if (changed != controllers.end()) robot.controller = changed->second;
  }
  return world;
}

std::string WorldChanges::ToText() const {
  Json text = Json::object();
  if (seed) text["seed"] = *seed;
  for (const auto& [robot, controller] : controllers) {
    text["controllers"][robot] = {{"name", controller.name}, {"parameters", controller.parameters}};
  }
  return text.dump();
}

Result<WorldChanges> WorldChanges::FromText(const std::string& text) {
  // The text may come from a damaged recording.
  const JsonReader json = JsonReader::OfText(text, "", JsonLimits::OfProcesses());
  WorldChanges changes;
  changes.seed = json.Optional<std::uint64_t>("seed");
  if (const std::optional<JsonReader> controllers = json.Find("controllers")) {
    for (const JsonReader& controller : controllers->Members()) {
      changes.controllers[controller.key()] = {controller.Get<std::string>("name"),
                                               controller.Get<std::string>("parameters")};
    }
  }
  if (Status status = json.Finish(); !status.ok()) return status.error();
  return changes;
}

std::vector<EntityReport> ListEntities(const WorldDescription& world, const WorldState& state) {
  // First a report for every model, so that robots and objects find theirs by the id of their root, then a selection.
  std::vector<EntityReport> entities(world.models.size());
  for (std::size_t i = 0; i < entities.size(); ++i) {
    const ModelDescription& model = world.models[i];
    entities[i] = {.name = model.name, .type = model.type, .kind = EntityKind::kModel, .X_WE = model.X_PM};
  }
  for (std::size_t i = 0; i < world.robots.size(); ++i) {
    EntityReport& entity = entities[world.robots[i].root.index()];
    entity.kind = EntityKind::kRobot;
    entity.X_WE = state.robots[i].X_WR;
    entity.twist = state.robots[i].twist;
  }
  for (std::size_t i = 0; i < world.objects.size(); ++i) {
    EntityReport& entity = entities[world.objects[i].index()];
    entity.kind = EntityKind::kObject;
    entity.X_WE = state.objects[i].X_WO;
  }
  std::vector<bool> is_away(entities.size());
  for (std::size_t i = 0; i < world.people.size(); ++i) {
    EntityReport& entity = entities[world.people[i].root.index()];
    entity.kind = EntityKind::kPerson;
    const PersonState& person = state.people[i];
    if (IsAway(person)) is_away[world.people[i].root.index()] = true;
    entity.X_WE = person.X_WP;
    const Vec2 v_E = Transform2(person.X_WP).InverseRotate(Vec2(person.vx, person.vy));
    entity.twist = {v_E.x(), v_E.y(), 0.0};
  }
  std::vector<EntityReport> listed;
  for (std::size_t i = 0; i < entities.size(); ++i) {
    if (!world.models[i].parent && !world.models[i].removed && !is_away[i]) listed.push_back(std::move(entities[i]));
  }
  return listed;
}

void SetAgents(const WorldDescription& world, const Membership& members, std::vector<EntityReport>& entities) {
  std::map<std::string, RobotId> robots;
  for (std::size_t i = 0; i < world.robots.size(); ++i) {
    if (RobotExists(world, RobotId(i))) robots.emplace(world.robots[i].name, RobotId(i));
  }
  const std::vector<Membership::Waits> waits = members.RobotWaits();
  for (EntityReport& entity : entities) {
    const auto robot = robots.find(entity.name);
    const Member* const member = robot == robots.end() ? nullptr : members.MemberOf(robot->second);
    if (member == nullptr) continue;
    entity.agent = AgentReport{member->host, member->pid, member->present, member->answer_seconds,
                               waits[robot->second.index()].times_last};
  }
}

void SetSignals(const WorldDescription& world, const WorldState& state, EntityReport& entity) {
  const Result<ModelId> root = FindEntity(world, entity.name);
  const bool may_be_level = entity.kind == EntityKind::kModel;
  const Things things(world);
  const SignalView view{things, world, state};
  for (const StateTable& table : StateTables()) {
    const std::size_t kind = KindOf(table.name);
    for (ThingId thing = things.first(kind); thing < things.first(kind) + things.count(kind); ++thing) {
      // A level has no model, but that of a building has its name.
      const std::optional<ModelId> model = things.model(thing);
      const bool is_entity = model ? root.ok() && *model == root.value() : may_be_level;
      if (!is_entity || !things.exists(thing) || things.name(thing) != entity.name) continue;
      entity.signals += (entity.signals.empty() ? "" : "\n") + table.singular + " ";
      JsonWriter json(entity.signals);
      WriteRow(table, view, thing - things.first(kind), json);
    }
  }
}

void SetVehicle(const std::string& sent, EntityReport& entity) {
  entity.signals += (entity.signals.empty() ? "" : "\n") + std::string("vehicle ");
  for (const char c : sent) entity.signals += c == '\n' || c == '\r' ? ' ' : c;  // of a peer: it stays one line
}

void SetSaid(const Event& said, EntityReport& entity) {
  entity.signals += (entity.signals.empty() ? "" : "\n") + std::string(kSaidLine) + " ";
  JsonWriter json(entity.signals);
  json.BeginObject().Member("tick", said.tick).Member("text", said.detail).EndObject();
}

void SetBoxes(const WorldDescription& world, const WorldState& state, std::vector<EntityReport>& entities) {
  std::map<std::string, EntityReport*> by_name;
  for (EntityReport& entity : entities) {
    entity.box = NoBox();
    by_name[entity.name] = &entity;
  }
  const std::vector<Pose> X_WM = ModelPoses(world, state);
  std::vector<EntityReport*> owners(world.models.size(), nullptr);  // of each model, by its root
  for (std::size_t i = 0; i < world.models.size(); ++i) {
    const ModelDescription& model = world.models[i];
    if (model.removed) continue;
    if (model.parent) {
      // A parent has a lower id than its children, so its owner is known already.
      owners[i] = owners[model.parent->index()];
    } else if (const auto found = by_name.find(model.name); found != by_name.end()) {
      owners[i] = found->second;
    }
    if (owners[i] == nullptr) continue;
    Extend(owners[i]->box, Inverse(owners[i]->X_WE) * X_WM[i], world.shape(model.shape));
  }
  for (EntityReport& entity : entities) {
    if (entity.box.area.empty()) entity.box = {};
  }
}

}  // namespace troupe
