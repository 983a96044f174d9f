#include "launcher/commands/pose_text.h"

#include "launcher/commands/number_list.h"
#include "troupe/deterministic_math.h"

namespace troupe {

Result<PoseText> ParsePoseText(const std::string& text) {
  const Error failure{{}, "found '" + text + "', expected X,Y,HEADING or X,Y,Z,HEADING, in metres and degrees"};
  const std::optional<std::vector<double>> list = ParseNumberList(text);
  if (!list) return failure;
  const std::vector<double>& numbers = *list;
  if (numbers.size() != 3 && numbers.size() != 4) return failure;
  const bool has_height = numbers.size() == 4;
  return PoseText{{numbers[0], numbers[1], has_height ? numbers[2] : 0.0, DegreesToRadians(numbers.back())},
                  has_height};
}

}  // namespace troupe
