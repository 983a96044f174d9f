// KnownServices: which participant is the world service of a run: the first one that sends a message of that run, and
// after it the one that continues the run, with a higher incarnation. Messages of the run from any other participant
// are not the service's.
#pragma once

#include <map>
#include <optional>
#include <vector>

#include "transport/dds/binding/guid_prefix.h"
#include "transport/dds/transport/senders.h"
#include "transport/protocol/messages.h"

namespace troupe::dds {

class KnownServices {
 public:
  enum class Verdict : std::uint8_t {
    kService,
    kNotYet,  // it may continue the run, once the service before it has ended
    kNotService,
  };

  // `only`: this participant alone is the first service of any run. `proven`: the senders have proven to belong to the
  // run, so that one of them may continue it at once.
  explicit KnownServices(bool proven, std::optional<GuidPrefix> only = std::nullopt) : proven_(proven), only_(only) {}

  // Whether messages of the participant may be those of a service.
  bool MayBeService(const GuidPrefix& participant) const { return !only_ || *only_ == participant || proven_; }

  // `participant` has sent a message of a run that only the run's service sends.
  Verdict Judge(RunId run, Incarnation incarnation, const GuidPrefix& participant) {
    const auto known = services_.find(run);
    if (known != services_.end() && known->second.participant == participant) return Verdict::kService;
    const bool is_free = known == services_.end() && (!only_ || *only_ == participant);
    const bool is_later = known != services_.end() ? incarnation > known->second.incarnation : incarnation > 0;
    if (!is_free && !is_later) return Verdict::kNotService;
    if (!is_free && !proven_) return Verdict::kNotYet;
    services_[run] = {participant, incarnation};
    return Verdict::kService;
  }

  // True for a message of the service in `inbox`, which refuses all others of a sender that is not the service.
  template <typename Inbox>
  bool Admits(Inbox& inbox, RunId run, Incarnation incarnation, const Sender& sender) {
    const Verdict verdict = Judge(run, incarnation, sender.participant);
    if (verdict == Verdict::kNotService) inbox.Refuse(sender, "it is not the world service of the run");
    return verdict == Verdict::kService;
  }

  bool empty() const { return services_.empty(); }

  // The participant has ended as a service: forgets its runs, and returns them.
  std::vector<RunId> Forget(const GuidPrefix& participant) {
    if (only_ == participant) only_.reset();  // another one may continue its run
    std::vector<RunId> runs;
    std::erase_if(services_, [&](const auto& service) {
      if (service.second.participant != participant) return false;
      runs.push_back(service.first);
      return true;
    });
    return runs;
  }

 private:
  struct Service {
    GuidPrefix participant;
    Incarnation incarnation = 0;
  };

  const bool proven_;
  std::optional<GuidPrefix> only_;
  std::map<RunId, Service> services_;
};

}  // namespace troupe::dds
