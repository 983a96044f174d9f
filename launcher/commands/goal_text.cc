#include "launcher/commands/goal_text.h"

#include <fmt/format.h>

#include "launcher/commands/number_list.h"
#include "troupe/deterministic_math.h"

namespace troupe {

Result<Goal> ParseGoalText(const std::vector<std::string>& points) {
  Goal goal;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::optional<std::vector<double>> numbers = ParseNumberList(points[i]);
    const bool is_last = i + 1 == points.size();
    const bool has_heading = numbers && numbers->size() == 3;
    if (!numbers || (numbers->size() != 2 && !(has_heading && is_last))) {
      return Error{{},
                   fmt::format("found '{}', expected {} in metres{}", points[i],
                               is_last ? "X,Y or X,Y,HEADING" : "X,Y of a point before the last one",
                               is_last ? " and degrees" : ""),
                   ErrorCode::kBadInput};
    }
    goal.waypoints.emplace_back((*numbers)[0], (*numbers)[1]);
    if (has_heading) goal.heading = WrapAngle(DegreesToRadians((*numbers)[2]));
  }
  return goal;
}

}  // namespace troupe
