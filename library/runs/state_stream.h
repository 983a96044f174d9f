// The states of a simulation on their way to the program that shows them (`troupe view --states`): messages over a
// socket, each with its kind and length. First comes the version of the program, then sessions (a world) and frames (a
// state of it).
//
// Content is the same as between the processes of a run (transport/wire), so that viewers need no second form of a
// state. Both programs are of one machine and, by the first message, of one version: the header is in the byte order of
// the host. The functions block; the sender has a thread of its own (simulation_page.cc).
#pragma once

#include <string>
#include <string_view>
#include <variant>

#include "transport/protocol/messages.h"
#include "troupe/result.h"

namespace troupe {

// Writes a whole message to a socket. False: it has no reader any more.
bool SendVersion(int socket, std::string_view version);
bool SendState(int socket, const SessionMessage& session);
bool SendState(int socket, const FrameMessage& frame);

struct EndOfStream {};
using StreamedMessage = std::variant<EndOfStream, std::string, SessionMessage, FrameMessage>;  // the string: a version
// Waits for the next message. Any bytes are safe; the error is one that is no message.
Result<StreamedMessage> ReceiveState(int socket);

}  // namespace troupe
