// TagsFilter: the filter of a request by tags.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "ros/connection/simulation_types.h"
#include "transport/dds/binding/wire.h"

namespace troupe {

class TagsFilter {
 public:
  TagsFilter() = default;
  explicit TagsFilter(const simulation_interfaces_msg_dds__TagsFilter_& filter)
      : tags_(dds::Strings(filter.tags)), needs_all_(filter.filter_mode == 1) {}

  // A filter without tags matches everything.
  bool Matches(const std::vector<std::string>& tags) const {
    const auto has = [&](const std::string& tag) { return std::find(tags.begin(), tags.end(), tag) != tags.end(); };
    if (tags_.empty()) return true;
    return needs_all_ ? std::all_of(tags_.begin(), tags_.end(), has) : std::any_of(tags_.begin(), tags_.end(), has);
  }

 private:
  std::vector<std::string> tags_;
  bool needs_all_ = false;
};

}  // namespace troupe
