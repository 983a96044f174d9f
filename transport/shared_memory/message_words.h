// Frames, always with the whole state, and proposals between their messages and words.
#pragma once

#include "transport/protocol/messages.h"
#include "transport/shared_memory/words.h"
#include "troupe/result.h"

namespace troupe {

void AddFrame(const FrameMessage& frame, WordWriter& words);
std::size_t CountFrameWords(const FrameMessage& frame);  // that AddFrame adds
void AddProposal(const ProposalMessage& message, WordWriter& words);

// These fill their messages, so that their memory is used again. The error is that of words that are not those of a
// message, which is then unspecified. Words that change meanwhile give an error, or a message of values that are each
// of their type: the receiver of a frame checks it by its world (CheckState), the run refuses numbers of a proposal
// that are not finite with an event that names the robot.
Status ReadFrame(WordReader words, FrameMessage& frame);
Status ReadProposal(WordReader words, ProposalMessage& message);

}  // namespace troupe
