#include "launcher/hosts/place_robots.h"

#include <algorithm>

#include "worldfile/scenario/scenario_override.h"

namespace troupe {
namespace {

constexpr std::size_t kNowhere = static_cast<std::size_t>(-1);

}  // namespace

Result<std::vector<std::size_t>> PlaceRobots(const std::vector<std::string>& robots,
                                             const std::vector<HostSettings>& hosts) {
  std::vector<std::size_t> places(robots.size(), kNowhere);
  for (std::size_t host = 0; host < hosts.size(); ++host) {
    for (const std::string& pattern : hosts[host].robot_names) {
      bool found = false;
      for (std::size_t robot = 0; robot < robots.size(); ++robot) {
        if (!MatchesGlob(pattern, robots[robot])) continue;
        found = true;
        if (places[robot] == kNowhere) places[robot] = host;
      }
      if (!found) {
        return Error{hosts[host].where,
                     "host " + hosts[host].name + ": found no robot named '" + pattern + "', expected one"};
      }
    }
  }
  std::size_t next = 0;  // no robot before it is without a host
  const auto place = [&](std::size_t host, std::size_t count) {
    for (; next < robots.size() && count > 0; ++next) {
      if (places[next] != kNowhere) continue;
      places[next] = host;
      --count;
    }
  };
  std::size_t sharing = 0;
  for (std::size_t host = 0; host < hosts.size(); ++host) {
    place(host, hosts[host].robot_count.value_or(0));
    if (hosts[host].robot_names.empty() && !hosts[host].robot_count) ++sharing;
  }
  auto left = static_cast<std::size_t>(std::count(places.begin(), places.end(), kNowhere));
  if (left > 0 && sharing == 0) {
    return Error{hosts.front().where, "found hosts for " + std::to_string(robots.size() - left) + " of " +
                                          std::to_string(robots.size()) + " robots, expected a host for each"};
  }
  for (std::size_t host = 0; host < hosts.size(); ++host) {
    if (!hosts[host].robot_names.empty() || hosts[host].robot_count) continue;
    const std::size_t share = (left + sharing - 1) / sharing;
    place(host, share);
    left -= share;
    --sharing;
  }
  return places;
}

}  // namespace troupe
