// Packets to the discovery ports of a domain on the loopback interface: well-formed down to the submessage of an
// announcement, then random.
// Purely random bytes would be dropped at the header: these reach the parser of parameters, where faults are. The
// packets are a function of their number, so that a finding can be repeated.
#pragma once

#include <arpa/inet.h>
#include <dds/dds.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cstdint>
#include <cstring>
#include <vector>

#include "troupe/random.h"

namespace troupe::test {

class GarbageSender {
 public:
  // `peer`: the participant that every second packet names as its sender.
  GarbageSender(std::uint32_t domain, dds_entity_t peer) : base_port_(7400 + 250 * domain) {
    dds_guid_t guid{};
    dds_get_guid(peer, &guid);
    std::memcpy(peer_.data(), guid.v, peer_.size());
    const in_addr loopback{htonl(INADDR_LOOPBACK)};
    setsockopt(socket_, IPPROTO_IP, IP_MULTICAST_IF, &loopback, sizeof loopback);
  }
  ~GarbageSender() { close(socket_); }

  // Sends the i-th packet, by multicast and to the first participants of this host.
  void Send(std::uint64_t i) const {
    const std::vector<std::uint8_t> packet = Packet(i);
    SendTo(packet, "239.255.0.1", base_port_);
    for (std::uint32_t participant = 0; participant < 4; ++participant) {
      SendTo(packet, "127.0.0.1", base_port_ + 10 + 2 * participant);
    }
  }

 private:
  static std::uint8_t Byte(std::uint64_t i, std::uint64_t k) {
    return static_cast<std::uint8_t>(RandomBits({i, k}) & 0xffU);
  }

  std::vector<std::uint8_t> Packet(std::uint64_t i) const {
    std::vector<std::uint8_t> packet = {'R', 'T', 'P', 'S', 2, 1, 1, 16};  // version 2.1, vendor Eclipse Cyclone
    for (std::size_t k = 0; k < peer_.size(); ++k) packet.push_back(i % 2 == 0 ? peer_[k] : Byte(i, k));
    std::vector<std::uint8_t> body = {0, 0, 16, 0, 0, 0, 0, 0};  // flags, offset to the payload, any reader
    // The built-in writers that announce participants, writers, readers.
    constexpr std::uint8_t kWriters[3][4] = {{0, 1, 0, 0xc2}, {0, 0, 3, 0xc2}, {0, 0, 4, 0xc2}};
    body.insert(body.end(), std::begin(kWriters[i % 3]), std::end(kWriters[i % 3]));
    body.insert(body.end(), {0, 0, 0, 0, static_cast<std::uint8_t>(1 + i % 200), 0, 0, 0});  // sequence number
    body.insert(body.end(), {0, 3, 0, 0});                                                   // a list of parameters
    const std::size_t parameters = 1 + Byte(i, 100) % 8;
    for (std::size_t p = 0; p < parameters; ++p) {
      const std::size_t length = 4 * (Byte(i, 200 + p) % 12);
      // Mostly known ids and mostly correct lengths.
      body.insert(body.end(), {static_cast<std::uint8_t>(Byte(i, 300 + p) % 0x78), 0,
                               static_cast<std::uint8_t>(Byte(i, 400 + p) < 230 ? length : Byte(i, 500 + p)), 0});
      for (std::size_t k = 0; k < length; ++k)
        body.push_back(Byte(i, 1000 + 100 * p + k) < 128 ? 0 : Byte(i, 2000 + k));
    }
    if (i % 5 != 0) body.insert(body.end(), {1, 0, 0, 0});  // the end of the list
    packet.insert(packet.end(), {0x15, 0x05, static_cast<std::uint8_t>(body.size() & 0xffU),
                                 static_cast<std::uint8_t>(body.size() >> 8U)});  // DATA, little-endian
    packet.insert(packet.end(), body.begin(), body.end());
    return packet;
  }

  void SendTo(const std::vector<std::uint8_t>& packet, const char* address, std::uint32_t port) const {
    sockaddr_in to{};
    to.sin_family = AF_INET;
    to.sin_port = htons(static_cast<std::uint16_t>(port));
    inet_pton(AF_INET, address, &to.sin_addr);
    sendto(socket_, packet.data(), packet.size(), 0, reinterpret_cast<const sockaddr*>(&to), sizeof to);
  }

  std::uint32_t base_port_;
  int socket_ = socket(AF_INET, SOCK_DGRAM, 0);
  std::array<std::uint8_t, 12> peer_{};
};

}  // namespace troupe::test
