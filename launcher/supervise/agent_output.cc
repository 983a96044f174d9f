#include "launcher/supervise/agent_output.h"

#include "launcher/supervise/output_failure.h"

namespace troupe {

AgentOutput::AgentOutput(const std::string& option, const std::string& output)
    : option_(option), output_(output), parts_(output, option) {}

Status AgentOutput::AddParts(std::size_t count) {
  if (output_.empty()) return Status();
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

std::optional<Error> AgentOutput::FailureIn(const std::string& line, const Host& host) const {
  for (std::size_t part = 0; part < files_.size(); ++part) {
    std::optional<Error> failure = OutputFailure(line, PathOn(host, part), output_);
    if (failure && !host.name().empty()) failure->message = "on host " + host.name() + ": " + failure->message;
    if (failure) return failure;
  }
  return std::nullopt;
}

Status AgentOutput::Fetch(Host& host, std::size_t part) const {
  if (host.folder().empty()) return Status();
  const Status fetched = host.Fetch(PathOn(host, part), files_[part]);
  return fetched.ok() ? fetched : Error{{output_}, fetched.error().message, ErrorCode::kFailure};
}

}  // namespace troupe
