#include "world-service/ros/entity_filter.h"

#include <algorithm>

#include "common/dds/wire.h"

namespace troupe {

std::uint8_t CategoryOf(EntityKind kind) {
  switch (kind) {
    case EntityKind::kRobot:
      return 1;
    case EntityKind::kObject:
      return 4;  // moves
    case EntityKind::kModel:
      return 5;  // does not
  }
  return 0;
}

Result<EntityFilter> EntityFilter::Make(const simulation_interfaces_msg_dds__EntityFilters_& filters) {
  if (filters.tags.tags._length > 0) return Error{{}, "found tags in the filter; entities have none"};
  if (filters.bounds.type != 0) return Error{{}, "found bounds in the filter, which are not supported"};
  EntityFilter filter;
  for (const auto& category : dds::Elements(filters.categories)) filter.categories_.push_back(category.category);
  const std::string text = dds::Text(filters.filter);
  if (text.empty()) return filter;
  auto expression = std::make_unique<regex_t>();
  if (const int code = regcomp(expression.get(), text.c_str(), REG_EXTENDED | REG_NOSUB); code != 0) {
    char why[100] = "";
    regerror(code, expression.get(), why, sizeof why);
    return Error{{}, "found the filter '" + text + "', expected a regular expression: " + why};
  }
  filter.expression_.reset(expression.release());
  return filter;
}

bool EntityFilter::Matches(const std::string& ros_name, EntityKind kind) const {
  if (categories_.empty() && kind == EntityKind::kModel) return false;
  const auto asked = std::find(categories_.begin(), categories_.end(), CategoryOf(kind));
  if (!categories_.empty() && asked == categories_.end()) return false;
  return expression_ == nullptr || regexec(expression_.get(), ros_name.c_str(), 0, nullptr, 0) == 0;
}

}  // namespace troupe
