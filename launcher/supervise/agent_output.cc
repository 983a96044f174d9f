#include "launcher/supervise/agent_output.h"

namespace troupe {

AgentOutput::AgentOutput(const std::string& option, const std::string& output)
    : option_(option), enabled_(!output.empty()), parts_(output, option) {}

Status AgentOutput::AddParts(std::size_t count) {
  if (!enabled_) return Status();
  for (std::size_t i = 0; i < count; ++i) {
    Result<std::string> file = parts_.Add();
    if (!file.ok()) return file.error();
    files_.push_back(std::move(file).value());
  }
  return Status();
}

std::string AgentOutput::PathOn(const Host& host, std::size_t part) const {
  if (host.folder().empty()) return files_[part];
  return host.folder() + "/agent" + option_ + "-" + std::to_string(part);
}

Status AgentOutput::Fetch(Host& host, std::size_t part) const {
  return host.folder().empty() ? Status() : host.Fetch(PathOn(host, part), files_[part]);
}

}  // namespace troupe
