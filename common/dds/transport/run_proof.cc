#include "common/dds/transport/run_proof.h"

#include <string_view>
#include <utility>

namespace troupe::dds {
namespace {

constexpr std::string_view kName = "troupe-proof=";

}  // namespace

RunProof::RunProof(const std::optional<RunToken>& token, const GuidPrefix& participant)
    : token_(token), proof_(token ? token->Proof(ToText(participant)) : std::string()) {}

Qos RunProof::Announced(Qos qos) const {
  if (!token_) return qos;
  qos << UserData{std::string(kName) + proof_};
  return qos;
}

ProofCheck RunProof::Check(const GuidPrefix& participant, const std::string& user_data) const {
  const bool has_proof = user_data.starts_with(kName);
  if (!token_) return has_proof ? ProofCheck::kUnknownProof : ProofCheck::kAccepted;
  if (!has_proof) return ProofCheck::kNoProof;
  const bool accepted = token_->Accepts(ToText(participant), user_data.substr(kName.size()));
  return accepted ? ProofCheck::kAccepted : ProofCheck::kUnknownProof;
}

}  // namespace troupe::dds
