#include "common/run/run_settings.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>

namespace troupe {
namespace {

template <typename T>
void Replace(T& setting, const std::optional<T>& value) {
  if (value) setting = *value;
}

}  // namespace

std::string ToString(const Speed& speed) {
  return speed ? fmt::format("{}", *speed) : "max";
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
