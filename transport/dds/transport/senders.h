// Senders: the writers that a reader has received samples from, each with the participant that it belongs to. DDS hands
// a participant the samples of every writer of a topic; this tells the writers apart, and keeps out writers that are
// not entitled to the topic.
//
// Three questions about a sample, in this order. Is its sender of the run? RunProof compares a proof in the
// announcement, made of the run's token and the sender's GUID, before any sample is read. Is its sender entitled to
// this topic? Senders refuses a writer once and for all, and Cyclone's filter drops its samples from then on. Is its
// sender the service? ServiceRegistry, for topics that only the service writes.
//
// The identity of a participant comes from DDS, never from the content of a message.
#pragma once

#include <atomic>
#include <cstdint>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "transport/dds/binding/domain_participant.h"
#include "transport/dds/binding/entity.h"
#include "transport/dds/binding/qos.h"
#include "transport/protocol/messages.h"
#include "transport/security/run_token.h"

namespace troupe::dds {

// The proof that a writer is of a process of the run, or of one of its owner's tools: in the user data of the writer's
// announcement, so that a reader can ask for it before it reads a sample. docs/security.md says which runs have tokens.

enum class ProofCheck : std::uint8_t {
  kAccepted,      // or none is asked for
  kNoProof,       // the run has a token, and the writer's participant does not
  kUnknownProof,  // of another token, or this participant has none
};

class RunProof {
 public:
  // The proof of a participant with this identity. Without a token it proves nothing, and asks for no proof.
  RunProof(const std::optional<RunToken>& token, const GuidPrefix& participant);

  // `qos` of a writer, with the proof, and with the address of the memory that it shares (transport/shared_memory) if
  // that is not empty.
  Qos Announced(Qos qos, const std::string& sharing = {}) const;

  // The address of shared memory in the announcement of a writer; empty: none.
  static std::string SharingOf(const std::string& user_data);

  // Senders without a proof are not accepted.
  bool asks() const { return token_.has_value(); }
  ProofCheck Check(const GuidPrefix& participant, const std::string& user_data) const;

 private:
  std::optional<RunToken> token_;
  std::string proof_;
};

struct Sender {
  dds_instance_handle_t writer = 0;
  GuidPrefix participant;
  std::string partition;  // the first of the writer's
  ProofCheck proof = ProofCheck::kAccepted;
  std::string sharing = {};  // the address of the memory that its participant shares; empty: none
};

class Senders : public SampleFilter {
 public:
  // Their proofs are checked by `proof`, which must outlive it.
  explicit Senders(const RunProof& proof) : proof_(proof) {}

  // The writer with this handle, which `reader` is or was matched with; null if it has ended. Valid until ForgetEnded.
  const Sender* Find(dds_entity_t reader, dds_instance_handle_t writer);

  // No sample of this writer is accepted any more. False if that was so before.
  bool Refuse(const Sender& sender);

  // Forgets the senders whose writers have ended, and returns them.
  std::vector<Sender> ForgetEnded(dds_entity_t reader);

  bool Accepts(dds_instance_handle_t writer) const override;

 private:
  const RunProof& proof_;
  std::map<dds_instance_handle_t, Sender> known_;
  std::atomic<bool> any_refused_ = false;
  mutable std::mutex mutex_;  // guards the member below, which Cyclone's threads read
  std::set<dds_instance_handle_t> refused_;
};

// ServiceRegistry: which participant is the world service of a run: the first one that sends a message of that run, and
// after it the one that continues the run, with a higher incarnation. Messages of the run from any other participant
// are not the service's.
class ServiceRegistry {
 public:
  enum class Verdict : std::uint8_t {
    kService,
    kNotYet,  // it may continue the run, once the service before it has ended
    kNotService,
  };

  // `only`: this participant alone is the first service of any run; if it has ended before it was discovered, one that
  // continues a run is. `proven`: the senders have proven to belong to the run, so that one of them may continue it at
  // once.
  explicit ServiceRegistry(bool proven, std::optional<GuidPrefix> only = std::nullopt) : proven_(proven), only_(only) {}

  // Whether the participant may be a service.
  bool MayBeService(const GuidPrefix& participant) const {
    return !only_ || *only_ == participant || proven_ || !only_is_discovered_;
  }

  // A writer of the participant was discovered.
  void Discover(const GuidPrefix& participant) {
    if (only_ == participant) only_is_discovered_ = true;
  }

  // `participant` has sent a message of a run that only the run's service sends.
  Verdict Judge(RunId run, Incarnation incarnation, const GuidPrefix& participant) {
    const auto known = services_.find(run);
    if (known != services_.end() && known->second.participant == participant) return Verdict::kService;
    const bool is_free = known == services_.end() && MayBeFirst(participant, incarnation);
    const bool is_later = known != services_.end() ? incarnation > known->second.incarnation : incarnation > 0;
    if (!is_free && !is_later) return Verdict::kNotService;
    if (!is_free && !proven_) return Verdict::kNotYet;
    services_[run] = {participant, incarnation};
    return Verdict::kService;
  }

  // Of a message in `inbox`, which refuses all others of a sender that is not the service.
  template <typename Inbox>
  Verdict JudgeAndRefuse(Inbox& inbox, RunId run, Incarnation incarnation, const Sender& sender) {
    const Verdict verdict = Judge(run, incarnation, sender.participant);
    if (verdict == Verdict::kNotService) inbox.Refuse(sender, "it is not the world service of the run");
    return verdict;
  }
  // True for a message of the service.
  template <typename Inbox>
  bool Admits(Inbox& inbox, RunId run, Incarnation incarnation, const Sender& sender) {
    return JudgeAndRefuse(inbox, run, incarnation, sender) == Verdict::kService;
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

  bool MayBeFirst(const GuidPrefix& participant, Incarnation incarnation) const {
    return !only_ || *only_ == participant || (incarnation > 0 && !only_is_discovered_);
  }

  const bool proven_;
  std::optional<GuidPrefix> only_;
  bool only_is_discovered_ = false;
  std::map<RunId, Service> services_;
};

}  // namespace troupe::dds
