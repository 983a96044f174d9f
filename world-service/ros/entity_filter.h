// The filter of requests for entities.
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
  // The error says what the filter has that is not supported, or what is wrong with its expression.
  static Result<EntityFilter> Make(const simulation_interfaces_msg_dds__EntityFilters_& filters);

  // Without categories, what stands still is not asked for.
  bool Matches(const std::string& ros_name, EntityKind kind) const;

 private:
  // RE2, because anybody may send one: time and memory of others can grow without bound. Null: every name.
  std::unique_ptr<const re2::RE2> expression_;
  std::vector<std::uint8_t> categories_;
};

}  // namespace troupe
