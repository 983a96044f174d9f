// EntityFilter: the filter of a request that lists entities.
#pragma once

#include <re2/re2.h>

#include <memory>
#include <string>
#include <vector>

#include "common/base/result.h"
#include "common/protocol/messages.h"
#include "common/ros_dds/simulation_types.h"

namespace troupe {

// As in simulation_interfaces/msg/EntityCategory.
std::uint8_t CategoryOf(EntityKind kind);

class EntityFilter {
 public:
  // Fails on a filter by tags or bounds, which are not supported, and on an expression that is not valid.
  static Result<EntityFilter> Make(const simulation_interfaces_msg_dds__EntityFilters_& filters);

  // A filter without categories matches robots and objects; static models match only by their category.
  bool Matches(const std::string& ros_name, EntityKind kind) const;

 private:
  // Null: every name. RE2, because any peer may send an expression and the time and memory of RE2 are bounded.
  std::unique_ptr<const re2::RE2> expression_;
  std::vector<std::uint8_t> categories_;
};

}  // namespace troupe
