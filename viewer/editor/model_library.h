// ModelLibrary: the models of include files that a file may use without having them: those of the installation, and of
// the folders in STAGEPATH.
//
// They are offered in the palette with a picture; a library is included by the file only when one of its models is put
// down, so a file names what it uses. Only files in metres and degrees can include them: a file's units hold for what
// it includes.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "common/base/paths.h"
#include "troupe/result.h"
#include "worldfile/stage/stage_tree.h"

namespace troupe {

struct LibraryModel {
  std::string name;
  std::string type;  // base type
  SourceLocation where;
  nlohmann::json picture;  // PictureOf (editable_world.h)
};

struct ModelLibrary {
  std::string path;  // without links; empty: of ReadModelFiles, which are used without an include
  std::vector<LibraryModel> models;
};

// The folders with such files.
std::vector<std::string> LibraryFolders();

// All that can be read, in the order of the folders. A model without a body of its own is left out: others are made
// from it.
std::vector<ModelLibrary> ReadLibraries();

// The models and robots of Gazebo and ROS (SDF, URDF, xacro) in a folder and in those in it, under their paths from
// there, which is how a file of the folder names them. Files that cannot be read, or have no model, are left out, and
// so are those beyond some tens.
ModelLibrary ReadModelFiles(const std::string& folder, const AllowedPaths& allowed);

// How the file at `path` names the library: by its name alone, if that finds it.
std::string NameOfLibrary(const ModelLibrary& library, const std::string& path);

// The text of a Stage file with an include behind its others, before the first entry. The models that the file defines
// before that keep their meaning.
std::string WithInclude(const std::string& text, const StageTree& tree, const std::string& name);

}  // namespace troupe
