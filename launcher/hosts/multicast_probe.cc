#include "launcher/hosts/multicast_probe.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <signal.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <memory>
#include <string_view>

#include "launcher/hosts/connect_hosts.h"

namespace troupe {
namespace {

using Clock = std::chrono::steady_clock;

constexpr const char* kGroup = "239.255.0.1";  // of RTPS
constexpr auto kPeriod = std::chrono::milliseconds(20);
constexpr auto kSending = std::chrono::seconds(10);
constexpr auto kListening = std::chrono::seconds(2);
constexpr int kPollMilliseconds = 10;
constexpr unsigned char kHops = 32;  // as Cyclone's

// Exit statuses.
constexpr int kHeard = 0;
constexpr int kNotHeard = 3;
constexpr int kCannotListen = 2;

class Socket {
 public:
  Socket() : descriptor_(socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {}
  ~Socket() {
    if (descriptor_ >= 0) close(descriptor_);
  }
  Socket(const Socket&) = delete;
  Socket& operator=(const Socket&) = delete;

  int get() const { return descriptor_; }
  template <typename Value>
  bool Set(int level, int option, const Value& value) {
    return setsockopt(descriptor_, level, option, &value, sizeof value) == 0;
  }

 private:
  int descriptor_;
};

sockaddr_in GroupAddress(std::uint16_t port) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  inet_pton(AF_INET, kGroup, &address.sin_addr);
  return address;
}

in_addr AddressOf(const std::string& network_interface) {
  in_addr address{};
  inet_pton(AF_INET, LocalAddress(network_interface).c_str(), &address);
  return address;
}

std::vector<std::string> Arguments(const char* task, const std::string& network_interface, std::uint32_t domain,
                                   const std::string& word) {
  // Data by multicast (RTPS 2.2, section 9.6.1).
  const std::uint32_t port = 7401 + 250 * domain;
  return {"host",   "--multicast",        task,     "--interface", network_interface,
          "--port", std::to_string(port), "--word", word};
}

}  // namespace

int SendMulticast(const MulticastProbe& probe) {
  Socket socket;
  socket.Set(IPPROTO_IP, IP_MULTICAST_IF, AddressOf(probe.network_interface));
  socket.Set(IPPROTO_IP, IP_MULTICAST_TTL, kHops);
  const sockaddr_in group = GroupAddress(probe.port);
  for (const auto end = Clock::now() + kSending; Clock::now() < end;) {
    sendto(socket.get(), probe.word.data(), probe.word.size(), 0, reinterpret_cast<const sockaddr*>(&group),
           sizeof group);
    poll(nullptr, 0, static_cast<int>(kPeriod.count()));
  }
  return 0;
}

int ListenForMulticast(const MulticastProbe& probe) {
  Socket socket;
  const sockaddr_in group = GroupAddress(probe.port);
  // Participants of other runs may listen at the port, too.
  const bool listens =
      socket.Set(SOL_SOCKET, SO_REUSEADDR, 1) && socket.Set(SOL_SOCKET, SO_REUSEPORT, 1) &&
      bind(socket.get(), reinterpret_cast<const sockaddr*>(&group), sizeof group) == 0 &&
      socket.Set(IPPROTO_IP, IP_ADD_MEMBERSHIP, ip_mreq{group.sin_addr, AddressOf(probe.network_interface)});
  if (!listens) return kCannotListen;
  const auto end = Clock::now() + kListening;
  for (;;) {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(end - Clock::now()).count();
    pollfd waited{socket.get(), POLLIN, 0};
    if (left <= 0) return kNotHeard;
    if (poll(&waited, 1, static_cast<int>(left)) <= 0) continue;
    char text[256];
    const ssize_t size = recv(socket.get(), text, sizeof text, MSG_DONTWAIT);
    if (size > 0 && std::string_view(text, static_cast<std::size_t>(size)) == probe.word) return kHeard;
  }
}

std::vector<std::string> HostsWithoutMulticast(const HostOnNetwork& from, const std::vector<HostOnNetwork>& to,
                                               std::uint32_t domain, const std::string& word, SignalWatch& signals) {
  struct Listener {
    Host* host;
    std::unique_ptr<Child> process;
  };
  std::vector<Listener> listeners;
  for (const auto& [host, network_interface] : to) {
    Result<std::unique_ptr<Child>> listener =
        host->Start("troupe", Arguments("listen", network_interface, domain, word), false);
    if (listener.ok()) listeners.push_back({host, std::move(listener).value()});
  }
  const Result<std::unique_ptr<Child>> sender =
      from.first->Start("troupe", Arguments("send", from.second, domain, word), false);
  if (!sender.ok()) return {};
  std::vector<std::string> deaf;
  const auto end = Clock::now() + kSending;
  while (!listeners.empty() && Clock::now() < end) {
    std::vector<pollfd> waited = {{signals.descriptor(), POLLIN, 0}};
    from.first->Receive();
    from.first->ReadOutput();
    for (const Listener& listener : listeners) {
      listener.host->Receive();
      listener.host->ReadOutput();
      for (const int descriptor : listener.host->descriptors()) waited.push_back({descriptor, POLLIN, 0});
    }
    std::erase_if(listeners, [&](const Listener& listener) {
      if (!listener.process->Poll()) return false;
      if (listener.process->end()->exit_code == kNotHeard) deaf.push_back(listener.host->name());
      return true;
    });
    if (signals.ReadStopRequest()) break;
    if (!listeners.empty()) poll(waited.data(), waited.size(), kPollMilliseconds);
  }
  sender.value()->Kill();
  return signals.stop_requested() ? std::vector<std::string>() : deaf;
}

}  // namespace troupe
