// AgentOutput: one kind of output file (scans, traces), of which each agent writes a part.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "launcher/hosts/host.h"
#include "launcher/supervise/output_parts.h"
#include "troupe/result.h"

namespace troupe {

class AgentOutput {
 public:
  // `option`: its command-line option. `output`: the file that the parts are merged into; empty: the option is not set,
  // and there are no parts.
  AgentOutput(const std::string& option, const std::string& output);

  // Adds `count` parts if the option is set.
  Status AddParts(std::size_t count);

  bool empty() const { return files_.empty(); }
  // The parts on this host, in the order of AddParts.
  const std::vector<std::string>& files() const { return files_; }
  // The path that an agent on `host` writes its part to.
  std::string PathOn(const Host& host, std::size_t part) const;
  // The error about the user's file that a line reports which was printed on `host`; nothing for another line.
  std::optional<Error> FailureIn(const std::string& line, const Host& host) const;
  // Copies a part from the host into its file here; does nothing for this host.
  Status Fetch(Host& host, std::size_t part) const;

 private:
  const std::string option_;
  const std::string output_;
  OutputParts parts_;
  std::vector<std::string> files_;
};

}  // namespace troupe
