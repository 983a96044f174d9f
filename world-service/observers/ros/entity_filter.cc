#include "world-service/observers/ros/entity_filter.h"

#include <algorithm>
#include <utility>

#include "transport/dds/binding/wire.h"

namespace troupe {

std::uint8_t CategoryOf(EntityKind kind) {
  switch (kind) {
    case EntityKind::kRobot:
      return 1;
    case EntityKind::kObject:
      return 4;  // dynamic object
    case EntityKind::kModel:
      return 5;  // static object
  }
  return 0;
}

Result<EntityFilter> EntityFilter::Make(const simulation_interfaces_msg_dds__EntityFilters_& filters) {
  EntityFilter filter;
  filter.tags_ = TagsFilter(filters.tags);
  if (filters.bounds.type != 0) {
    Result<BoundsFilter> bounds = BoundsFilter::Make(filters.bounds);
    if (!bounds.ok()) return bounds.error();
    filter.bounds_ = std::move(bounds).value();
  }
  for (const auto& category : dds::Elements(filters.categories)) filter.categories_.push_back(category.category);
  const std::string text = dds::Text(filters.filter);
  if (text.empty()) return filter;
  re2::RE2::Options options;
  options.set_log_errors(false);
  auto expression = std::make_unique<const re2::RE2>(text, options);
  if (!expression->ok()) {
    return Error{{}, "found the filter '" + text + "', expected a regular expression: " + expression->error()};
  }
  filter.expression_ = std::move(expression);
  return filter;
}

bool EntityFilter::Matches(const std::string& ros_name, const EntityReport& entity, std::uint8_t category,
                           const std::vector<std::string>& tags) const {
  if (categories_.empty() && entity.kind == EntityKind::kModel) return false;
  const auto listed = std::find(categories_.begin(), categories_.end(), category);
  if (!categories_.empty() && listed == categories_.end()) return false;
  if (!tags_.Matches(tags) || (bounds_ && !bounds_->Overlaps(entity))) return false;
  return expression_ == nullptr || re2::RE2::PartialMatch(ros_name, *expression_);
}

}  // namespace troupe
