// The JSON Schema of scenarios (configs/scenario.schema.json, compiled in).
#pragma once

#include "common/base/json_tree.h"
#include "troupe/result.h"

namespace troupe {

// As it was when the program was built.
extern const char* const kScenarioSchemaText;

// The first breach of the schema in the order of the text: its place, the value found, and the values expected. Any
// thread may call it.
Status CheckSchema(const JsonTree& tree);

}  // namespace troupe
