// Worlds, models and robots of Gazebo and ROS as trees: SDF (.sdf, and .world with XML), URDF (.urdf), xacro (.xacro).
//
// A file with a world becomes a tree as a Stage file does, so that scenarios change it like any other. A file with a
// model becomes a define, under the name by which a scenario or an option refers to it; in a Stage world a model has
// the property `model_file`.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "common/base/paths.h"
#include "troupe/result.h"
#include "worldfile/stage/world_tree.h"

namespace troupe {

// Whether the file is one of these, by its ending, and for .world by its content.
bool IsGazeboPath(const std::string& path, const AllowedPaths& allowed = AllowedPaths::All());

// Whether a name in a scenario ends as that of a file with a model.
bool IsModelFile(std::string_view name);

// The name of such a file's model for its copies: the file's without its ending, or that of the folder of a model.sdf.
std::string NameOfModelFile(std::string_view path);

// The tree of a file with a world, or with models only.
Result<WorldTree> ReadGazeboTree(const std::string& path, const AllowedPaths& allowed = AllowedPaths::All());

// Adds a define of the name for the model of a file, if there is none yet. `where`: what names the file.
Status DefineModelFile(const std::string& name, const std::string& path, const SourceLocation& where,
                       const AllowedPaths& allowed, WorldTree& tree);

// Replaces the models and defines with the property `model_file` by those of the files, with their other properties.
Status ExpandModelFiles(const AllowedPaths& allowed, WorldTree& tree);

// Adds robots that options name: FILE, or FILE@X,Y[,HEADING] in m and degrees.
Status AddRobots(const std::vector<std::string>& robots, const AllowedPaths& allowed, WorldTree& tree);

}  // namespace troupe
