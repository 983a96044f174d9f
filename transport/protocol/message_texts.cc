#include "transport/protocol/message_texts.h"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

#include "common/base/hash.h"

namespace troupe {
namespace {

constexpr std::size_t kNamesShown = 4;

}  // namespace

std::string AgentName(const std::vector<std::string>& robots) {
  std::vector<std::string> sorted = robots;
  std::sort(sorted.begin(), sorted.end());
  Hasher hash;
  for (const std::string& robot : sorted) hash.Add(std::string_view(robot));
  return fmt::format("{:016x}", hash.value());
}

std::string WaitingText(const StatusMessage& status) {
  const std::vector<std::string>& names = status.waiting_for;
  if (names.empty()) return "";
  std::string text;
  for (std::size_t i = 0; i < names.size() && i < kNamesShown; ++i) text += (i == 0 ? "" : ", ") + names[i];
  if (names.size() > kNamesShown) text += fmt::format(" and {} more", names.size() - kNamesShown);
  return text + fmt::format(" ({:.1f} s)", status.waiting_seconds);
}

}  // namespace troupe
