// The world message: the description of a world for the page, once for each edition.
#pragma once

#include <cstdint>
#include <string>

#include "transport/protocol/messages.h"

namespace troupe {

// The first byte of each binary message to the page.
enum class PageMessage : std::uint8_t { kWorld = 1, kUpdate = 2 };

// Version of the layout of messages; the page refuses another one.
inline constexpr std::uint32_t kPageProtocol = 5;

// A dense bitmap is sent with at most this many pixels along each side; beyond that a pixel of the page stands for
// several, and is occupied if one of them is.
inline constexpr int kLargestArea = 2048;

// The bytes of the message. `number`: of the world, counted by the gateway; the updates of the world repeat it.
std::string EncodeWorld(const SessionMessage& session, std::uint32_t number);

}  // namespace troupe
