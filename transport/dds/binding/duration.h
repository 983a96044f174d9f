// Durations of DDS, from seconds.
#pragma once

#include <dds/dds.h>

#include <limits>

namespace troupe::dds {

inline constexpr double kInfinite = std::numeric_limits<double>::infinity();  // s

// Negative durations become zero, durations beyond the range of DDS infinite.
inline dds_duration_t ToDuration(double seconds) {
  if (!(seconds < 9.0e9)) return DDS_INFINITY;
  return seconds > 0.0 ? static_cast<dds_duration_t>(seconds * 1e9) : 0;
}

inline double ToSeconds(dds_duration_t duration) {
  return duration == DDS_INFINITY ? kInfinite : static_cast<double>(duration) * 1e-9;
}

}  // namespace troupe::dds
