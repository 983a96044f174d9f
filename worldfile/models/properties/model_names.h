// ModelNames: the full names of a world's models, and where each was given.
#pragma once

#include <map>
#include <string>

#include "worldfile/stage/world_tree.h"
#include "worldfile/text/diagnostics.h"

namespace troupe {

class ModelNames {
 public:
  // Adds the full name `name` of a model that `node` makes. A name that is empty, too long or not new is an error.
  void Add(const WorldNode& node, const std::string& name, Diagnostics& diagnostics);

 private:
  std::map<std::string, SourceLocation> places_;
};

}  // namespace troupe
