#include "worldfile/scenario/scenario_tree.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "worldfile/gazebo/gazebo_tree.h"
#include "worldfile/models/types/model_types.h"
#include "worldfile/scenario/scenario.h"
#include "worldfile/stage/stage_world.h"
#include "worldfile/text/text_file.h"

namespace troupe {
namespace {

Value::Number NumberOf(double value) {
  return {value, fmt::format("{}", value)};
}

// The property `pose` of `node`, which keeps its z if the entry has none. A scenario is in metres and degrees, its
// world perhaps in other units.
Property PoseProperty(const PoseEntry& entry, const WorldNode& node, const FileUnits& units) {
  const auto* const old = node.FindContent<Value::Tuple>("pose");
  const auto* const old_z = old != nullptr && old->size() > 2 ? std::get_if<Value::Number>(&(*old)[2]) : nullptr;
  Value::Number z = NumberOf(entry.pose.z / units.metres);
  if (!entry.has_z) z = old_z != nullptr ? *old_z : NumberOf(0.0);
  // The tree is in the world's units: the builder converts every pose, and must not convert this one wrongly.
  const double heading = units.radians == 1.0 ? entry.pose.heading : RadiansToDegrees(entry.pose.heading);
  Value::Tuple tuple{NumberOf(entry.pose.x / units.metres), NumberOf(entry.pose.y / units.metres), std::move(z),
                     NumberOf(heading)};
  return {"pose", Value{std::move(tuple), entry.where}, entry.where};
}

Property NameProperty(const std::string& name, const SourceLocation& where) {
  return {"name", Value{name, where}, where};
}

// Adds the entries of one scenario, one after another; stops at the first error.
class Adder {
 public:
  Adder(const ScenarioFile& file, WorldTree tree) : file_(file), tree_(std::move(tree)) {
    const std::vector<std::string> names = ChildNames(tree_.world);
    for (std::size_t i = 0; i < names.size(); ++i) {
      if (!names[i].empty()) top_level_.emplace(FullName("", names[i]), i);
    }
  }

  // REQUIRES: called once.
  Result<ScenarioPlan> Run(const std::optional<ControllerDescription>& default_controller) {
    for (const Property& property : file_.properties) tree_.world.Set(property);
    units_ = UnitsOf(tree_.world);
    for (const ModelEntry& entry : file_.models) {
      if (Status error = AddModel(entry); !error.ok()) return error.error();
    }
    for (const ModelEntry& entry : file_.robots) {
      if (Status error = AddOrChangeRobot(entry); !error.ok()) return error.error();
    }
    for (const SpawnEntry& entry : file_.spawns) {
      if (Status error = AddSpawn(entry); !error.ok()) return error.error();
    }
    for (const OverrideEntry& entry : file_.overrides) {
      Result<WorldNode> world = ApplyOverride(entry, std::move(tree_.world));
      if (!world.ok()) return world.error();
      tree_.world = std::move(world).value();
    }
    for (PlannedSpawn& spawn : spawns_) {
      const WorldNode& first = tree_.world.children[top_level_.at(spawn.names.front())];
      spawn.origin_at_start = first.Find("localization_origin") == nullptr;
    }
    if (default_controller) AddDefaultController(*default_controller);
    return ScenarioPlan{std::move(tree_), std::move(spawns_), std::move(controllers_), std::move(ros_domains_),
                        std::move(ros_lockstep_)};
  }

 private:
  // Sets the controller of the robots for which neither world nor scenario names one.
  void AddDefaultController(const ControllerDescription& controller) {
    for (const auto& [name, index] : top_level_) {
      const WorldNode& node = tree_.world.children[index];
      if (node.type == "position" && node.Find("ctrl") == nullptr) controllers_.emplace(name, controller);
    }
  }

