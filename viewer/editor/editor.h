// Editor: the edits of a file that the page asks for. An edit that the file does not load with is refused, with the
// place in the file; only the text pane may leave an error in the text.
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

#include "common/base/allowed_paths.h"
#include "common/base/result.h"
#include "common/geometry/pose.h"
#include "common/worldfile/edit/stage_syntax.h"
#include "common/worldfile/edit/written_model.h"
#include "viewer/editor/editable_world.h"
#include "viewer/editor/edited_file.h"

namespace troupe {

class Editor {
 public:
  // A file that does not exist yet is an empty one. A file with an error is opened, for its text to be corrected. The
  // error is a file that cannot be read, or is of another kind.
  // The text may name files in the folders of those that it names now, and the `allowed` ones: the page that edits it
  // is not to read others.
  static Result<std::unique_ptr<Editor>> Open(const std::string& path, const std::vector<std::string>& allowed = {});

  // The newest text that loads makes this world; null: none has loaded so far.
  const EditableWorld* world() const { return world_.get(); }
  std::uint64_t version() const { return version_; }  // counts the worlds
  const std::string& path() const { return file_.path(); }
  const std::string& text() const { return file_.text(); }
  bool is_modified() const { return file_.is_modified(); }
  const AllowedPaths& allowed() const { return allowed_; }
  // True for a shared library that the file named when it was opened: a page is not to choose code that runs.
  bool MayRun(const std::string& controller) const { return libraries_.contains(controller); }

  // A request of the page, with its "op"; the result is for the reply. docs/editor.md lists the operations.
  Result<nlohmann::json> Apply(const nlohmann::json& request);

  // In the world frame, m and rad.
  Status SetPose(const std::string& name, const Pose& pose);
  // Returns the name of the new entity.
  Result<std::string> Add(const std::string& model, const Pose& pose);
  Status Remove(const std::string& name);
  Status Rename(const std::string& before, const std::string& after);

 private:
  // The place of a statement, or of a scenario's entry, that may be edited.
  struct Place;
  using Json = nlohmann::json;

  Editor(EditedFile file, EditedKind kind) : file_(std::move(file)), kind_(kind) {}

  void Load();
  // `model`: a define that must give a model, though the file may have none of it.
  Status Commit(std::string text, const std::string& label, const std::string& model = "");
  Status CheckText() const;  // the error of the text, if it has one

  Result<const EditedEntity*> FindEntity(const std::string& name) const;
  // The entity's statement in this file. The error tells where it is instead.
  Result<Place> PlaceOf(const EditedEntity& entity) const;
  std::string FreeName(const std::string& prefix) const;
  WrittenValue PoseValue(const EditedEntity& entity, const Pose& pose) const;
  Status SetScenarioPose(const EditedEntity& entity, const Pose& pose);
  Status AddWritten(const WrittenModel& model, const std::string& label);
  Status SetBody(const Place& place, const std::string& name, const std::optional<WrittenValue>& value,
                 const std::string& label);

  Result<Json> Document() const;
  Result<Json> SetText(const Json& request);
  Result<Json> Palette() const;
  Result<Json> EntityReport(const std::string& name) const;
  Result<Json> SetProperty(const Json& request);
  Result<Json> SetMember(const Json& request);
  Result<Json> AddModel(const Json& request);
  Result<Json> ModelReport(const std::string& name) const;
  Result<Json> SetModel(const Json& request);
  Result<Json> ChangePart(const Json& request);
  Result<Json> SetRegion(const Json& request);
  // The body of a define, or of a part in it by the indices of its entries.
  Result<Place> PlaceOfPart(const Json& request) const;

  EditedFile file_;
  const EditedKind kind_;
  AllowedPaths allowed_;
  std::set<std::string> libraries_;
  std::unique_ptr<EditableWorld> world_;
  std::optional<Error> error_;  // of the text
  std::uint64_t version_ = 0;
};

}  // namespace troupe
