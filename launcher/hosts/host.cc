#include "launcher/hosts/host.h"

#include <utility>

namespace troupe {
namespace {

class LocalChild : public Child {
 public:
  explicit LocalChild(Process process) : process_(std::move(process)) {}
  pid_t pid() const override { return process_.pid(); }
  const std::optional<ProcessEnd>& end() const override { return process_.end(); }
  bool Poll() override { return process_.Poll(); }
  void Signal(int signal) override { process_.Signal(signal); }
  void Kill() override { process_.Kill(); }

 private:
  Process process_;
};

}  // namespace

std::string LocalHost::ProgramPath(const std::string& program) const {
  Result<std::string> path = FindProgram(program);
  return path.ok() ? path.value() : program;
}

Result<std::unique_ptr<Child>> LocalHost::Start(const std::string& program, const std::vector<std::string>& arguments,
                                                bool reports) {
  Result<std::string> path = FindProgram(program);
  if (!path.ok()) return path.error();
  std::vector<std::string> command = {path.value()};
  command.insert(command.end(), arguments.begin(), arguments.end());
  if (reports) command.push_back("--report-fd=" + std::to_string(reports_.writing_end()));
  const Addresses addresses = program == "robot-agent" ? agent_addresses_ : Addresses::kRandom;
  Result<Process> process =
      Process::Start(command, output_.writing_end(), reports ? reports_.writing_end() : -1, addresses);
  if (!process.ok()) return process.error();
  return std::unique_ptr<Child>(std::make_unique<LocalChild>(std::move(process).value()));
}

std::vector<int> LocalHost::descriptors() const {
  return {output_.reading_end(), reports_.reading_end()};
}

Status LocalHost::Fetch(const std::string& from, const std::string&, const FetchProgress&) {
  return Failure(from + " is on this host already");
}

}  // namespace troupe
