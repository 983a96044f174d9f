// The names that models get: the given one, or "type:number".
#pragma once

#include <string>
#include <vector>

#include "common/worldfile/world_tree.h"

namespace troupe {

// True if entities of this type become models; the others (block, sensor, window) belong to what they stand in.
bool IsModelType(const std::string& type);

// The names of `parent`'s children in their order, without the parent's: the property "name", or TYPE:N where N counts
// the children of that type before this one. Children that are no models get "".
std::vector<std::string> ChildNames(const Entity& parent);

// The full name of a child: "parent.child", or what follows the slash of a name that starts with one.
std::string FullName(const std::string& parent_name, const std::string& name);

}  // namespace troupe
