// What Troupe knows of Stage's model types, and of the properties that it does not honour.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "common/model/world_description.h"
#include "common/worldfile/property_reader.h"
#include "common/worldfile/shape_scaling.h"

namespace troupe {

// What a model of a type is before its properties are read.
struct TypeDefaults {
  std::string_view type;
  bool has_body = true;      // starts as a box of its size
  Size size{0.4, 0.4, 1.0};  // m
  Color color{1.0, 0.0, 0.0, 1.0};
  bool is_simulated = false;  // does more than being a body
};

// Nothing for types that do not exist.
const TypeDefaults* FindType(std::string_view type);

// "found model type 'laser', ..., expected one of ..."
std::string UnknownTypeMessage(const std::string& type);

// Names each property that nobody read in a warning. `kind` is "world", a model type, "sensor" or "block".
void WarnOfUnused(PropertyReader& reader, std::string_view kind);

}  // namespace troupe
