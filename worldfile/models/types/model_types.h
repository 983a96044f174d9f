// The registry of model types: from a type's name in a world file to its defaults and its reader.
#pragma once

#include <map>
#include <string>
#include <string_view>

#include "worldfile/models/types/model_type.h"
#include "worldfile/stage/world_tree.h"

namespace troupe {

// Null for a type that does not exist. Valid for the program's life; any thread may call it.
const ModelType* FindModelType(std::string_view name);

// "found model type 'scot', expected the name of a define (chair, scout), or one of ...; did you mean 'scout'?"
std::string UnknownTypeMessage(const std::string& type, const std::map<std::string, Define>& defines);

}  // namespace troupe
