// The proof that a writer is of a process of the run, or of one of its owner's tools: in the user data of the writer's
// announcement, so that a reader can ask for it before it reads a sample. docs/security.md says which runs have tokens.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "transport/dds/binding/guid_prefix.h"
#include "transport/dds/binding/qos.h"
#include "transport/security/run_token.h"

namespace troupe::dds {

enum class ProofCheck : std::uint8_t {
  kAccepted,      // or none is asked for
  kNoProof,       // the run has a token, and the writer's participant does not
  kUnknownProof,  // of another token, or this participant has none
};

class RunProof {
 public:
  // Of a participant with this identity. Without a token it proves nothing, and asks for no proof.
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

}  // namespace troupe::dds
