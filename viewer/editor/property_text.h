// Properties as text. Private to this folder.
#pragma once

#include <string>
#include <string_view>

#include "worldfile/stage/world_tree.h"

namespace troupe {

// As in a world file.
std::string ValueText(const Value& value);

// A name, perhaps with an index: "point[0]".
bool IsPropertyName(std::string_view name);

// The name of a type or a define: without an index.
bool IsTypeName(std::string_view name);

}  // namespace troupe
