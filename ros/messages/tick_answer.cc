#include "ros/messages/tick_answer.h"

namespace troupe::ros {
namespace {

constexpr std::string_view kEdition = "edition:";
constexpr std::string_view kWaits = "waits";

}  // namespace

TickAnswer ParseTickAnswer(std::string_view text) {
  TickAnswer answer{.name = std::string(text.substr(0, text.find(' ')))};
  for (std::string_view rest = text.substr(answer.name.size()); !rest.empty();) {
    const std::string_view entry = rest.substr(1, rest.find(' ', 1) - 1);
    rest.remove_prefix(1 + entry.size());
    const bool is_edition = entry.starts_with(kEdition) && answer.edition.empty();
    const bool is_wait = entry == kWaits && !answer.waits;
    if (!is_edition && !is_wait) return {.name = std::string(text)};
    if (is_edition) answer.edition = entry;
    answer.waits = answer.waits || is_wait;
  }
  return answer;
}

}  // namespace troupe::ros
