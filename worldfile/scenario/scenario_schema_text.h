// configs/scenario.schema.json as it was when the program was built.
#pragma once

namespace troupe {

extern const char* const kScenarioSchemaText;

}  // namespace troupe
