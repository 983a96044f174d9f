#include "transport/dds/transport/run_proof.h"

#include <algorithm>
#include <string_view>
#include <utility>

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
