// The macros of xacro files, for machines without the program: properties, arguments with their defaults, macros with
// parameters and blocks, conditions, includes with name spaces, and expressions (expression.h). What else the program
// knows (YAML, lists) is an error that names it. Depth, elements and evaluations are limited.
#pragma once

#include <string>

#include "troupe/result.h"
#include "worldfile/gazebo/model_files.h"
#include "worldfile/text/xml_reader.h"

namespace troupe {

// The root element with all macros applied. Places of its elements are those in their own files; in `path` if they are
// in that file, else without a line.
Result<XmlElement> ExpandXacro(const XmlElement& root, const std::string& path, ModelFiles& files);

// Whether the file needs it.
bool HasXacro(const XmlElement& root);

}  // namespace troupe
