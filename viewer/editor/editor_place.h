// Private to this folder.
#pragma once

#include <memory>

#include "viewer/editor/editor.h"
#include "worldfile/stage/stage_tree.h"
#include "worldfile/text/json_tree.h"

namespace troupe {

struct Editor::Place {
  std::unique_ptr<StageTree> stage;      // of a Stage file
  const Statement* statement = nullptr;  // in there
  std::unique_ptr<JsonTree> json;        // of a scenario
  const JsonNode* holder = nullptr;      // in there: the list of the entry
  const JsonNode* entry = nullptr;
};

}  // namespace troupe
