// EntityFilter: the filter of a request that lists entities.
#pragma once

#include <re2/re2.h>

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "ros/connection/simulation_types.h"
#include "transport/protocol/messages.h"
#include "troupe/result.h"
#include "world-service/observers/ros/bounds_filter.h"
#include "world-service/observers/ros/tags_filter.h"

namespace troupe {

// As in simulation_interfaces/msg/EntityCategory.
std::uint8_t CategoryOf(EntityKind kind);

class EntityFilter {
 public:
  // Fails on bounds that are not valid, and on an expression that is not.
  static Result<EntityFilter> Make(const simulation_interfaces_msg_dds__EntityFilters_& filters);

  // Whether Matches needs the boxes of the entities.
  bool has_bounds() const { return bounds_.has_value(); }

  // A filter without categories matches robots and objects; static models match only by their category. `category` and
  // `tags`: of the entity's info.
  bool Matches(const std::string& ros_name, const EntityReport& entity, std::uint8_t category,
               const std::vector<std::string>& tags) const;

 private:
  // Null: every name. RE2, because any peer may send an expression and the time and memory of RE2 are bounded.
  std::unique_ptr<const re2::RE2> expression_;
  std::vector<std::uint8_t> categories_;
  TagsFilter tags_;
  std::optional<BoundsFilter> bounds_;
};

}  // namespace troupe
