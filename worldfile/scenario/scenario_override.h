// The override rules of a scenario.
#pragma once

#include <string>

#include "troupe/result.h"
#include "worldfile/scenario/scenario_file.h"

namespace troupe {

// The world with the rule's properties in every node that it matches, at any depth: models by name, models and sensors
// by their type or a define that they were made from. A rule without a match is an error that lists names and types.
Result<WorldNode> ApplyOverride(const OverrideEntry& rule, WorldNode world);

// True if `pattern` is `text`, where * stands for any text and ? for any one character.
bool MatchesGlob(const std::string& pattern, const std::string& text);

}  // namespace troupe