  // A new node of a type or define.
  Result<WorldNode> MakePlain(const PlacedText& model) const {
    Result<WorldNode> made = Instantiate(tree_, model.text, model.where);
    if (!made.ok()) return Error{model.where, made.error().message};
    const std::string& type = made.value().type;
    if (IsModelType(type) && FindModelType(type) == nullptr) {
      return Error{model.where, UnknownTypeMessage(type, tree_.defines)};
    }
    return made;
  }

  // A new node of the entry's model, with the entry's properties and children.
  Result<WorldNode> Make(const ModelEntry& entry) {
    Result<WorldNode> made = MakePlain(*entry.model);
    if (!made.ok()) return made;
    WorldNode node = std::move(made).value();
    if (entry.name) node.Set(NameProperty(entry.name->text, entry.name->where));
    return Filled(std::move(node), entry);
  }

  // The node with the entry's pose, properties and children.
  Result<WorldNode> Filled(WorldNode node, const ModelEntry& entry) {
    if (entry.pose) node.Set(PoseProperty(*entry.pose, node, units_));
    for (const Property& property : entry.properties) node.Set(property);
    for (const ModelEntry& child : entry.children) {
      Result<WorldNode> made = Make(child);
      if (!made.ok()) return made.error();
      node.children.Add(std::move(made).value());
    }
    return node;
  }

  // Adds a new node to the world. A name that is not new is an error.
  Status Add(WorldNode node, const std::string& name, const SourceLocation& name_where) {
    if (!top_level_.emplace(name, tree_.world.children.size()).second) {
      return Error{name_where, "found the name " + Quoted(name) + " again, expected one that is not in the world yet"};
    }
    tree_.world.children.Add(std::move(node));
    return Status();
  }

  // "scout0", "scout1", ...: the first that is free. Models of files have the file's name without its folder and
  // ending.
  std::string FreeName(const std::string& model) {
    const std::string prefix = IsModelFile(model) ? NameOfModelFile(model) : model;
    for (std::size_t& number = next_numbers_[prefix];;) {
      std::string name = prefix + std::to_string(number++);
      if (!top_level_.contains(name)) return name;
    }
  }

  Status AddModel(const ModelEntry& entry) {
    if (!IsModelType(entry.model->text)) {
      return Error{entry.model->where, "found " + Quoted(entry.model->text) +
                                           " by itself, expected it in the "
                                           "'children' of a model"};
    }
    Result<WorldNode> made = Make(entry);
    if (!made.ok()) return made.error();
    const std::string name = entry.name ? entry.name->text : FreeName(entry.model->text);
    const SourceLocation& where = entry.name ? entry.name->where : entry.where;
    made.value().Set(NameProperty(name, where));
    return Add(std::move(made).value(), FullName("", name), where);
  }

  Status AddOrChangeRobot(const ModelEntry& entry) {
    if (!entry.model && !entry.name) {
      return Error{entry.where,
                   "found a robot with neither 'model' nor 'name', expected 'model' for a new one or "
                   "'name' for one of the world"};
    }
    if (entry.model) {
      if (Status error = AddModel(entry); !error.ok()) return error;
    } else {
      if (!top_level_.contains(FullName("", entry.name->text))) {
        return Error{entry.name->where, "found no model " + Quoted(entry.name->text) +
                                            " in the world, expected one, or 'model' to add a new one"};
      }
    }
    const std::string name = entry.name ? FullName("", entry.name->text) : NameOf(tree_.world.children.back());
    WorldNode& node = tree_.world.children.Change(top_level_.at(name));
    if (node.type != "position") {
      return Error{entry.model ? entry.model->where : entry.name->where,
                   "found a model of type " + Quoted(node.type) + ", expected a robot: a model of type 'position'"};
    }
    if (!entry.model) {
      Result<WorldNode> filled = Filled(std::move(node), entry);
      if (!filled.ok()) return filled.error();
      node = std::move(filled).value();
    }
    if (entry.controller) {
      node = WithoutController(std::move(node));
      controllers_[name] = entry.controller->controller;
    }
    for (const std::string& awaited : entry.ros_lockstep) ros_lockstep_.push_back({awaited, name});
    if (!entry.ros_domain) return Status();
    WarnOfPorts(*entry.ros_domain, 1);
    if (entry.ros_domain->each) {
      return Error{entry.ros_domain->where, "found 'each' for one robot, expected a ROS domain from 0 to 230"};
    }
    return SetRosDomain(name, entry.ros_domain->first, entry.ros_domain->where);
  }

