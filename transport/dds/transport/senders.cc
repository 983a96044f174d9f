#include "transport/dds/transport/senders.h"

#include <algorithm>
#include <utility>

#include "transport/dds/binding/builtin_topic.h"

namespace troupe::dds {

const Sender* Senders::Find(dds_entity_t reader, dds_instance_handle_t writer) {
  if (const auto known = known_.find(writer); known != known_.end()) return &known->second;
  const std::optional<PublicationData> publication = MatchedPublicationData(reader, writer);
  if (!publication) return nullptr;
  const std::string partition = publication->partitions.empty() ? "" : publication->partitions.front();
  const ProofCheck proof = proof_.Check(publication->participant, publication->user_data);
  Sender sender{writer, publication->participant, partition, proof, RunProof::SharingOf(publication->user_data)};
  return &known_.emplace(writer, std::move(sender)).first->second;
}

bool Senders::Refuse(const Sender& sender) {
  const std::lock_guard lock(mutex_);
  any_refused_ = true;
  return refused_.insert(sender.writer).second;
}

std::vector<Sender> Senders::ForgetEnded(dds_entity_t reader) {
  const std::vector<dds_instance_handle_t> matched = MatchedPublications(reader);
  const auto has_ended = [&matched](dds_instance_handle_t writer) {
    return !std::binary_search(matched.begin(), matched.end(), writer);
  };
  std::vector<Sender> ended;
  std::erase_if(known_, [&](const auto& known) {
    if (!has_ended(known.first)) return false;
    ended.push_back(known.second);
    return true;
  });
  const std::lock_guard lock(mutex_);
  std::erase_if(refused_, has_ended);
  any_refused_ = !refused_.empty();
  return ended;
}

bool Senders::Accepts(dds_instance_handle_t writer) const {
  if (!any_refused_.load(std::memory_order_relaxed)) return true;
  const std::lock_guard lock(mutex_);
  return !refused_.contains(writer);
}

}  // namespace troupe::dds
