#include "viewer/editor/editor.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <numbers>
#include <utility>

#include "viewer/editor/edit_target.h"
#include "viewer/editor/model_library.h"
#include "viewer/editor/model_parts.h"
#include "worldfile/edit/stage_edit.h"
#include "worldfile/gazebo/gazebo_tree.h"
#include "worldfile/stage/stage_world.h"
#include "worldfile/text/text_file.h"

namespace troupe {
namespace {

void AddFoldersOf(const std::vector<std::string>& files, AllowedPaths& allowed) {
  for (const std::string& file : files) allowed.Add(DirectoryOf(file));
}

}  // namespace

// The file on disk is the user's: what it names at first may be read, libraries included. What the page writes later
// may not extend that.
Result<std::unique_ptr<Editor>> Editor::Open(const std::string& named, const std::vector<std::string>& allowed) {
  const Result<EditTarget> target = TargetOf(named);
  if (!target.ok()) return target.error();
  const auto& [path, kind, initial] = target.value();
  Result<EditedFile> file = EditedFile::Open(path, initial);
  if (!file.ok()) return file.error();
  std::unique_ptr<Editor> editor(new Editor(std::move(file).value(), kind));
  for (const std::string& folder : allowed) editor->allowed_.Add(folder);
  AddFoldersOf({path}, editor->allowed_);
  for (const std::string& folder : LibraryFolders()) editor->allowed_.Add(folder);
  // All that the file names at first.
  const Result<std::unique_ptr<EditableWorld>> first =
      MakeEditedWorld(kind, editor->text(), path, {AllowedPaths::All()});
  if (first.ok()) {
    AddFoldersOf(first.value()->tree.files, editor->allowed_);
    AddFoldersOf(first.value()->loaded.files, editor->allowed_);
    for (const RobotDescription& robot : first.value()->loaded.world.robots) {
      if (NamesLibrary(robot.controller.name)) editor->libraries_.insert(robot.controller.name);
    }
  }
  editor->Load();
  editor->first_images_ = editor->NamedImages();
  return editor;
}

// For texts that stay whatever they are: typed by the user, undone, or read from the disk.
void Editor::Load() {
  Result<std::unique_ptr<EditableWorld>> world = MakeEditedWorld(kind_, text(), path(), files());
  error_.reset();
  if (!world.ok()) {
    error_ = world.error();
    return;
  }
  world_ = std::move(world).value();
  ++version_;
}

Status Editor::CheckText() const {
  if (error_) return Error{{}, "the text has an error, which is to be corrected first: " + error_->ToString()};
  if (world_ == nullptr) return Failure("no world is loaded");
  return {};
}

// Images that are edited and not saved are read from their versions, others from their files.
NamedFiles Editor::FilesWith(const PictureVersions& versions) const {
  const auto source = [this, versions](const std::string& path, const PixelRule& rule) -> std::optional<Bitmap> {
    const PicturePointer picture = file_.pictures().Find(versions, path);
    return picture != nullptr ? std::optional(picture->Occupied(rule)) : std::nullopt;
  };
  return {allowed_, source};
}

// A define that the file does not use is not built with the world, so that it is built alone as well.
Status Editor::Commit(std::string text, const PictureVersions& versions, const std::string& label,
                      const std::string& model) {
  const NamedFiles files = FilesWith(versions);
  Result<std::unique_ptr<EditableWorld>> world = MakeEditedWorld(kind_, text, path(), files);
  if (!world.ok()) return world.error();
  if (!model.empty()) {
    if (const Result<LoadedWorld> built = BuildAlone(world.value()->tree, model, files); !built.ok())
      return built.error();
  }
  file_.Change(std::move(text), versions, label);
  world_ = std::move(world).value();
  error_.reset();
  ++version_;
  return {};
}

Result<const EditedEntity*> Editor::FindEntity(const std::string& name) const {
  if (Status broken = CheckText(); !broken.ok()) return broken.error();
  const EditedEntity* const entity = world_->Find(name);
  if (entity == nullptr) return Error{{}, "found no " + Quoted(name) + " in the world"};
  return entity;
}

Error Editor::Elsewhere(const EditedEntity& entity, const std::string& what) {
  return {
      {},
      fmt::format("{} is {} at {}:{}; edit it there", Quoted(entity.name), what, entity.where.file, entity.where.line)};
}

// A model may be written in an include file, made by a spawn rule or be a part of a define: the error says where it can
// be edited.
Result<Editor::Place> Editor::PlaceOf(const EditedEntity& entity) const {
  const auto elsewhere = [&](const std::string& what) { return Elsewhere(entity, what); };
  if (entity.where.file != path()) {
    if (IsRobotOfWorld(entity)) return PlaceOfRobotOfWorld(entity);
    return elsewhere("in another file,");
  }
  Place place;
  place.text = text();
  if (kind_ == EditedKind::kScenario) {
    Result<Place> scenario = PlaceOfScenario();
    if (!scenario.ok()) return scenario.error();
    place.json = std::move(scenario.value().json);
    const auto chain = place.json->PathTo(place.json->OffsetOf(entity.where));
    for (std::size_t i = 1; i < chain.size(); ++i) {
      if (chain[i]->key == "spawn") return elsewhere("made by a spawn rule,");
      const bool is_list = chain[i]->key == "models" || chain[i]->key == "robots" || chain[i]->key == "children";
      if (!is_list || i + 1 >= chain.size()) continue;
      place.holder = chain[i];
      place.entry = chain[i + 1];
    }
    if (place.entry == nullptr) return elsewhere("not an entry of the scenario,");
    return place;
  }
  Result<StageTree> syntax = ParseStage(text(), path());
  if (!syntax.ok()) return syntax.error();
  place.stage = std::make_unique<StageTree>(std::move(syntax).value());
  const auto chain = FindStatement(*place.stage, entity.where.line, entity.where.column);
  if (chain.empty()) return elsewhere("not found,");
  if (chain.front()->kind == StatementKind::kDefine && !entity.on_shelf) return elsewhere("a part of a model");
  place.statement = chain.back();
  return place;
}

// Without an upper limit: there are fewer entities than numbers.
std::string Editor::FreeName(const std::string& prefix) const {
  for (std::size_t number = 1;; ++number) {
    std::string name = prefix + std::to_string(number);
    if (world_->Find(name) == nullptr) return name;
  }
}

// In the frame and the units of the file, each number in its old form where it has not changed.
Value Editor::PoseValue(const EditedEntity& entity, const Pose& pose) const {
  const FileUnits units = UnitsOf(world_->tree.world);
  const Pose before = PoseInWorld(world_->loaded.world, entity.model);
  const Pose X_PM = Inverse(Pose{entity.X_WP.x, entity.X_WP.y, 0.0, entity.X_WP.heading}) * pose;
  std::vector<Value::Number> old = NumbersOf(*entity.node, "pose");
  const double z = old.size() == 4 ? old[2].value * units.metres : 0.0;
  return ChangedPose(std::move(old), {X_PM.x, X_PM.y, z + pose.z - before.z, X_PM.heading}, units);
}

// A model that has an entry in this file gets the property `pose` there.
Status Editor::SetPose(const std::string& name, const Pose& pose) {
  const Result<const EditedEntity*> found = FindEntity(name);
  if (!found.ok()) return found.error();
  const EditedEntity& entity = *found.value();
  if (!IsFinite(pose)) return Error{{}, "found a pose that is not finite"};
  if (entity.on_shelf) return Error{{}, "the models of an include file have no place; they only stand side by side"};
  if (kind_ == EditedKind::kScenario) return SetScenarioPose(entity, pose);
  const Result<Place> place = PlaceOf(entity);
  if (!place.ok()) return place.error();
  return Commit(WithProperty(text(), BodyOf(*place.value().statement), "pose", PoseValue(entity, pose)),
                "the move of " + name);
}

// Libraries are read once and kept: reading them builds each model. A library file that is edited itself is not
// offered.
std::vector<const ModelLibrary*> Editor::OtherLibraries() const {
  std::vector<const ModelLibrary*> others;
  const FileUnits units = UnitsOf(world_->tree.world);
  if (units.metres != 1.0 || units.radians == 1.0) return others;
  if (libraries_read_ == nullptr) libraries_read_ = std::make_shared<const std::vector<ModelLibrary>>(ReadLibraries());
  std::set<std::string> used;
  for (const std::string& file : world_->tree.files) used.insert(std::filesystem::weakly_canonical(file).string());
  used.insert(std::filesystem::weakly_canonical(path()).string());
  for (const ModelLibrary& library : *libraries_read_) {
    if (!used.contains(library.path)) others.push_back(&library);
  }
  if (model_files_ == nullptr) {
    model_files_ = std::make_shared<const ModelLibrary>(ReadModelFiles(DirectoryOf(path()), allowed_));
  }
  if (!model_files_->models.empty()) others.push_back(model_files_.get());
  return others;
}

Result<std::string> Editor::WithLibrary(const ModelLibrary& library) const {
  if (library.path.empty()) return text();
  const std::string name = NameOfLibrary(library, path());
  if (kind_ != EditedKind::kScenario) {
    const Result<StageTree> syntax = ParseStage(text(), path());
    if (!syntax.ok()) return syntax.error();
    return WithInclude(text(), syntax.value(), name);
  }
  const Result<JsonTree> read = JsonTree::Parse(text(), path());
  if (!read.ok()) return read.error();
  const JsonNode& root = read.value().root();
  const std::string element = nlohmann::json(name).dump();
  if (const JsonNode* const includes = root.Find("include")) return WithElement(text(), *includes, element);
  return WithMember(text(), root, "include", "[" + element + "]");
}

// The models of the file precede those of libraries with the same name.
Result<std::string> Editor::Add(const std::string& model, const Pose& pose) {
  if (Status broken = CheckText(); !broken.ok()) return broken.error();
  if (!IsFinite(pose)) return Error{{}, "found a pose that is not finite"};
  const std::vector<PaletteModel> palette = PaletteOf(world_->tree);
  const auto is_model = [&](const auto& known) { return known.name == model; };
  const auto known = std::find_if(palette.begin(), palette.end(), is_model);
  std::string type = known != palette.end() ? known->type : "";
  Result<std::string> with_library = text();
  if (type.empty()) {
    for (const ModelLibrary* const library : OtherLibraries()) {
      const auto found = std::find_if(library->models.begin(), library->models.end(), is_model);
      if (found == library->models.end()) continue;
      type = found->type;
      with_library = WithLibrary(*library);
      break;
    }
    if (type.empty()) return Error{{}, "found " + Quoted(model) + ", expected a model of the file or of a library"};
    if (!with_library.ok()) return with_library.error();
  }
  const bool is_scenario = kind_ == EditedKind::kScenario;
  const FileUnits units = is_scenario ? FileUnits{} : UnitsOf(world_->tree.world);
  const double heading =
      !is_scenario && units.radians == 1.0 ? pose.heading : WrappedDegrees(pose.heading * 180.0 / std::numbers::pi);
  // A scenario's entry has the file in place of a type; one of a world has it as a property.
  const bool is_file = IsModelFile(model);
  WrittenModel written{is_file && !is_scenario ? type : model, {}, {}};
  std::string name = FreeName(is_file ? NameOfModelFile(model) : model);
  written.Set("name", Text(name));
  if (is_file && !is_scenario) written.Set("model_file", Text(model));
  std::vector<double> numbers{pose.x / units.metres, pose.y / units.metres, pose.z / units.metres, heading};
  if (is_scenario && pose.z == 0.0) numbers.erase(numbers.begin() + 2);
  written.Set("pose", Tuple(numbers));
  Result<std::string> added = WithAdded(with_library.value(), written, type == "position");
  if (!added.ok()) return added.error();
  if (Status failure = Commit(std::move(added).value(), "the addition of " + name); !failure.ok())
    return failure.error();
  return name;
}

// The copy is changed as a text of its own, so that it has the comments and the form of the entry.
Result<std::string> Editor::Copy(const std::string& name, const Pose& pose) {
  const Result<const EditedEntity*> found = FindEntity(name);
  if (!found.ok()) return found.error();
  const EditedEntity& entity = *found.value();
  if (!IsFinite(pose)) return Error{{}, "found a pose that is not finite"};
  if (entity.where.file != path()) return Elsewhere(entity, "in another file,");
  if (entity.parent != nullptr || entity.on_shelf) {
    return Error{{}, Quoted(name) + " has no place of its own in this file, expected a whole model of the world"};
  }
  const Result<Place> found_place = PlaceOf(entity);
  if (!found_place.ok()) return found_place.error();
  const Place& place = found_place.value();
  // A model without a name has the name of its type, a colon and a number.
  std::string prefix = name.substr(0, name.find_last_not_of("0123456789") + 1);
  if (prefix.ends_with(':')) prefix.pop_back();
  std::string copy = FreeName(prefix);
  const std::string label = "the addition of " + copy;
  if (place.statement != nullptr) {
    std::string entry(place.statement->span.Of(text()));
    for (const auto& [property, value] : {std::pair("name", Text(copy)), std::pair("pose", PoseValue(entity, pose))}) {
      const Result<StageTree> alone = ParseStage(entry, path());
      if (!alone.ok()) return alone.error();
      entry = WithProperty(entry, BodyOf(alone.value().statements.front()), property, value);
    }
    const Status failure = Commit(WithCopy(text(), place.stage->body(), *place.statement, entry), label);
    return failure.ok() ? Result<std::string>(copy) : failure.error();
  }
  const JsonNode* const old = place.entry->Find("pose");
  std::string numbers = PlainNumber(pose.x, kLengthDecimals) + ", " + PlainNumber(pose.y, kLengthDecimals) + ", ";
  if (pose.z != 0.0 || (old != nullptr && old->items.size() == 4))
    numbers += PlainNumber(pose.z, kLengthDecimals) + ", ";
  numbers += PlainNumber(WrappedDegrees(pose.heading * 180.0 / std::numbers::pi), kHeadingDecimals);
  std::string entry(place.entry->span.Of(text()));
  for (const auto& [key, value] :
       {std::pair("name", nlohmann::json(copy).dump()), std::pair("pose", "[" + numbers + "]")}) {
    const Result<JsonTree> alone = JsonTree::Parse(entry, path());
    if (!alone.ok()) return alone.error();
    entry = WithMember(entry, alone.value().root(), key, value);
  }
  const Status failure = Commit(WithElement(text(), *place.holder, entry), label);
  return failure.ok() ? Result<std::string>(copy) : failure.error();
}

Status Editor::Remove(const std::string& name) {
  const Result<const EditedEntity*> entity = FindEntity(name);
  if (!entity.ok()) return entity.error();
  if (kind_ == EditedKind::kScenario && IsLeftOut(*entity.value())) return LeaveOut(name);
  const Result<Place> found = PlaceOf(*entity.value());
  if (!found.ok()) return found.error();
  const Place& place = found.value();
  if (place.statement != nullptr) {
    return Commit(WithoutStatement(text(), *place.statement), "the deletion of " + name);
  }
  const auto index = static_cast<std::size_t>(place.entry - place.holder->items.data());
  return Commit(WithoutItem(text(), *place.holder, index), "the deletion of " + name);
}

// Full names: another entity with the name would make references ambiguous.
Status Editor::Rename(const std::string& before, const std::string& after) {
  const Result<const EditedEntity*> entity = FindEntity(before);
  if (!entity.ok()) return entity.error();
  if (Status wrong = CheckName(after); !wrong.ok()) return wrong;
  if (entity.value()->on_shelf) return Error{{}, "the name of a define is changed in the text, with its uses"};
  if (entity.value()->where.file != path()) return Elsewhere(*entity.value(), "in another file,");
  if (world_->Find(after) != nullptr) return Error{{}, "found the name " + Quoted(after) + " in use, expected another"};
  const Result<Place> found = PlaceOf(*entity.value());
  if (!found.ok()) return found.error();
  const Place& place = found.value();
  const std::string label = "the new name of " + before;
  if (place.entry != nullptr) {
    return Commit(WithMember(text(), *place.entry, "name", nlohmann::json(after).dump()), label);
  }
  // The name of a child counts below its parent, unless it begins with a slash.
  const std::string written = entity.value()->parent != nullptr ? "/" + after : after;
  return Commit(WithProperty(text(), BodyOf(*place.statement), "name", Text(written)), label);
}

}  // namespace troupe
