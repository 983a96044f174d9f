// The JSON Schema of scenarios (configs/scenario.schema.json, compiled in).
#pragma once

#include <memory>

#include "troupe/result.h"
#include "worldfile/scenario/json_document.h"

namespace troupe {

class ScenarioSchema {
 public:
  ScenarioSchema();
  ~ScenarioSchema();
  ScenarioSchema(ScenarioSchema&&) noexcept;
  ScenarioSchema& operator=(ScenarioSchema&&) noexcept;

  // The first breach of the schema in the order of the text: its place, the value found, and the values expected.
  Status Check(const JsonDocument& document) const;

 private:
  struct Compiled;
  std::unique_ptr<const Compiled> compiled_;
};

}  // namespace troupe
