#include "library/runs/state_stream.h"

#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <span>
#include <utility>
#include <vector>

#include "transport/wire/message_bytes.h"

namespace troupe {
namespace {

enum class Kind : std::uint32_t { kVersion, kSession, kFrame };
using Header = std::array<std::uint32_t, 2>;  // the kind and the length in bytes: the programs are of one machine

constexpr std::uint32_t kMaxBytes = std::uint32_t{1} << 30;

// False: the receiver is gone. Without a signal (SIGPIPE) in the program that uses the library.
bool SendAll(int socket, const void* data, std::size_t size) {
  const char* next = static_cast<const char*>(data);
  while (size > 0) {
    const ssize_t sent = send(socket, next, size, MSG_NOSIGNAL);
    if (sent < 0 && errno == EINTR) continue;
    if (sent <= 0) return false;
    next += sent;
    size -= static_cast<std::size_t>(sent);
  }
  return true;
}

// Two writes, as the bytes may be large; the receiver reads the header first.
bool SendMessage(int socket, Kind kind, std::span<const std::byte> bytes) {
  if (bytes.size() > kMaxBytes) return false;
  const Header header = {static_cast<std::uint32_t>(kind), static_cast<std::uint32_t>(bytes.size())};
  return SendAll(socket, header.data(), sizeof(header)) && SendAll(socket, bytes.data(), bytes.size());
}

// False at the end.
bool ReceiveAll(int socket, void* data, std::size_t size) {
  char* next = static_cast<char*>(data);
  while (size > 0) {
    const ssize_t got = read(socket, next, size);
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return false;
    next += got;
    size -= static_cast<std::size_t>(got);
  }
  return true;
}

template <typename Message>
Result<StreamedMessage> Parse(std::span<const std::byte> bytes) {
  Result<Message> message = wire::FromBytes<Message>(bytes);
  if (!message.ok()) return message.error();
  return StreamedMessage(std::move(message).value());
}

}  // namespace

bool SendVersion(int socket, std::string_view version) {
  return SendMessage(socket, Kind::kVersion, std::as_bytes(std::span(version)));
}

bool SendState(int socket, const SessionMessage& session) {
  return SendMessage(socket, Kind::kSession, wire::ToBytes(session));
}

bool SendState(int socket, const FrameMessage& frame) {
  return SendMessage(socket, Kind::kFrame, wire::ToBytes(frame));
}

// An end within a message counts as the end of the stream.
Result<StreamedMessage> ReceiveState(int socket) {
  Header header;
  if (!ReceiveAll(socket, header.data(), sizeof(header))) return StreamedMessage();
  const auto [kind, size] = header;
  // Before the allocation: the length comes from the other program.
  if (size > kMaxBytes) return Error{{}, "found a message that is too long"};
  std::vector<std::byte> bytes(size);
  if (!ReceiveAll(socket, bytes.data(), size)) return StreamedMessage();
  switch (static_cast<Kind>(kind)) {
    case Kind::kVersion:
      return StreamedMessage(std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
    case Kind::kSession:
      return Parse<SessionMessage>(bytes);
    case Kind::kFrame:
      return Parse<FrameMessage>(bytes);
  }
  return Error{{}, "found an unknown kind of message"};
}

}  // namespace troupe
