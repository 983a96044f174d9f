#include "fleet/topic.h"

#include <charconv>
#include <vector>

#include "troupe/enum_names.h"

namespace troupe::fleet {

int MajorOf(Version version) {
  return IsBefore3(version) ? 2 : 3;
}

std::string TopicName::ToString() const {
  const std::string prefix = interface_name.empty() ? "" : interface_name + "/";
  return prefix + "v" + std::to_string(major_version) + "/" + manufacturer + "/" + serial_number + "/" + NameOf(topic);
}

std::optional<TopicName> FindTopic(std::string_view text) {
  std::vector<std::string_view> levels;  // from the last one
  std::string_view rest = text;
  while (levels.size() < 4) {
    const std::size_t slash = rest.rfind('/');
    levels.push_back(slash == std::string_view::npos ? rest : rest.substr(slash + 1));
    rest = slash == std::string_view::npos ? std::string_view() : rest.substr(0, slash);
    if (slash == std::string_view::npos) break;
  }
  if (levels.size() < 4) return std::nullopt;
  const std::string_view version = levels[3];
  int major = 0;
  if (version.size() < 2 || version.front() != 'v') return std::nullopt;
  const auto read = std::from_chars(version.data() + 1, version.data() + version.size(), major);
  if (read.ec != std::errc() || read.ptr != version.data() + version.size() || major < 1) return std::nullopt;
  const std::optional<Topic> topic = FindByName<Topic>(levels[0]);
  if (!topic || levels[1].empty() || levels[2].empty()) return std::nullopt;
  return TopicName{std::string(rest), major, std::string(levels[2]), std::string(levels[1]), *topic};
}

}  // namespace troupe::fleet
