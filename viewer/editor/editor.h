// Editor: the edits of a file that the page asks for. An edit that the file does not load with is refused, with the
// place in the file; only the text pane may leave an error in the text.
//
// An edit changes the text of one statement and leaves every other byte as the user wrote it, comments and layout
// included. Entities that other files define are not edited here; the error says where they are.
//
// The page is less trusted than the user: it may name files only in allowed folders (Open), and never
// choose a library of code to run.
//
// Threads: one at a time.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "common/base/json_tree.h"
#include "common/base/paths.h"
#include "troupe/pose.h"
#include "troupe/result.h"
#include "viewer/editor/editable_world.h"
#include "viewer/editor/edited_file.h"
#include "viewer/gateway/edit_operation.h"
#include "worldfile/edit/written_model.h"
#include "worldfile/stage/stage_tree.h"

namespace troupe {

struct ModelLibrary;

class Editor {
 public:
  // The file of the EditTarget; one that does not exist yet has its initial text. A file with an error is opened, for
  // its text to be corrected. Errors: those of TargetOf, and a file that cannot be read.
  // The text may name files in the folders of those that it names now, and the `allowed` ones: the page that edits it
  // is not to read others.
  static Result<std::unique_ptr<Editor>> Open(const std::string& named, const std::vector<std::string>& allowed = {});

  // The newest text that loads makes this world; null: none has loaded so far.
  const EditableWorld* world() const { return world_.get(); }
  std::uint64_t version() const { return version_; }  // counts the worlds
  const std::string& path() const { return file_.path(); }
  const std::string& text() const { return file_.text(); }
  bool is_modified() const { return file_.is_modified(NamedImages()); }
  bool has_unsaved_edits() const { return file_.has_unsaved_edits(NamedImages()); }
  // The files with the images as they are edited. Valid until the next edit.
  NamedFiles files() const { return FilesWith(file_.versions()); }
  // True for a shared library that the file named when it was opened: a page is not to choose code that runs.
  bool MayRun(const std::string& controller) const { return libraries_.contains(controller); }

  // The operations of the page; the results are for the replies.
  Result<nlohmann::json> Execute(const edit::Document&) const;
  Result<nlohmann::json> Execute(const edit::Text&) const;
  Result<nlohmann::json> Execute(const edit::Palette&) const;
  Result<nlohmann::json> Execute(const edit::Help&) const;
  Result<nlohmann::json> Execute(const edit::Bitmaps&);
  Result<nlohmann::json> Execute(const edit::Entity& operation) const;
  Result<nlohmann::json> Execute(const edit::Model& operation) const;
  Result<nlohmann::json> Execute(const edit::SetText& operation);
  Result<nlohmann::json> Execute(const edit::Save& operation);
  Result<nlohmann::json> Execute(const edit::Reload&);
  Result<nlohmann::json> Execute(const edit::Undo&);
  Result<nlohmann::json> Execute(const edit::Redo&);
  Result<nlohmann::json> Execute(const edit::SetPose& operation);
  Result<nlohmann::json> Execute(const edit::SetProperty& operation);
  Result<nlohmann::json> Execute(const edit::SetValue& operation);
  Result<nlohmann::json> Execute(const edit::Rename& operation);
  Result<nlohmann::json> Execute(const edit::Delete& operation);
  Result<nlohmann::json> Execute(const edit::Copy& operation);
  Result<nlohmann::json> Execute(const edit::Together& operation);
  Result<nlohmann::json> Execute(const edit::AddModel& operation);
  Result<nlohmann::json> Execute(const edit::SetModel& operation);
  Result<nlohmann::json> Execute(const edit::SetPartProperty& operation);
  Result<nlohmann::json> Execute(const edit::AddPart& operation);
  Result<nlohmann::json> Execute(const edit::RemovePart& operation);
  Result<nlohmann::json> Execute(const edit::ShapePart& operation);
  Result<nlohmann::json> Execute(const edit::SetGripperRoles& operation);
  Result<nlohmann::json> Execute(const edit::CreateBitmap& operation);
  Result<nlohmann::json> Execute(const edit::DrawBitmap& operation);

  // In the world frame, m and rad.
  Status SetPose(const std::string& name, const Pose& pose);
  // Returns the name of the new entity.
  Result<std::string> Add(const std::string& model, const Pose& pose);
  // A copy of an entry of this file, with all that the entry has. Returns its name.
  Result<std::string> Copy(const std::string& name, const Pose& pose);
  Status Remove(const std::string& name);
  Status Rename(const std::string& before, const std::string& after);

