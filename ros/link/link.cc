#include "ros/link/link.h"

#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <nlohmann/json.hpp>
#include <optional>

#include "common/base/identity.h"
#include "common/base/json.h"
#include "common/base/json_reader.h"
#include "common/base/system_error.h"
#include "common/base/text.h"
#include "troupe/check.h"

namespace troupe::ros {
namespace {

constexpr std::size_t kReadAtATime = std::size_t{64} << 10;
constexpr int kMaxChunks = 16;  // of one call: a fast sender holds up no other
constexpr std::size_t kDroppedAtATime = std::size_t{256} << 10;

using nlohmann::json;

constexpr std::int32_t kMaxDepth = 1'000'000;  // samples

// The text is of a peer: one line of plain text in the log, and not all of it.
Error Malformed(std::string_view text) {
  return {{}, "found '" + PlainLine(text, 200) + "', expected a version, a node, an endpoint or a watch"};
}

template <typename Text>
Result<Text> Parse(std::string_view text) {
  Result<Text> parsed = RowFromJson<Text>(text);
  return parsed.ok() ? std::move(parsed) : Malformed(text);
}

Error BadName(const std::string& name) {
  return {{}, "found '" + name + "', expected the name of a socket"};
}

Error SocketFailure(const std::string& doing, const std::string& name) {
  return SystemError("cannot " + doing + " '" + name + "'");
}

int MakeSocket() {
  return socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
}

bool IsOfThisUser(int connection) {
  ucred peer = {};
  socklen_t size = sizeof peer;
  return getsockopt(connection, SOL_SOCKET, SO_PEERCRED, &peer, &size) == 0 && peer.uid == geteuid();
}

}  // namespace

Link::Link(int descriptor) : descriptor_(descriptor), chunk_(kReadAtATime) {}

Link::~Link() {
  close(descriptor_);
}

void Link::Add(LinkKind kind, std::uint32_t id, std::span<const std::byte> content) {
  TROUPE_CHECK(content.size() <= kMaxContent);
  const Header header = {static_cast<std::uint32_t>(content.size()), static_cast<std::uint32_t>(kind), id};
  const auto begin = std::as_bytes(std::span(&header, 1));
  const std::lock_guard lock(mutex_);
  output_.insert(output_.end(), begin.begin(), begin.end());
  output_.insert(output_.end(), content.begin(), content.end());
}

bool Link::Flush() {
  const std::lock_guard lock(mutex_);
  while (sent_ < output_.size()) {
    const ssize_t sent = send(descriptor_, output_.data() + sent_, output_.size() - sent_, MSG_DONTWAIT | MSG_NOSIGNAL);
    if (sent < 0 && errno == EINTR) continue;
    if (sent < 0) {
      const int error = errno;
      DropSent();
      return error == EAGAIN || error == EWOULDBLOCK;
    }
    sent_ += static_cast<std::size_t>(sent);
  }
  output_.clear();
  sent_ = 0;
  return true;
}

// Drops what was sent, also of a link that is never empty; but not at each call, because the rest moves in memory.
void Link::DropSent() {
  if (sent_ < kDroppedAtATime) return;
  output_.erase(output_.begin(), output_.begin() + static_cast<std::ptrdiff_t>(sent_));
  sent_ = 0;
}

std::size_t Link::pending() const {
  const std::lock_guard lock(mutex_);
  return output_.size() - sent_;
}

bool Link::ReadArrived() {
  for (int chunk = 0; chunk < kMaxChunks; ++chunk) {
    const ssize_t count = recv(descriptor_, chunk_.data(), chunk_.size(), MSG_DONTWAIT);
    if (count == 0) return false;
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return errno == EAGAIN || errno == EWOULDBLOCK;
    received_.insert(received_.end(), chunk_.begin(), chunk_.begin() + count);
    // Less than asked for: the socket is empty, and another call would only say so.
    if (static_cast<std::size_t>(count) < chunk_.size()) return true;
  }
  return true;
}

std::vector<std::byte> ToBytes(const std::set<std::uint32_t>& ids) {
  std::vector<std::byte> bytes(ids.size() * sizeof(std::uint32_t));
  std::byte* at = bytes.data();
  for (const std::uint32_t id : ids) {
    std::memcpy(at, &id, sizeof id);
    at += sizeof id;
  }
  return bytes;
}

std::set<std::uint32_t> ToIds(std::span<const std::byte> bytes) {
  std::set<std::uint32_t> ids;
  for (std::uint32_t id = 0; bytes.size() >= sizeof id; bytes = bytes.subspan(sizeof id)) {
    std::memcpy(&id, bytes.data(), sizeof id);
    ids.insert(id);
  }
  return ids;
}

std::string ToText(const HelloText& hello) {
  return JsonText(FieldsToJson<json>(hello));
}

std::string ToText(const MadeText& made) {
  return JsonText(FieldsToJson<json>(made));
}

Result<HelloText> ParseHello(std::string_view text) {
  return Parse<HelloText>(text);
}

Result<MadeText> ParseMade(std::string_view text) {
  Result<MadeText> made = Parse<MadeText>(text);
  if (!made.ok()) return made;
  const MadeText& found = made.value();
  const bool is_valid = found.kind <= kLastMadeKind && found.qos.kind <= TopicQos::Kind::kLogLines &&
                        found.qos.depth >= 1 && found.qos.depth <= kMaxDepth && found.part <= Part::kBestEffortReader;
  if (!is_valid) return Malformed(text);
  return made;
}

Result<int> Bind(const std::string& name) {
  const std::optional<LocalAddress> address = MakeLocalAddress(name);
  if (!address) return BadName(name);
  const int descriptor = MakeSocket();
  if (descriptor >= 0 && bind(descriptor, address->get(), address->length) == 0) return descriptor;
  const Error failure = SocketFailure("bind socket", name);
  if (descriptor >= 0) close(descriptor);
  return failure;
}

Result<int> Connect(const std::string& name) {
  const std::optional<LocalAddress> address = MakeLocalAddress(name);
  if (!address) return BadName(name);
  const int descriptor = MakeSocket();
  if (descriptor >= 0 && connect(descriptor, address->get(), address->length) == 0) {
    if (IsOfThisUser(descriptor)) return descriptor;
    close(descriptor);
    return Failure("socket '" + name + "' belongs to another user");
  }
  const Error failure = SocketFailure("connect to socket", name);
  if (descriptor >= 0) close(descriptor);
  return failure;
}

int Accept(int listening) {
  const int connection = accept4(listening, nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK);
  if (connection >= 0 && !IsOfThisUser(connection)) {
    close(connection);
    return -1;
  }
  return connection;
}

}  // namespace troupe::ros
