#include "common/run/run_settings.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

namespace troupe {
namespace {

template <typename Value, std::size_t kCount>
std::optional<Value> Parse(const std::array<std::string_view, kCount>& words, std::string_view word) {
  const auto found = std::find(words.begin(), words.end(), word);
  if (found == words.end()) return std::nullopt;
  return static_cast<Value>(found - words.begin());
}

template <typename T>
void Replace(T& setting, const std::optional<T>& value) {
  if (value) setting = *value;
}

}  // namespace

std::string ToString(Mode mode) {
  return std::string(kModeWords.at(static_cast<std::size_t>(mode)));
}

std::string ToString(OnAgentLoss policy) {
  return std::string(kOnAgentLossWords.at(static_cast<std::size_t>(policy)));
}

std::string ToString(const Speed& speed) {
  return speed ? fmt::format("{}", *speed) : "max";
}

std::optional<Mode> ParseMode(std::string_view word) {
  return Parse<Mode>(kModeWords, word);
}

std::optional<OnAgentLoss> ParseOnAgentLoss(std::string_view word) {
  return Parse<OnAgentLoss>(kOnAgentLossWords, word);
}

Result<Speed> ParseSpeed(std::string_view text) {
  if (text == "max") return Speed();
  double factor = 0.0;
  const auto [end, failure] = std::from_chars(text.data(), text.data() + text.size(), factor);
  const bool complete = failure == std::errc() && end == text.data() + text.size();
  if (complete && std::isfinite(factor) && factor > 0.0) return Speed(factor);
  return Error{{}, "found '" + std::string(text) + "', expected a multiple of real time above 0, or max"};
}

void RunOverrides::ApplyTo(RunSettings& settings) const {
  if (ticks) settings.ticks = ticks;
  Replace(settings.mode, mode);
  if (speed) settings.speed = settings.watched_speed = *speed;
  settings.is_watched = settings.is_watched || is_watched;
  Replace(settings.on_agent_loss, on_agent_loss);
  Replace(settings.robots_per_process, robots_per_process);
  Replace(settings.ros, ros);
}

}  // namespace troupe
