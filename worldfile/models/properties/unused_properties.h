// Warnings about the properties that have no effect, with the reason where one is known.
#pragma once

#include <string_view>

#include "worldfile/models/properties/property_reader.h"

namespace troupe {

// Each warns of every property of its entry that was not read.
void WarnOfUnusedInWorld(PropertyReader& reader);
void WarnOfUnusedInSensor(PropertyReader& reader);
void WarnOfUnusedInBlock(PropertyReader& reader);
void WarnOfUnusedInModel(PropertyReader& reader, std::string_view type);

}  // namespace troupe
