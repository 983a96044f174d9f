#include "ros/service_bridge/run_bridge.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "common/base/random_id.h"
#include "ros/messages/bridge_call.h"

namespace troupe::ros {

RunBridge::RunBridge(const RosOptions& options, Inbox& inbox, std::function<void(const std::string&)> report)
    : options_(options),
      inbox_(inbox),
      report_(std::move(report)),
      client_guid_(kBridgeMark | (MakeRandomId() & 0xffffffffU)),
      of_run_(MakeBridge(options.domain)),
      robots_(of_run_->run(), options.distribution, inbox) {}

std::unique_ptr<DomainBridge> RunBridge::MakeBridge(std::uint32_t domain) {
  RosOptions options = options_;
  options.domain = domain;
  return std::make_unique<DomainBridge>(options, inbox_, client_guid_, last_call_, report_);
}

void RunBridge::Process(const std::set<Inbox::PartId>& parts, PendingCalls::Time now) {
  if (parts.contains(robots_.part())) {
    if (const std::optional<RobotList> list = robots_.Take()) Follow(*list, now);
  }
  of_run_->Process(parts, now);
  for (const auto& [domain, bridge] : of_robots_) bridge->Process(parts, now);
}

void RunBridge::Follow(const RobotList& list, PendingCalls::Time now) {
  of_run_->SetRobots(list, now);
  std::erase_if(of_robots_, [&list](const auto& entry) { return !list.domains.contains(entry.first); });
  for (const std::uint32_t domain : list.domains) {
    if (domain == options_.domain || of_robots_.contains(domain)) continue;
    try {
      std::unique_ptr<DomainBridge> bridge = MakeBridge(domain);
      bridge->SetRobots({{"/"}, {}}, now);
      of_robots_.emplace(domain, std::move(bridge));
    } catch (const std::runtime_error& error) {
      report_(error.what());
    }
  }
}

std::optional<PendingCalls::Time> RunBridge::NextDue() const {
  std::optional<PendingCalls::Time> next = of_run_->NextDue();
  for (const auto& [domain, bridge] : of_robots_) {
    if (const auto due = bridge->NextDue()) next = std::min(next.value_or(*due), *due);
  }
  return next;
}

}  // namespace troupe::ros
