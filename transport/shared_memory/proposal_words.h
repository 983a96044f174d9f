// A proposal message between its message and words.
#pragma once

#include "transport/protocol/messages.h"
#include "transport/shared_memory/words.h"
#include "troupe/result.h"

namespace troupe {

void AddProposal(const ProposalMessage& message, WordWriter& words);

// Fills `message`, so that its memory is used again. The error is that of words that are not those of a proposal;
// `message` is then unspecified. Numbers that are not finite pass: the run refuses them with an event that names the
// robot.
Status ReadProposal(WordReader words, ProposalMessage& message);

}  // namespace troupe
