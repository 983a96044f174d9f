// EditTarget: the file that keeps the edits of a world.
//
// Stage worlds, files of models and scenarios are edited themselves. Other tools write the other formats of worlds
// (Gazebo, Open-RMF, LIF, maps), and such a file stays as it is: a scenario beside it, of its name, has it as its
// "world" and changes it.
#pragma once

#include <string>

#include "troupe/result.h"
#include "viewer/editor/editable_world.h"

namespace troupe {

struct EditTarget {
  std::string path;
  EditedKind kind = EditedKind::kScenario;
  std::string initial;  // the text, if the file does not exist
};

// `path`: as the user names it. Errors: a file of no world, and a scenario beside it that has another world.
Result<EditTarget> TargetOf(const std::string& path);

}  // namespace troupe
