// EditableWorld: the world that a text in editing makes, and for each entity of it the place in the text.
//
// It is rebuilt from the whole text after each edit, by the loader of runs: so what the editor shows is what a run
// would load, and an edit that does not load is refused before it counts. Places are statements of the text's tree,
// with which an edit changes exactly the bytes of one statement.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "common/base/paths.h"
#include "common/image/image_file.h"
#include "troupe/enum_names.h"
#include "troupe/result.h"
#include "worldfile/models/build_world.h"
#include "worldfile/stage/world_tree.h"

namespace troupe {

enum class EditedKind : std::uint8_t {
  kWorld,     // .world
  kInclude,   // .inc: its models are shown side by side
  kScenario,  // .json
};
constexpr auto NamesOf(EditedKind) {
  return std::array{"world", "include", "scenario"};
}

// The files that a text may name, and the contents of images that are edited and not saved.
struct NamedFiles {
  AllowedPaths allowed;
  ImageSource images = nullptr;
};

// A model without a parent in the world: the unit of edits.
struct EditedEntity {
  std::string name;     // full
  std::string type;     // base type
  std::string written;  // the type or define that the file names
  ModelId model;
  SourceLocation where;               // of its statement, in any file
  bool on_shelf = false;              // of an include file: stands for its define
  const WorldNode* node = nullptr;    // with the properties of its macros
  const WorldNode* parent = nullptr;  // null: the world
  Pose X_WP;                          // the parent's, at load
};

// The pointers of entities are into the tree: the two live and move together, behind one unique_ptr.
struct EditableWorld {
  WorldTree tree;
  LoadedWorld loaded;
  std::vector<EditedEntity> entities;  // in the order of the world's models

  const EditedEntity* Find(const std::string& name) const;
};

// `path` names the text in messages, and is where its relative paths start. The tree of the result does not move. The
// images of a scenario are read from their files.
Result<std::unique_ptr<EditableWorld>> MakeEditedWorld(EditedKind kind, const std::string& text,
                                                       const std::string& path, const NamedFiles& files);

// The types and defines that give models, and the models themselves, one alone in a world.
struct PaletteModel {
  std::string name;
  std::string type;
  SourceLocation where;  // of the define; no file: a type
};
// In the order of names, the plain types last.
std::vector<PaletteModel> PaletteOf(const WorldTree& tree);
// The world properties, defines and files of a tree, without its models.
WorldTree WithoutModels(const WorldTree& tree);
Result<LoadedWorld> BuildAlone(const WorldTree& tree, const std::string& model, const NamedFiles& files);

// The pose of a model in the world, at load.
Pose PoseInWorld(const WorldDescription& world, ModelId model);

// The bodies of models for a picture in the page:
// [{"outline": [[x, y], ...], "z": [min, max], "color": [r, g, b]}], in m and the world's frame; at most some hundred.
nlohmann::json PictureOf(const WorldDescription& world);
// The picture of these models alone, without their children.
nlohmann::json PictureOf(const WorldDescription& world, const std::vector<ModelId>& models);

// A small world to try a model in: a room with the model, and with a plain robot that drives towards it if the model is
// none itself.

inline constexpr const char* kProbe = "probe";  // name of the plain robot

// `tree`: that defines the model. `probe_height`: m, of the plain robot.
Result<LoadedWorld> MakeTestWorld(const WorldTree& tree, const std::string& model, double probe_height,
                                  const NamedFiles& files);

}  // namespace troupe