  // Sets a robot's own domain, which no other robot has.
  Status SetRosDomain(const std::string& robot, std::uint32_t domain, const SourceLocation& where) {
    if (domain > kMaxRosDomain) {
      return Error{where,
                   fmt::format("found the ROS domain {} for robot {}, expected at most {}: the ports of a higher "
                               "one would exceed 65535",
                               domain, Quoted(robot), kMaxRosDomain)};
    }
    const auto [owner, is_new] = domain_owners_.emplace(domain, robot);
    if (!is_new && owner->second != robot) {
      return Error{where,
                   fmt::format("found the ROS domain {} for robot {}, which robot {} has already, expected one for "
                               "each robot",
                               domain, Quoted(robot), Quoted(owner->second))};
    }
    ros_domains_[robot] = domain;
    return Status();
  }

  // Linux gives the ports from 32768 to 60999 to any program.
  void WarnOfPorts(const RosDomainEntry& entry, std::uint32_t count) {
    constexpr std::uint32_t kFirstShared = 102;
    constexpr std::uint32_t kLastShared = 214;
    if (entry.first > kLastShared || entry.first + count <= kFirstShared) return;
    tree_.warnings.push_back({entry.where, fmt::format("the ports of the ROS domains {} to {} may be in use by other "
                                                       "programs, because Linux gives them to any; those of others are "
                                                       "not",
                                                       kFirstShared, kLastShared)});
  }

  // Sets the domains of the robots of a rule.
  Status SetRosDomains(const SpawnEntry& rule, const WorldNode& prototype, const std::vector<std::string>& names) {
    if (!rule.ros_domain) return Status();
    const RosDomainEntry& entry = *rule.ros_domain;
    if (prototype.type != "position") {
      return Error{entry.where, "found a ROS domain for a model of type " + Quoted(prototype.type) +
                                    ", expected it for robots only: models of type 'position'"};
    }
    if (!entry.each && names.size() > 1) {
      return Error{entry.where, fmt::format("found one ROS domain for {} robots, expected {{\"each\": {}}}",
                                            names.size(), entry.first)};
    }
    WarnOfPorts(entry, static_cast<std::uint32_t>(names.size()));
    for (std::size_t i = 0; i < names.size(); ++i) {
      Status status = SetRosDomain(names[i], entry.first + static_cast<std::uint32_t>(i), entry.where);
      if (!status.ok()) return status;
    }
    return Status();
  }

  Status AddSpawn(const SpawnEntry& rule) {
    Result<WorldNode> made = MakePlain(rule.model);
    if (!made.ok()) return made.error();
    // Made once and copied: the copies share the children, so that 20,000 robots cost 20,000 small nodes.
    const WorldNode prototype = rule.controller ? WithoutController(made.value()) : made.value();
    if (!IsModelType(prototype.type)) {
      return Error{rule.model.where, "found " + Quoted(prototype.type) + ", expected a model"};
    }
    if (rule.controller && prototype.type != "position") {
      return Error{rule.controller->where, "found a controller for a model of type " + Quoted(prototype.type) +
                                               ", expected it for robots only: models of type 'position'"};
    }
    PlannedSpawn planned{&rule, {}, true};
    for (std::uint32_t i = 0; i < rule.count; ++i) {
      const std::string name =
          rule.name_prefix ? rule.name_prefix->text + std::to_string(i) : FreeName(rule.model.text);
      const SourceLocation& where = rule.name_prefix ? rule.name_prefix->where : rule.model.where;
      WorldNode node = prototype;
      node.Set(NameProperty(name, where));
      if (rule.controller) controllers_[FullName("", name)] = rule.controller->controller;
      if (Status error = Add(std::move(node), FullName("", name), where); !error.ok()) return error;
      planned.names.push_back(FullName("", name));
    }
    for (const std::string& robot : planned.names) {
      for (const std::string& awaited : rule.ros_lockstep) ros_lockstep_.push_back({awaited, robot});
    }
    Status domains = SetRosDomains(rule, prototype, planned.names);
    spawns_.push_back(std::move(planned));
    return domains;
  }

