// The names of models: the given one, or "type:number".
#pragma once

#include <string>
#include <vector>

#include "worldfile/stage/world_tree.h"

namespace troupe {

// True if nodes of this type become models; the others (block, sensor, window) belong to their parent.
bool IsModelType(const std::string& type);

// The names of `parent`'s children in their order, without the parent's: the property "name", or TYPE:N where N counts
// the children of that type before this one. The name of a child that is no model is "".
std::vector<std::string> ChildNames(const WorldNode& parent);

// The full name of a child: "parent.child", or, for a name that starts with a slash, the rest of it.
std::string FullName(const std::string& parent_name, const std::string& name);

}  // namespace troupe
