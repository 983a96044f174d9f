#include "ros/connection/discovery_relay.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <optional>
#include <string>
#include <utility>

#include "ros/connection/announcement.h"
#include "transport/dds/binding/domain_config.h"
#include "transport/dds/binding/exception.h"

namespace troupe::ros {
namespace {

constexpr const char* kGroup = "239.255.0.1";  // of announcements (RTPS 2.2, section 9.6.1)
constexpr std::size_t kLargest = 65536;        // bytes of a datagram
// Longer than the leases and periods of announcements of all tools.
constexpr auto kForgottenAfter = std::chrono::seconds(120);

sockaddr_in Address(std::uint32_t address, std::uint16_t port) {
  sockaddr_in result{};
  result.sin_family = AF_INET;
  result.sin_addr.s_addr = htonl(address);
  result.sin_port = htons(port);
  return result;
}

std::uint16_t MulticastPort(std::uint32_t domain) {
  return static_cast<std::uint16_t>(dds::DiscoveryPort(domain, 0) - 10);
}

[[noreturn]] void Throw(const std::string& what) {
  throw dds::Exception(DDS_RETCODE_ERROR, what + ": " + std::strerror(errno));
}

}  // namespace

class DiscoveryRelay::Socket {
 public:
  Socket() : handle_(socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0)) {
    if (handle_ < 0) Throw("making a socket for discovery");
  }
  ~Socket() {
    if (handle_ >= 0) close(handle_);
  }
  Socket(Socket&& other) noexcept : handle_(std::exchange(other.handle_, -1)) {}
  Socket& operator=(Socket&&) = delete;

  int handle() const { return handle_; }

  bool Bind(std::uint32_t address, std::uint16_t port) const {
    const sockaddr_in at = Address(address, port);
    return bind(handle_, reinterpret_cast<const sockaddr*>(&at), sizeof at) == 0;
  }
  // Beside the participants of this machine, which have the same group and port.
  void Join(std::uint16_t port) const {
    const int on = 1;
    setsockopt(handle_, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
    setsockopt(handle_, SOL_SOCKET, SO_REUSEPORT, &on, sizeof on);
    ip_mreq request{};
    request.imr_multiaddr.s_addr = inet_addr(kGroup);
    request.imr_interface.s_addr = htonl(INADDR_LOOPBACK);
    if (!Bind(INADDR_ANY, port) || setsockopt(handle_, IPPROTO_IP, IP_ADD_MEMBERSHIP, &request, sizeof request) != 0) {
      Throw("joining the multicast of discovery on the loopback interface");
    }
  }
  std::uint16_t BoundPort() const {
    sockaddr_in at{};
    socklen_t size = sizeof at;
    getsockname(handle_, reinterpret_cast<sockaddr*>(&at), &size);
    return ntohs(at.sin_port);
  }
  // A datagram of this machine; empty if there is none.
  Datagram Receive() const {
    Datagram datagram(kLargest);
    sockaddr_in from{};
    socklen_t size = sizeof from;
    const ssize_t length =
        recvfrom(handle_, datagram.data(), datagram.size(), 0, reinterpret_cast<sockaddr*>(&from), &size);
    const bool is_local = (ntohl(from.sin_addr.s_addr) >> 24) == 127;
    datagram.resize(length > 0 && is_local ? static_cast<std::size_t>(length) : 0);
    return datagram;
  }

 private:
  int handle_;
};

DiscoveryRelay::DiscoveryRelay(std::uint32_t domain, std::uint32_t indices) {
  const Socket& of_agents = sockets_.emplace_back();
  if (!of_agents.Bind(INADDR_LOOPBACK, 0)) Throw("making a socket for discovery");
  port_ = of_agents.BoundPort();
  sockets_.emplace_back().Join(MulticastPort(domain));
  // The last index that is free, because tools look for one from the first on.
  for (std::uint32_t index = indices; index-- > 0;) {
    Socket unicast;
    if (!unicast.Bind(INADDR_LOOPBACK, dds::DiscoveryPort(domain, index))) continue;
    sockets_.push_back(std::move(unicast));
    break;
  }
  thread_ = std::thread([this] { Run(); });
}

DiscoveryRelay::~DiscoveryRelay() {
  stop_.Signal();
  thread_.join();
}

void DiscoveryRelay::Run() {
  std::vector<pollfd> waited = {{stop_.descriptor(), POLLIN, 0}};
  for (const Socket& socket : sockets_) waited.push_back({socket.handle(), POLLIN, 0});
  for (;;) {
    if (poll(waited.data(), waited.size(), -1) < 0 && errno != EINTR) return;
    if (waited[0].revents != 0) return;
    for (std::size_t i = 0; i < sockets_.size(); ++i) {
      if (waited[i + 1].revents == 0) continue;
      const Datagram datagram = sockets_[i].Receive();
      if (datagram.empty()) continue;
      if (i == 0) {
        OnAgent(datagram);
      } else {
        OnOther(datagram);
      }
    }
  }
}

void DiscoveryRelay::OnAgent(const Datagram& datagram) {
  const std::optional<Announcement> announcement = ParseAnnouncement(datagram);
  if (!announcement) return;
  if (announcement->discovery_port == 0) {
    agents_.erase(announcement->prefix);
    return;
  }
  if (agents_.size() >= kMost && !agents_.contains(announcement->prefix)) {
    ForgetSilent();
    if (agents_.size() >= kMost) return;
  }
  Agent& agent = agents_[announcement->prefix];
  const bool is_new = agent.port != announcement->discovery_port;
  agent = {announcement->discovery_port, Clock::now()};
  if (!is_new) return;
  for (const auto& [prefix, other] : others_) Send(other.announcement, agent.port);
}

void DiscoveryRelay::OnOther(const Datagram& datagram) {
  const std::optional<Announcement> announcement = ParseAnnouncement(datagram);
  if (!announcement || agents_.contains(announcement->prefix)) return;
  if (announcement->discovery_port == 0) {
    others_.erase(announcement->prefix);
  } else if (others_.size() < kMost || others_.contains(announcement->prefix)) {
    others_[announcement->prefix] = {datagram, Clock::now()};
  }
  for (const auto& [prefix, agent] : agents_) Send(datagram, agent.port);
  ForgetSilent();
}

void DiscoveryRelay::Send(const Datagram& datagram, std::uint16_t port) const {
  const sockaddr_in to = Address(INADDR_LOOPBACK, port);
  sendto(sockets_.front().handle(), datagram.data(), datagram.size(), 0, reinterpret_cast<const sockaddr*>(&to),
         sizeof to);
}

void DiscoveryRelay::ForgetSilent() {
  const Clock::time_point oldest = Clock::now() - kForgottenAfter;
  std::erase_if(agents_, [&](const auto& agent) { return agent.second.seen < oldest; });
  std::erase_if(others_, [&](const auto& other) { return other.second.seen < oldest; });
}

}  // namespace troupe::ros