 private:
  // The place of a statement, or of a scenario's entry, that may be edited.
  // The syntax trees are owned, as the pointers are into them. They are parsed for one edit and dropped: the text is
  // the only state.
  struct Place {
    std::string text;                      // that of the file, or with an entry that is missing
    std::unique_ptr<StageTree> stage;      // of a Stage file
    const Statement* statement = nullptr;  // in there
    std::unique_ptr<JsonTree> json;        // of a scenario
    const JsonNode* holder = nullptr;      // in there: the list of the entry
    const JsonNode* entry = nullptr;
  };
  struct EditedPart;
  using Json = nlohmann::json;

  Editor(EditedFile file, EditedKind kind) : file_(std::move(file)), kind_(kind) {}

  // Builds the world of the present text. With an error the previous world stays in view, and error_ has the reason.
  void Load();
  NamedFiles FilesWith(const PictureVersions& versions) const;
  // `model`: a define that must give a model, though the file may have none of it.
  Status Commit(std::string text, const std::string& label, const std::string& model = "") {
    return Commit(std::move(text), file_.versions(), label, model);
  }
  // The one way in which an edit takes effect: the new text is loaded first, and becomes a state of the history only if
  // it loads.
  Status Commit(std::string text, const PictureVersions& versions, const std::string& label,
                const std::string& model = "");
  Status CheckText() const;  // the error of the text, if it has one

  Result<const EditedEntity*> FindEntity(const std::string& name) const;
  // The entity's statement in this file, or a scenario's entry. The error tells where it is instead.
  Result<Place> PlaceOf(const EditedEntity& entity) const;
  static Error Elsewhere(const EditedEntity& entity, const std::string& what);
  // The scenario as a whole.
  Result<Place> PlaceOfScenario() const;
  // A robot that the scenario may change by an entry, which the place has.
  bool IsRobotOfWorld(const EditedEntity& entity) const;
  Result<Place> PlaceOfRobotOfWorld(const EditedEntity& entity) const;
  // A model of the scenario's world or of a spawn rule, which `without` leaves out.
  bool IsLeftOut(const EditedEntity& entity) const;
  Status LeaveOut(const std::string& name);
  // The libraries that the file does not include yet, in the file's units; none: its units are others.
  std::vector<const ModelLibrary*> OtherLibraries() const;
  // The text with the library among its includes.
  Result<std::string> WithLibrary(const ModelLibrary& library) const;
  // The prefix with the smallest number from 1 that no entity has.
  std::string FreeName(const std::string& prefix) const;
  Value PoseValue(const EditedEntity& entity, const Pose& pose) const;
  Status SetScenarioPose(const EditedEntity& entity, const Pose& pose);
  // `text`, that of the file or changed, with an entry at the end, or in the scenario's lists: among its robots or its
  // models. Its pose is in the file's units and form.
  Result<std::string> WithAdded(const std::string& text, const WrittenModel& model, bool is_robot) const;
  Status SetBody(const Place& place, const std::string& name, const std::optional<Value>& value,
                 const std::string& label);

  static Result<Json> Done(const Status& status);
  Status ChangeProperty(const edit::SetProperty& operation);

  // The images that the world names as bitmaps, without links.
  std::set<std::string> NamedImages() const;
  // The image of a model. The error tells why it cannot be drawn into.
  Result<std::string> DrawableImage(const EditedEntity& entity) const;
  // The file of a model's bitmap; nothing: it has none, or one that may not be read.
  std::optional<std::string> ImageOf(const WorldNode& node) const;
  // The text in which all models of an image have their walls where they were before it changed.
  Result<std::string> WithPixelsInPlace(const std::string& image, const GreyPicture& before,
                                        const GreyPicture& after) const;

  Result<std::unique_ptr<EditedPart>> FindEditedPart(const edit::PartOperation& operation) const;

  EditedFile file_;
  const EditedKind kind_;
  AllowedPaths allowed_;
  std::set<std::string> libraries_;
  std::set<std::string> first_images_;  // that the file named when it was opened
  std::unique_ptr<EditableWorld> world_;
  std::optional<Error> error_;  // of the text
  std::uint64_t version_ = 0;
  mutable std::shared_ptr<const std::vector<ModelLibrary>> libraries_read_;  // null: not read yet
  mutable std::shared_ptr<const ModelLibrary> model_files_;                  // like them
};

}  // namespace troupe
