#include "worldfile/models/build_world.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <tuple>

#include "worldfile/models/grid_lanes.h"
#include "worldfile/models/lanes.h"
#include "worldfile/models/narrow_lanes.h"
#include "worldfile/models/properties/color_names.h"
#include "worldfile/models/properties/property_reader.h"
#include "worldfile/models/start_overlap.h"
#include "worldfile/models/types/model_types.h"
#include "worldfile/models/waiting_points.h"
#include "worldfile/sites/site_tree.h"
#include "worldfile/text/text_file.h"

namespace troupe {
namespace {

// ModelBuilder: turns the nodes of a world tree into models. The properties that all models have are read here; the
// reader of the model's type adds the rest.
class ModelBuilder {
 public:
  // The context must outlive the builder.
  explicit ModelBuilder(BuildContext& context) : context_(context) {}

  // Adds all models of the tree to the context's world, parents before children. REQUIRES: called once.
  void BuildTree();

  // The models that have a parent in the file, but none in the world, with the parent in the file.
  const std::map<ModelId, ModelId>& placed_alone() const { return placed_alone_; }

 private:
  // The facts about a model that its children depend on.
  struct Parent {
    ModelId id;
    std::string name;
    const ModelType& type;
    Pose X_WP;
    double stack_height = 0.0;     // m, added to the children's z
    std::optional<RobotId> robot;  // the robot that it belongs to
    bool moves = false;            // belongs to a robot or a movable object
  };

  void BuildChildren(const WorldNode& node, const Parent* parent);
  void BuildModel(const WorldNode& node, const std::string& wanted_name, const Parent* parent);
  void FailForUnknownType(const WorldNode& node);
  // Nothing if the model is too far away, which is then reported.
  std::optional<ModelDraft> StartDraft(PropertyReader& reader, const ModelType& type, const std::string& name,
                                       const Parent* parent);
  void PlaceInTree(PropertyReader& reader, const Parent* parent, const Pose& X_PM, ModelDraft& draft);
  // Whether the model belongs to a robot or a movable object.
  bool Moves(const ModelDraft& draft, const Parent* parent) const;

