#include "common/worldfile/scenario_tree.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "common/worldfile/entity_names.h"
#include "common/worldfile/property_catalogue.h"
#include "common/worldfile/quote.h"
#include "common/worldfile/scenario_override.h"
#include "common/worldfile/stage_parser.h"

namespace troupe {
namespace {

Value::Number NumberOf(double value) {
  return {value, fmt::format("{}", value)};
}

// A scenario speaks metres and degrees, its world perhaps other units.
class PoseWriter {
 public:
  explicit PoseWriter(const Entity& world) {
    const std::string length = Text(world, "unit_length");
    metres_per_unit_ = length == "cm" ? 0.01 : length == "mm" ? 0.001 : 1.0;
    radians_ = Text(world, "unit_angle") == "radians";
  }

  // An entry without z leaves the entity's as it is.
  void Write(const PoseEntry& entry, Entity* entity) const {
    Value::Number z = NumberOf(entry.pose.z / metres_per_unit_);
    if (!entry.has_z) z = HeightOf(*entity);
    const double heading = radians_ ? entry.pose.heading : RadiansToDegrees(entry.pose.heading);
    std::vector<Value::Scalar> tuple{NumberOf(entry.pose.x / metres_per_unit_),
                                     NumberOf(entry.pose.y / metres_per_unit_), std::move(z), NumberOf(heading)};
    entity->Set(Property{"pose", Value{std::move(tuple), entry.where}, entry.where});
  }

 private:
  static std::string Text(const Entity& world, const char* name) {
    const Property* property = world.Find(name);
    const std::string* text = property != nullptr ? std::get_if<std::string>(&property->value.content) : nullptr;
    return text != nullptr ? *text : "";
  }
  static Value::Number HeightOf(const Entity& entity) {
    const Property* pose = entity.Find("pose");
    const auto* tuple = pose != nullptr ? std::get_if<std::vector<Value::Scalar>>(&pose->value.content) : nullptr;
    const auto* z = tuple != nullptr && tuple->size() > 2 ? std::get_if<Value::Number>(&(*tuple)[2]) : nullptr;
    return z != nullptr ? *z : NumberOf(0.0);
  }

  double metres_per_unit_ = 1.0;
  bool radians_ = false;
};

void SetName(const std::string& name, const SourceLocation& where, Entity* entity) {
  entity->Set(Property{"name", Value{name, where}, where});
}

// Adds the entries of one scenario, one after another; stops at the first error.
class Adder {
 public:
  Adder(const ScenarioFile& file, WorldTree* tree) : file_(file), tree_(tree), poses_(tree->world) {
    const std::vector<std::string> names = ChildNames(tree->world);
    for (std::size_t i = 0; i < names.size(); ++i) {
      if (!names[i].empty()) top_level_.emplace(FullName("", names[i]), i);
    }
  }

  Status Run(const std::optional<ControllerDescription>& default_controller, ScenarioPlan* plan) {
    for (const Property& property : file_.properties) tree_->world.Set(property);
    poses_ = PoseWriter(tree_->world);
    for (const ModelEntry& entry : file_.models) {
      if (Status error = AddModel(entry)) return error;
    }
    for (const ModelEntry& entry : file_.robots) {
      if (Status error = AddOrChangeRobot(entry)) return error;
    }
    for (const SpawnEntry& entry : file_.spawns) {
      if (Status error = AddSpawn(entry, plan)) return error;
    }
    for (const OverrideEntry& entry : file_.overrides) {
      if (Status error = ApplyOverride(entry, tree_)) return error;
    }
    for (PlannedSpawn& spawn : plan->spawns) {
      const Entity& first = tree_->world.children[top_level_.at(spawn.names.front())];
      spawn.origin_at_start = first.Find("localization_origin") == nullptr;
    }
    plan->controllers = std::move(controllers_);
    if (default_controller) {
      for (const auto& [name, index] : top_level_) {
        const Entity& entity = tree_->world.children[index];
        if (entity.type == "position" && entity.Find("ctrl") == nullptr) {
          plan->controllers.emplace(name, *default_controller);
        }
      }
    }
    return std::nullopt;
  }

 private:
  // A new entity of a type or define.
  Result<Entity> MakePlain(const PlacedText& model) const {
    Result<Entity> made = Instantiate(*tree_, model.text, model.where);
    if (!made.ok()) return Error{model.where, made.error().message};
    const std::string& type = made.value().type;
    if (IsModelType(type) && FindType(type) == nullptr) return Error{model.where, UnknownTypeMessage(type)};
    return made;
  }

  // A new entity of the entry's model, with the entry's properties and children.
  Result<Entity> Make(const ModelEntry& entry) {
    Result<Entity> made = MakePlain(*entry.model);
    if (!made.ok()) return made;
    Entity entity = std::move(made).value();
    if (entry.name) SetName(entry.name->text, entry.name->where, &entity);
    if (Status error = Fill(entry, &entity)) return *error;
    return entity;
  }

  Status Fill(const ModelEntry& entry, Entity* entity) {
    if (entry.pose) poses_.Write(*entry.pose, entity);
    for (const Property& property : entry.properties) entity->Set(property);
    for (const ModelEntry& child : entry.children) {
      Result<Entity> made = Make(child);
      if (!made.ok()) return made.error();
      entity->children.push_back(std::move(made).value());
    }
    return std::nullopt;
  }

