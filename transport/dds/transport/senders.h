// Senders: the writers that a reader has received samples from, each with the participant that it belongs to. DDS hands
// a participant the samples of every writer of a topic; this tells which of them is which, and keeps out those that
// were found not to be entitled to the topic.
#pragma once

#include <atomic>
#include <map>
#include <mutex>
#include <set>
#include <string>
#include <vector>

#include "transport/dds/binding/guid_prefix.h"
#include "transport/dds/binding/topic.h"
#include "transport/dds/transport/run_proof.h"

namespace troupe::dds {

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

}  // namespace troupe::dds