  // A scenario's controller replaces the world's.
  static WorldNode WithoutController(WorldNode node) {
    std::erase_if(node.properties, [](const Property& property) { return property.name == "ctrl"; });
    return node;
  }

  static std::string NameOf(const WorldNode& node) {
    return FullName("", std::get<std::string>(node.Find("name")->value.content));
  }

  const ScenarioFile& file_;
  WorldTree tree_;
  FileUnits units_;
  std::map<std::string, std::size_t> top_level_;     // indices of the world's children by full name
  std::map<std::string, std::size_t> next_numbers_;  // by prefix of names
  std::vector<PlannedSpawn> spawns_;
  std::map<std::string, ControllerDescription> controllers_;  // by robot
  std::map<std::string, std::uint32_t> ros_domains_;          // by robot
  std::vector<RosLockstepName> ros_lockstep_;                 // of robots
  std::map<std::uint32_t, std::string> domain_owners_;        // robots, by ROS domain
};

bool HasBitmap(const WorldNode& node) {
  return node.Find("bitmap") != nullptr || std::any_of(node.children.begin(), node.children.end(), HasBitmap);
}

// The node or define with bitmaps that do not depend on the folder of their file.
template <typename NodeOrDefine>
NodeOrDefine WithAnchoredBitmaps(const std::filesystem::path& directory, NodeOrDefine node) {
  for (Property& property : node.properties) {
    std::string* path = std::get_if<std::string>(&property.value.content);
    if (property.name == "bitmap" && path != nullptr) *path = (directory / *path).lexically_normal().string();
  }
  for (std::size_t i = 0; i < node.children.size(); ++i) {
    if (!HasBitmap(node.children[i])) continue;
    WorldNode& child = node.children.Change(i);
    child = WithAnchoredBitmaps(directory, std::move(child));
  }
  return node;
}

}  // namespace

Result<ScenarioPlan> ApplyScenario(const ScenarioFile& file,
                                   const std::optional<ControllerDescription>& default_controller, WorldTree tree) {
  return Adder(file, std::move(tree)).Run(default_controller);
}

WorldTree Merged(WorldTree tree, WorldTree include, const SourceLocation& where) {
  std::error_code ignored;
  const std::filesystem::path directory = std::filesystem::absolute(include.directory, ignored);
  for (auto& [name, define] : include.defines) {
    if (!tree.defines.emplace(name, WithAnchoredBitmaps(directory, std::move(define))).second) {
      tree.warnings.push_back({where, "the define " + Quoted(name) + " is there already: the first one counts"});
    }
  }
  // One building and one map of cells for a world: the first.
  if (tree.site == nullptr) tree.site = std::move(include.site);
  if (tree.grid == nullptr) tree.grid = std::move(include.grid);
  for (std::size_t i = 0; i < include.world.children.size(); ++i) {
    // A relative bitmap of an include starts at the include's folder; the merged tree knows only the folder of the top
    // file.
    tree.world.children.Add(WithAnchoredBitmaps(directory, std::move(include.world.children.Change(i))));
  }
  for (Property& property : include.world.properties) {
    if (tree.world.Find(property.name) == nullptr) tree.world.Set(std::move(property));
  }
  std::move(include.warnings.begin(), include.warnings.end(), std::back_inserter(tree.warnings));
  for (std::string& file : include.files) {
    if (std::find(tree.files.begin(), tree.files.end(), file) == tree.files.end()) {
      tree.files.push_back(std::move(file));
    }
  }
  return tree;
}

}  // namespace troupe
