// KnownServices: which participant is the world service of a run: the first one that sends a message of that run.
// Messages of the run from any other participant are not the service's.
#pragma once

#include <map>
#include <optional>
#include <vector>

#include "common/dds/binding/guid_prefix.h"
#include "common/dds/transport/senders.h"
#include "common/protocol/messages.h"

namespace troupe::dds {

class KnownServices {
 public:
  // With an argument, this participant alone is the service of any run.
  explicit KnownServices(std::optional<GuidPrefix> only = std::nullopt) : only_(only) {}

  // `participant` has sent a message of a run that only the run's service sends. False: it is not the service.
  bool IsService(RunId run, const GuidPrefix& participant) {
    if (only_ && *only_ != participant) return false;
    return services_.try_emplace(run, participant).first->second == participant;
  }

  // The same for a message in `inbox`, which refuses all others of a sender that is not the service.
  template <typename Inbox>
  bool Admits(Inbox& inbox, RunId run, const Sender& sender) {
    if (IsService(run, sender.participant)) return true;
    inbox.Refuse(sender, "it is not the world service of the run");
    return false;
  }

  bool empty() const { return services_.empty(); }

  // The participant has ended as a service: forgets its runs, and returns them.
  std::vector<RunId> Forget(const GuidPrefix& participant) {
    std::vector<RunId> runs;
    std::erase_if(services_, [&](const auto& service) {
      if (service.second != participant) return false;
      runs.push_back(service.first);
      return true;
    });
    return runs;
  }

 private:
  std::optional<GuidPrefix> only_;
  std::map<RunId, GuidPrefix> services_;
};

}  // namespace troupe::dds
