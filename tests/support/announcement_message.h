// The announcement of a participant, as RTPS sends it.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace troupe::test {

// With the locator of discovery at `port` of the loopback interface. `writer`: the last byte of its id; 0xc2 is that of
// announcements.
inline std::vector<std::uint8_t> AnnouncementMessage(const std::array<std::uint8_t, 12>& prefix, std::uint16_t port,
                                                     std::uint8_t writer = 0xc2) {
  std::vector<std::uint8_t> message = {'R', 'T', 'P', 'S', 2, 1, 1, 0x10};
  const auto append = [&message](const std::vector<std::uint8_t>& bytes) {
    message.insert(message.end(), bytes.begin(), bytes.end());
  };
  append({prefix.begin(), prefix.end()});
  append({0x09, 0x01, 0x08, 0x00, 0, 0, 0, 0, 0, 0, 0, 0});  // a time stamp
  append({0x15, 0x05, 64, 0x00});                            // data
  append({0, 0, 0x10, 0x00, 0, 0, 0, 0, 0x00, 0x01, 0x00, writer, 0, 0, 0, 0, 1, 0, 0, 0});
  append({0x00, 0x03, 0x00, 0x00, 0x16, 0x00, 0x04, 0x00, 0x01, 0x10, 0x00, 0x00});  // a vendor
  append({0x32, 0x00, 0x18, 0x00, 0x01, 0x00, 0x00, 0x00});                          // the locator
  append({static_cast<std::uint8_t>(port & 0xffU), static_cast<std::uint8_t>(port >> 8U), 0x00, 0x00});
  append({0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 127, 0, 0, 1});
  append({0x01, 0x00, 0x00, 0x00});  // the end
  return message;
}

}  // namespace troupe::test
