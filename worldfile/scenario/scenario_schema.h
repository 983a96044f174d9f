// The JSON Schema of scenarios (configs/scenario.schema.json, compiled in).
#pragma once

#include <memory>

#include "troupe/result.h"
#include "worldfile/text/json_tree.h"

namespace troupe {

// As it was when the program was built.
extern const char* const kScenarioSchemaText;

class ScenarioSchema {
 public:
  ScenarioSchema();
  ~ScenarioSchema();
  ScenarioSchema(ScenarioSchema&&) noexcept;
  ScenarioSchema& operator=(ScenarioSchema&&) noexcept;

  // The first breach of the schema in the order of the text: its place, the value found, and the values expected.
  Status Check(const JsonTree& tree) const;

 private:
  struct Compiled;
  std::unique_ptr<const Compiled> compiled_;
};

}  // namespace troupe