  // Puts a new entity into the world; its name must be new.
  Status Add(Entity entity, const std::string& name, const SourceLocation& name_where) {
    if (!top_level_.emplace(name, tree_->world.children.size()).second) {
      return Error{name_where, "found the name " + Quoted(name) + " again, expected one that is not in the world yet"};
    }
    tree_->world.children.push_back(std::move(entity));
    return std::nullopt;
  }

  // "scout0", "scout1", ...: the first that is free.
  std::string FreeName(const std::string& prefix) {
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
    Result<Entity> made = Make(entry);
    if (!made.ok()) return made.error();
    const std::string name = entry.name ? entry.name->text : FreeName(entry.model->text);
    const SourceLocation& where = entry.name ? entry.name->where : entry.where;
    SetName(name, where, &made.value());
    return Add(std::move(made).value(), FullName("", name), where);
  }

  Status AddOrChangeRobot(const ModelEntry& entry) {
    if (!entry.model && !entry.name) {
      return Error{entry.where,
                   "found a robot with neither 'model' nor 'name', expected 'model' for a new one or "
                   "'name' for one of the world"};
    }
    if (entry.model) {
      if (Status error = AddModel(entry)) return error;
    } else {
      if (!top_level_.contains(FullName("", entry.name->text))) {
        return Error{entry.name->where, "found no model " + Quoted(entry.name->text) +
                                            " in the world, expected one, or 'model' to add a new one"};
      }
    }
    const std::string name = entry.name ? FullName("", entry.name->text) : NameOf(tree_->world.children.back());
    Entity& entity = tree_->world.children[top_level_.at(name)];
    if (entity.type != "position") {
      return Error{entry.model ? entry.model->where : entry.name->where,
                   "found a model of type " + Quoted(entity.type) + ", expected a robot: a model of type 'position'"};
    }
    if (!entry.model) {
      if (Status error = Fill(entry, &entity)) return error;
    }
    if (entry.controller) Control(*entry.controller, name, &entity);
    return std::nullopt;
  }

  Status AddSpawn(const SpawnEntry& rule, ScenarioPlan* plan) {
    Result<Entity> made = MakePlain(rule.model);
    if (!made.ok()) return made.error();
    const Entity& prototype = made.value();
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
      Entity entity = prototype;
      SetName(name, where, &entity);
      if (rule.controller) Control(*rule.controller, FullName("", name), &entity);
      if (Status error = Add(std::move(entity), FullName("", name), where)) return error;
      planned.names.push_back(FullName("", name));
    }
    plan->spawns.push_back(std::move(planned));
    return std::nullopt;
  }

  // The scenario's controller takes the place of the world's.
  void Control(const ControllerEntry& entry, const std::string& name, Entity* entity) {
    std::erase_if(entity->properties, [](const Property& property) { return property.name == "ctrl"; });
    controllers_[name] = entry.controller;
  }

  static std::string NameOf(const Entity& entity) {
    return FullName("", std::get<std::string>(entity.Find("name")->value.content));
  }

  const ScenarioFile& file_;
  WorldTree* tree_;
  PoseWriter poses_;
  std::map<std::string, std::size_t> top_level_;     // indices of the world's children by full name
  std::map<std::string, std::size_t> next_numbers_;  // by prefix of names
  std::map<std::string, ControllerDescription> controllers_;
};

// Makes bitmaps independent of the folder that relative paths start at.
template <typename EntityOrDefine>
void AnchorBitmaps(const std::filesystem::path& directory, EntityOrDefine* entity) {
  for (Property& property : entity->properties) {
    std::string* path = std::get_if<std::string>(&property.value.content);
    if (property.name == "bitmap" && path != nullptr) *path = (directory / *path).lexically_normal().string();
  }
  for (Entity& child : entity->children) AnchorBitmaps(directory, &child);
}

}  // namespace

Result<ScenarioPlan> ApplyScenario(const ScenarioFile& file,
                                   const std::optional<ControllerDescription>& default_controller, WorldTree* tree) {
  ScenarioPlan plan;
  if (Status error = Adder(file, tree).Run(default_controller, &plan)) return *error;
  return plan;
}

void MergeInclude(WorldTree include, const SourceLocation& where, WorldTree* tree) {
  std::error_code ignored;
  const std::filesystem::path directory = std::filesystem::absolute(include.directory, ignored);
  for (auto& [name, define] : include.defines) {
    AnchorBitmaps(directory, &define);
    if (!tree->defines.emplace(name, std::move(define)).second) {
      tree->warnings.push_back({where, "the define " + Quoted(name) + " is there already: the first one counts"});
    }
  }
  for (Entity& entity : include.world.children) {
    AnchorBitmaps(directory, &entity);
    tree->world.children.push_back(std::move(entity));
  }
  for (Property& property : include.world.properties) {
    if (tree->world.Find(property.name) == nullptr) tree->world.Set(std::move(property));
  }
  std::move(include.warnings.begin(), include.warnings.end(), std::back_inserter(tree->warnings));
  for (std::string& file : include.files) {
    if (std::find(tree->files.begin(), tree->files.end(), file) == tree->files.end()) {
      tree->files.push_back(std::move(file));
    }
  }
}

}  // namespace troupe
