// The override rules of a scenario.
#pragma once

#include <string>

#include "common/base/result.h"
#include "common/worldfile/scenario_file.h"

namespace troupe {

// Sets the rule's properties in every entity that it matches, at any depth: models by name, models and sensors by their
// type or a define that they were made from. A rule that matches nothing is an error that names what there is.
Status ApplyOverride(const OverrideEntry& rule, WorldTree* tree);

// True if `pattern` is `text`, where * stands for any text and ? for any one character.
bool MatchesGlob(const std::string& pattern, const std::string& text);

}  // namespace troupe
