// A frame between its message and words: always the whole state.
#pragma once

#include "transport/protocol/messages.h"
#include "transport/shared_memory/words.h"
#include "troupe/result.h"

namespace troupe {

void AddFrame(const FrameMessage& frame, WordWriter& words);
std::size_t CountFrameWords(const FrameMessage& frame);

// Fills `frame`, so that its memory is used again. The error is that of words that are not those of a frame; `frame` is
// then unspecified. Words that change meanwhile give an error or a frame of values that are each valid.
Status ReadFrame(WordReader words, FrameMessage& frame);

}  // namespace troupe
