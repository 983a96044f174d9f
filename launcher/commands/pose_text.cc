#include "launcher/commands/pose_text.h"

#include <charconv>
#include <cmath>
#include <vector>

#include "common/base/deterministic_math.h"

namespace troupe {

Result<PoseText> ParsePoseText(const std::string& text) {
  const Error failure{{}, "found '" + text + "', expected X,Y,HEADING or X,Y,Z,HEADING, in metres and degrees"};
  std::vector<double> numbers;
  const char* position = text.data();
  const char* const end = text.data() + text.size();
  for (;;) {
    double number = 0.0;
    const auto [next, fault] = std::from_chars(position, end, number);
    if (fault != std::errc() || !std::isfinite(number)) return failure;
    numbers.push_back(number);
    if (next == end) break;
    if (*next != ',') return failure;
    position = next + 1;
  }
  if (numbers.size() != 3 && numbers.size() != 4) return failure;
  const bool has_height = numbers.size() == 4;
  return PoseText{{numbers[0], numbers[1], has_height ? numbers[2] : 0.0, DegreesToRadians(numbers.back())},
                  has_height};
}

}  // namespace troupe
