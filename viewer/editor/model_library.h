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
  std::string path;  // without links
  std::vector<LibraryModel> models;
};

// The folders with such files.
std::vector<std::string> LibraryFolders();

// All that can be read, in the order of the folders. A model without a body of its own is left out: others are made
// from it.
std::vector<ModelLibrary> ReadLibraries();

// How the file at `path` names the library: by its name alone, if that finds it.
std::string NameOfLibrary(const ModelLibrary& library, const std::string& path);

// The text of a Stage file with an include behind its others, before the first entry. The models that the file defines
// before that keep their meaning.
std::string WithInclude(const std::string& text, const StageTree& tree, const std::string& name);

}  // namespace troupe
