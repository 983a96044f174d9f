// Private to this folder.
#pragma once

#include <memory>

#include "viewer/editor/editor.h"
#include "worldfile/edit/json_syntax.h"
#include "worldfile/edit/stage_syntax.h"

namespace troupe {

struct Editor::Place {
  std::unique_ptr<StageSyntax> stage;    // of a Stage file
  const Statement* statement = nullptr;  // in there
  JsonItem json;                         // of a scenario
  const JsonItem* holder = nullptr;      // in there: the list of the entry
  const JsonItem* entry = nullptr;
};

}  // namespace troupe
