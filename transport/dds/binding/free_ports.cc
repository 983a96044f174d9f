#include "transport/dds/binding/free_ports.h"

#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include "transport/dds/binding/domain_config.h"

namespace troupe::dds {
namespace {

bool IsFree(std::uint16_t port) {
  const int socket = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (socket < 0) return true;
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  address.sin_addr.s_addr = htonl(INADDR_ANY);
  const bool free = bind(socket, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) == 0;
  close(socket);
  return free;
}

}  // namespace

bool PortsAreFree(std::uint32_t domain, std::uint32_t participant_index) {
  const std::uint16_t port = DiscoveryPort(domain, participant_index);
  return IsFree(port) && IsFree(static_cast<std::uint16_t>(port + 1));
}

}  // namespace troupe::dds
