// RunBridge: the bridges of a run's domains: of its own, and of those of robots with their own. It follows the list of
// robots that the world service writes.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>

#include "ros/service_bridge/domain_bridge.h"
#include "ros/service_bridge/robot_list_reader.h"

namespace troupe::ros {

class RunBridge {
 public:
  // `options`: with the domain of the run. `inbox` must outlive this. `report`: receives problems, one line each.
  // Throws std::runtime_error if the participants in that domain cannot be made.
  RunBridge(const RosOptions& options, Inbox& inbox, std::function<void(const std::string&)> report);

  // As DomainBridge.
  void Process(const std::set<Inbox::PartId>& parts, PendingCalls::Time now);
  std::optional<PendingCalls::Time> NextDue() const;

 private:
  void Follow(const RobotList& list, PendingCalls::Time now);
  std::unique_ptr<DomainBridge> MakeBridge(std::uint32_t domain);

  const RosOptions options_;
  Inbox& inbox_;
  const std::function<void(const std::string&)> report_;
  const std::uint64_t client_guid_;
  std::int64_t last_call_ = 0;
  std::unique_ptr<DomainBridge> of_run_;
  std::map<std::uint32_t, std::unique_ptr<DomainBridge>> of_robots_;  // by their domain
  RobotListReader robots_;                                            // of the participants of of_run_
};

}  // namespace troupe::ros
