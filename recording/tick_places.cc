#include "recording/tick_places.h"

#include <algorithm>

namespace troupe {

TickPlaces::TickPlaces(std::int64_t interval_ns, std::uint64_t end) : end_(end) {
  AddEdit(0, 0, interval_ns);
}

void TickPlaces::AddEdit(std::uint64_t log_time, Tick tick, std::int64_t interval_ns) {
  parts_.push_back({log_time, tick, static_cast<std::uint64_t>(std::max<std::int64_t>(1, interval_ns))});
}

std::uint64_t TickPlaces::EndOf(std::size_t part) const {
  const std::uint64_t end = part + 1 < parts_.size() ? parts_[part + 1].begin : end_;
  return std::max(end, parts_[part].begin);
}

Tick TickPlaces::LastTickOf(std::size_t part) const {
  return parts_[part].tick + (EndOf(part) - parts_[part].begin) / parts_[part].interval_ns;
}

std::optional<std::uint64_t> TickPlaces::Find(std::size_t part, Tick tick) const {
  if (tick < parts_[part].tick || tick > LastTickOf(part)) return std::nullopt;
  return parts_[part].begin + (tick - parts_[part].tick) * parts_[part].interval_ns;
}

std::optional<std::uint64_t> TickPlaces::First(Tick tick) const {
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    if (const auto found = Find(i, tick)) return found;
  }
  return std::nullopt;
}

std::optional<std::uint64_t> TickPlaces::Last(Tick tick) const {
  for (std::size_t i = parts_.size(); i-- > 0;) {
    if (const auto found = Find(i, tick)) return found;
  }
  return std::nullopt;
}

Tick TickPlaces::greatest() const {
  Tick greatest = 0;
  for (std::size_t i = 0; i < parts_.size(); ++i) greatest = std::max(greatest, LastTickOf(i));
  return greatest;
}

}  // namespace troupe