  BuildContext& context_;
  std::vector<std::unique_ptr<ModelReader>> readers_;  // of the models so far, in their order
  std::map<ModelId, ModelId> placed_alone_;
};

constexpr double kMaxJoules = 1e12;  // or W, or kg

// The amount in J, from the property in J or in kJ.
std::optional<double> ReadJoules(PropertyReader& reader, std::string_view name) {
  std::optional<double> joules;
  // Both spellings are in Stage's worlds.
  const std::string thousands = "k" + std::string(name);
  if (reader.node().Find(name) != nullptr) joules = reader.Number(name, 0.0, -kMaxJoules, kMaxJoules);
  if (reader.node().Find(thousands) != nullptr) {
    if (joules) {
      reader.diagnostics().Warn(reader.Where(thousands), "found both " + Quoted(name) + " and " + Quoted(thousands) +
                                                             ", expected one of them; the latter counts");
    }
    joules = 1000.0 * reader.Number(thousands, 0.0, -kMaxJoules / 1000.0, kMaxJoules / 1000.0);
  }
  return joules;
}

double ReadRate(PropertyReader& reader, std::string_view name) {
  return reader.Number(name, 0.0, 0.0, kMaxJoules);
}

// One of the four properties of joules makes a store; a store of negative joules is endless.
PowerDescription ReadPower(PropertyReader& reader) {
  PowerDescription power;
  const std::optional<double> joules = ReadJoules(reader, "joules");
  std::optional<double> capacity = ReadJoules(reader, "joules_capacity");
  if (capacity && *capacity < 0.0) {
    reader.diagnostics().Warn(reader.node().where,
                              "found a negative capacity for energy, expected at least 0; it is 0");
    capacity = 0.0;
  }
  power.has_store = joules || capacity;
  power.endless = joules && *joules < 0.0;
  power.capacity = power.endless ? 0.0 : std::max(0.0, capacity.value_or(joules.value_or(0.0)));
  power.joules = power.endless ? 0.0 : std::min(joules.value_or(power.capacity), power.capacity);
  power.watts = ReadRate(reader, "watts");
  power.mass = ReadRate(reader, "mass");
  power.give_watts = ReadRate(reader, "give_watts");
  power.take_watts = ReadRate(reader, "take_watts");
  return power;
}

Size ReadSize(PropertyReader& reader, const Size& otherwise) {
  auto size = reader.Numbers("size", 3);
  if (!size) return otherwise;
  if (*std::min_element(size->begin(), size->end()) < 0.0) {
    reader.diagnostics().Warn(reader.Where("size"),
                              "found a negative size, expected values of at least 0; the sign is ignored");
    for (double& side : *size) side = std::fabs(side);
  }
  const double unit = reader.units().length;
  return {(*size)[0] * unit, (*size)[1] * unit, (*size)[2] * unit};
}

// In Stage other bodies hit the outlines of a body without height, as if it were as high as they are. Walls are all
// outline; but a plate is an area to drive over, which no body may start in.
void SettleFlatBody(PropertyReader& reader, ModelDraft& draft) {
  ModelDescription& model = draft.model;
  const bool is_wall = reader.node().Find("bitmap") != nullptr || draft.type.has_drive || model.gripper_return;
  // Bitmaps, robots and objects of height 0 keep their outlines: their authors mean a body.
  model.obstacle_return = model.obstacle_return && is_wall;
  reader.diagnostics().Warn(reader.Where("size"),
                            Quoted(model.name) + " has no height: it is drawn flat, " +
                                (model.obstacle_return ? "hit by bodies at its height" : "hit by no body") +
                                ", and seen only by rays at its height");
}

void WarnIfSeenButNotHit(PropertyReader& reader, const ModelDescription& model) {
  if (model.obstacle_return || model.ranger_return < 0.0 || reader.node().Find("bitmap") == nullptr) return;
  reader.diagnostics().Warn(reader.Where("obstacle_return"),
                            "map " + Quoted(model.name) + " is seen but never hit: its 'obstacle_return' is 0");
}

void WarnIfControlled(PropertyReader& reader) {
  const std::vector<std::string> controllers = reader.Texts("ctrl");
  const auto is_place = [](const std::string& text) { return text == "source" || text == "sink"; };
  if (std::all_of(controllers.begin(), controllers.end(), is_place)) return;  // places for robots, by their names
  if (const Property* control = reader.Use("ctrl")) {
    reader.diagnostics().Warn(control->where, "property 'ctrl' has no effect: only a 'position' has a controller");
  }
}

void ModelBuilder::BuildTree() {
  // The first error ends the build, so that Complete never sees a half-made model.
  BuildChildren(context_.tree.world, nullptr);
  for (const std::unique_ptr<ModelReader>& reader : readers_) {
    if (context_.diagnostics.failed()) return;
    reader->Complete(context_);
  }
}

void ModelBuilder::BuildChildren(const WorldNode& node, const Parent* parent) {
  const std::vector<std::string> names = ChildNames(node);
  for (std::size_t i = 0; i < node.children.size() && !context_.diagnostics.failed(); ++i) {
    const WorldNode& child = node.children[i];
    if (child.type == "window") {
      context_.diagnostics.WarnOfWindow(child.where, "'window'");
    } else if (child.type == "block") {
      if (parent == nullptr)
        context_.diagnostics.Fail(child.where, "found a 'block' outside of a model, expected it inside one");
    } else if (child.type == "sensor") {
      if (parent == nullptr || !parent->type.has_sensors) {
        context_.diagnostics.Fail(child.where, "found a 'sensor' outside of a ranger, expected it inside one");
      }
    } else {
      BuildModel(child, FullName(parent != nullptr ? parent->name : "", names[i]), parent);
    }
  }
}

void ModelBuilder::BuildModel(const WorldNode& node, const std::string& wanted_name, const Parent* parent) {
  const ModelType* const type = FindModelType(node.type);
  if (type == nullptr) {
    FailForUnknownType(node);
    return;
  }
  const std::string name = context_.names.Add(node, wanted_name, context_.diagnostics);
  PropertyReader reader(node, context_.units, context_.diagnostics);
  std::optional<ModelDraft> draft = StartDraft(reader, *type, name, parent);
  if (!draft) return;
  std::unique_ptr<ModelReader> type_reader = type->make_reader();
  const bool moves = Moves(*draft, parent);
  // The body first: the readers of grippers and lifts read with it the properties that decide on its form.
  Shape shape = type_reader->ReadShape(reader, *draft, context_);
  if (!shape.empty() && draft->size.z == 0.0) SettleFlatBody(reader, *draft);
  if (moves) shape = ListedForMotion(reader, std::move(shape));
  draft->model.shape = context_.shapes.Add(std::move(shape));
  WarnIfSeenButNotHit(reader, draft->model);
  if (!type->has_drive) WarnIfControlled(reader);
  type_reader->ReadProperties(reader, *draft, context_);
  const bool stack_children = reader.Flag("stack_children", true);
  WarnOfUnusedInModel(reader, type->name);
  // The draft is complete: parts refer to the model by its id.
  context_.world.models.push_back(draft->model);
  type_reader->AddParts(*draft, context_);
  readers_.push_back(std::move(type_reader));

  const Parent self{draft->id, name, *type, draft->X_WM, stack_children ? draft->size.z : 0.0, draft->robot, moves};
  BuildChildren(node, &self);
}

void ModelBuilder::FailForUnknownType(const WorldNode& node) {
  std::string message = UnknownTypeMessage(node.type, context_.tree.defines);
  // The node itself was not expanded, so that the define must come after it in the file.
  const auto later = context_.tree.defines.find(node.type);
  if (later != context_.tree.defines.end()) {
    message = "found " + Quoted(node.type) + " before its define at line " + std::to_string(later->second.where.line) +
              ", expected the define first";
  }
  context_.diagnostics.Fail(node.where, message);
}

std::optional<ModelDraft> ModelBuilder::StartDraft(PropertyReader& reader, const ModelType& type,
                                                   const std::string& name, const Parent* parent) {
  const WorldNode& node = reader.node();
  reader.Use("name");
  ModelDraft draft{.type = type, .node = node, .id = ModelId(context_.world.models.size())};
  draft.map = ReadRosMap(reader, context_);
  draft.size = ReadSize(reader, draft.map ? draft.map->size : type.size);
  draft.X_MD = reader.ReadPose("origin").value_or(Pose{});
  Pose X_PM = reader.ReadPose("pose").value_or(draft.map ? draft.map->origin : Pose{});
  if (parent != nullptr) X_PM.z += parent->stack_height;
  draft.X_WM = parent != nullptr ? parent->X_WP * X_PM : X_PM;
  if (!IsWithinReach(X_PM) || !IsWithinReach(draft.X_WM)) {
    context_.diagnostics.Fail(reader.Where("pose"), "found a model beyond 1000 km, expected it nearer");
    return std::nullopt;
  }
  if (parent != nullptr) draft.robot = parent->robot;

  ModelDescription& model = draft.model;
  model.name = name;
  model.type = node.type;
  model.size_x = draft.size.x;
  model.size_y = draft.size.y;
  model.size_z = draft.size.z;
  if (draft.map && draft.X_MD == Pose{}) model.map = draft.map->grid();
  PlaceInTree(reader, parent, X_PM, draft);
  model.show_nose = reader.Flag("gui_nose", false);
  model.power = ReadPower(reader);
  model.color = ReadColor(reader, type.color, context_.world.seed, draft.id);
  model.fiducial_return =
      static_cast<std::int32_t>(reader.Integer("fiducial_return", 0, -1'000'000'000, 1'000'000'000));
  model.fiducial_key = static_cast<std::int32_t>(reader.Integer("fiducial_key", 0, -1'000'000'000, 1'000'000'000));
  return draft;
}

// Robots and movable objects are placed in the world by themselves, wherever the file has them.
void ModelBuilder::PlaceInTree(PropertyReader& reader, const Parent* parent, const Pose& X_PM, ModelDraft& draft) {
  const bool has_drive = draft.type.has_drive;
  const bool in_robot = draft.robot.has_value();
  if (has_drive && parent != nullptr && !in_robot) {
    context_.diagnostics.Warn(draft.node.where,
                              "a 'position' below a model that does not move is placed in the world by itself");
  }
  ModelDescription& model = draft.model;
  model.obstacle_return = reader.Flag("obstacle_return", true);
  model.ranger_return = reader.Number("ranger_return", 1.0);
  model.gripper_return = reader.Flag("gripper_return", false);
  const bool is_object = model.gripper_return && !has_drive && !in_robot;
  if (model.gripper_return && !is_object) {
    context_.diagnostics.Warn(reader.Where("gripper_return"),
                              "property 'gripper_return' has no effect on a robot: none of its parts can be gripped");
  }
  const bool is_placed_alone = parent != nullptr && !in_robot && (has_drive || is_object);
  // For a model alone the pose is in W: its world pose at load.
  model.X_PM = is_placed_alone ? draft.X_WM : X_PM;
  if (is_placed_alone) placed_alone_.emplace(draft.id, parent->id);
  if (parent != nullptr && !is_placed_alone) model.parent = parent->id;
  if (is_object) context_.world.objects.push_back(draft.id);
}

bool ModelBuilder::Moves(const ModelDraft& draft, const Parent* parent) const {
  const std::vector<ModelId>& objects = context_.world.objects;
  return draft.type.has_drive || draft.robot || (!objects.empty() && objects.back() == draft.id) ||
         (draft.model.parent && parent->moves);
}

Units ReadUnits(PropertyReader& reader) {
  Units units;
  const std::string length = reader.Text("unit_length", "m");
  if (length == "cm") {
    units.length = 0.01;
  } else if (length == "mm") {
    units.length = 0.001;
  } else if (length != "m") {
    reader.diagnostics().Warn(reader.Where("unit_length"),
                              "unit_length " + Quoted(length) + " is not \"m\", \"cm\" or \"mm\"; metres are used");
  }
  const std::string angle = reader.Text("unit_angle", "degrees");
  units.degrees = angle != "radians";
  if (angle != "radians" && angle != "degrees") {
    reader.diagnostics().Warn(reader.Where("unit_angle"),
                              "unit_angle " + Quoted(angle) + " is not \"degrees\" or \"radians\"; degrees are used");
  }
  return units;
}

// The world's own properties, without models.
WorldDescription ReadWorldProperties(PropertyReader& reader) {
  WorldDescription world;
  const std::string file = std::filesystem::path(reader.node().where.file).filename().string();
  world.name = reader.Text("name", file);
  world.interval_ns = std::llround(reader.Number("interval_sim", 100.0, 0.001, 1'000'000.0) * 1e6);
  world.gravity = reader.Number("gravity", 9.81, 0.0, 1000.0);
  return world;
}

// Of a problem of paths: hundreds of robots that do little, and a run that ends even if some do not arrive.
constexpr std::uint32_t kCellRobotsPerProcess = 100;
constexpr double kGridSeconds = 3600.0;

// Stage's speed of a run with a window; none if it is not above 0.
Speed ReadWatchedSpeed(PropertyReader& reader) {
  const double speedup = reader.Number("speedup", 1.0, -1e6, 1e6);
  return speedup > 0.0 ? Speed(speedup) : Speed();
}

// The ticks of the property `quit_time`; nothing without one.
std::optional<std::uint64_t> ReadTicks(PropertyReader& reader, std::int64_t interval_ns) {
  const double quit_seconds = reader.Number("quit_time", 0.0, 0.0, 1e9);
  if (!(quit_seconds > 0.0)) return std::nullopt;
  // Rounded up: the run covers at least the time that the file asks for.
  const std::int64_t quit_ns = std::llround(quit_seconds * 1e9);
  return static_cast<std::uint64_t>((quit_ns + interval_ns - 1) / interval_ns);
}

}  // namespace

Result<LoadedWorld> BuildWorld(const WorldTree& tree, const LoadOverrides& overrides, const BuildOptions& options) {
  BuildContext context(tree, overrides.allowed, options.images, options.known_bitmaps);
  context.without_bitmaps = options.without_bitmaps;
  context.default_controller = overrides.controller;
  context.check_controller = overrides.check_controller;
  PropertyReader reader(tree.world, context.units, context.diagnostics);
  context.units = ReadUnits(reader);
  context.world = ReadWorldProperties(reader);
  context.world.seed = overrides.seed.value_or(0);
  LoadedWorld loaded;
  if (const auto ticks = ReadTicks(reader, context.world.interval_ns)) loaded.settings.ticks = *ticks;
  loaded.settings.watched_speed = ReadWatchedSpeed(reader);
  WarnOfUnusedInWorld(reader);
  ModelBuilder builder(context);
  builder.BuildTree();
  if (context.diagnostics.failed()) return *context.diagnostics.error();

  loaded.world = std::move(context.world);
  // Complete adds them in the order of the `gripper` models; their mounts may be in another order.
  std::sort(loaded.world.grippers.begin(), loaded.world.grippers.end(),
            [](const GripperDescription& a, const GripperDescription& b) { return a.model < b.model; });
  loaded.placed_alone = builder.placed_alone();
  loaded.site = tree.site;
  if (tree.site != nullptr) {
    loaded.world.places = PlacesOf(*tree.site);
    loaded.world.levels = LevelsOf(*tree.site);
    loaded.world.lane_graphs = LaneGraphsOf(*tree.site, loaded.world);
  } else {
    loaded.world.levels = LevelsOf(loaded.world.lifts);
  }
  if (tree.grid != nullptr) {
    if (Status status = AddGrid(*tree.grid, loaded.world); !status.ok()) return status.error();
    if (!tree.grid->agents.empty()) {
      loaded.settings.robots_per_process = kCellRobotsPerProcess;
      if (!loaded.settings.ticks) {
        loaded.settings.ticks = static_cast<std::uint64_t>(kGridSeconds / loaded.world.interval_seconds());
      }
    }
  }
  loaded.files = tree.files;
  for (const std::string& bitmap : context.bitmaps.Paths()) {
    // A map of cells is the file of its world and of its bitmap.
    if (std::find(loaded.files.begin(), loaded.files.end(), bitmap) == loaded.files.end()) {
      loaded.files.push_back(bitmap);
    }
  }
  std::tie(loaded.map_width, loaded.map_height) = context.bitmaps.LargestSize();
  loaded.warnings = tree.warnings;
  const std::vector<Warning>& warnings = context.diagnostics.warnings();
  loaded.warnings.insert(loaded.warnings.end(), warnings.begin(), warnings.end());
  return loaded;
}

void PrepareLanes(LoadedWorld& loaded, const std::string& file) {
  for (const std::string& message : FindNarrowLanes(loaded.world)) loaded.warnings.push_back({{file}, message});
  AddWaitingPoints(loaded.world);
}

Status CheckControllersInWorld(const LoadedWorld& loaded, const std::string& file, const LoadOverrides& overrides) {
  if (!overrides.check_in_world) return Status();
  std::vector<RobotId> robots;
  for (std::size_t i = 0; i < loaded.world.robots.size(); ++i) robots.emplace_back(i);
  const Status checked = overrides.check_in_world(loaded.world, robots);
  return checked.ok() ? Status() : Error{{file}, checked.error().message};
}

void AppendPlacementWarnings(const std::string& file, LoadedWorld& loaded) {
  for (const std::string& message : FindStartOverlaps(loaded.world)) loaded.warnings.push_back({{file}, message});
}

}  // namespace troupe
