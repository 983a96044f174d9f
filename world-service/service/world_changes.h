// WorldChanges: another seed and other controllers for a run that continues from a recording.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include "troupe/result.h"
#include "troupe/world_description.h"

namespace troupe {

struct WorldChanges {
  std::optional<std::uint64_t> seed = {};
  std::map<std::string, ControllerDescription> controllers = {};  // by robot

  bool any() const { return seed.has_value() || !controllers.empty(); }
  // The world with the changes of the robots that it has.
  WorldDescription AppliedTo(WorldDescription world) const;

  // As the source of a ControlRequest: a JSON object.
  std::string ToText() const;
  static Result<WorldChanges> FromText(const std::string& text);
};

}  // namespace troupe
