#include "transport/dds/transport/senders.h"

#include <algorithm>
#include <string_view>
#include <utility>

#include "transport/dds/binding/data_reader.h"

namespace troupe::dds {
namespace {

// Fields of the user data, with ';' between them.
constexpr std::string_view kProof = "troupe-proof=";
constexpr std::string_view kSharing = "troupe-sharing=";

std::optional<std::string> FieldOf(std::string_view user_data, std::string_view name) {
  while (!user_data.empty()) {
    const std::size_t end = std::min(user_data.find(';'), user_data.size());
    if (user_data.starts_with(name)) return std::string(user_data.substr(name.size(), end - name.size()));
    user_data.remove_prefix(std::min(end + 1, user_data.size()));
  }
  return std::nullopt;
}

}  // namespace

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
  // The usual case costs no lock: this is called for every sample.
  if (!any_refused_.load(std::memory_order_relaxed)) return true;
  const std::lock_guard lock(mutex_);
  return !refused_.contains(writer);
}

RunProof::RunProof(const std::optional<RunToken>& token, const GuidPrefix& participant)
    : token_(token), proof_(token ? token->Proof(ToText(participant)) : std::string()) {}

Qos RunProof::Announced(Qos qos, const std::string& sharing) const {
  std::string data = token_ ? std::string(kProof) + proof_ : std::string();
  if (!sharing.empty()) data.append(data.empty() ? "" : ";").append(kSharing).append(sharing);
  if (!data.empty()) qos << UserData{data};
  return qos;
}

std::string RunProof::SharingOf(const std::string& user_data) {
  return FieldOf(user_data, kSharing).value_or("");
}

ProofCheck RunProof::Check(const GuidPrefix& participant, const std::string& user_data) const {
  const std::optional<std::string> proof = FieldOf(user_data, kProof);
  if (!token_) return proof ? ProofCheck::kUnknownProof : ProofCheck::kAccepted;
  if (!proof) return ProofCheck::kNoProof;
  return token_->Accepts(ToText(participant), *proof) ? ProofCheck::kAccepted : ProofCheck::kUnknownProof;
}

}  // namespace troupe::dds
