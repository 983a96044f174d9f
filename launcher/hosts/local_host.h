// LocalHost: starts processes as children of this one.
#pragma once

#include "launcher/hosts/host.h"
#include "launcher/process/line_pipe.h"

namespace troupe {

class LocalHost : public Host {
 public:
  // `agents`: the address layout of agents.
  explicit LocalHost(Addresses agents = Addresses::kRandom) : agent_addresses_(agents) {}

  const std::string& name() const override { return none_; }
  const std::string& folder() const override { return none_; }
  std::string ProgramPath(const std::string& program) const override;
  Result<std::unique_ptr<Child>> Start(const std::string& program, const std::vector<std::string>& arguments,
                                       bool reports) override;
  Result<std::string> PlaceKeys(const std::string& keys, const std::string&) override { return keys; }
  std::vector<int> descriptors() const override;
  std::vector<std::string> ReadOutput() override { return output_.Read(); }
  std::vector<std::string> ReadReports() override { return reports_.Read(); }
  Status Fetch(const std::string& from, const std::string& to) override;

 private:
  const Addresses agent_addresses_;
  const std::string none_;
  LinePipe output_;
  LinePipe reports_;
};

}  // namespace troupe
