#include "ros/connection/announcement.h"

#include <gtest/gtest.h>

#include <vector>

namespace troupe::ros {
namespace {

using Datagram = std::vector<std::uint8_t>;

void Append(Datagram& to, const Datagram& bytes) {
  to.insert(to.end(), bytes.begin(), bytes.end());
}

// The content of an announcement: a vendor, and the locator of discovery at port 0x1cf2.
Datagram Content() {
  Datagram content = {0x00, 0x03, 0x00, 0x00, 0x16, 0x00, 0x04, 0x00, 0x01, 0x10, 0x00, 0x00, 0x32, 0x00, 0x18, 0x00};
  Append(content, {0x01, 0x00, 0x00, 0x00, 0xf2, 0x1c, 0x00, 0x00});
  Append(content, {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 127, 0, 0, 1});
  Append(content, {0x01, 0x00, 0x00, 0x00});
  return content;
}

Datagram Message(std::uint8_t writer, const Datagram& content) {
  Datagram message = {'R', 'T', 'P', 'S', 2, 1, 1, 0x10, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12};
  Append(message, {0x09, 0x01, 0x08, 0x00, 0, 0, 0, 0, 0, 0, 0, 0});  // a time stamp
  Append(message, {0x15, 0x05, static_cast<std::uint8_t>(20 + content.size()), 0x00});
  Append(message, {0, 0, 0x10, 0x00, 0, 0, 0, 0, 0x00, 0x01, 0x00, writer, 0, 0, 0, 0, 1, 0, 0, 0});
  Append(message, content);
  return message;
}

TEST(ParseAnnouncement, FindsTheParticipantAndItsPort) {
  const auto announcement = ParseAnnouncement(Message(0xc2, Content()));
  ASSERT_TRUE(announcement.has_value());
  EXPECT_EQ(announcement->prefix.front(), 1);
  EXPECT_EQ(announcement->prefix.back(), 12);
  EXPECT_EQ(announcement->discovery_port, 0x1cf2);
}

TEST(ParseAnnouncement, SkipsOtherMessages) {
  EXPECT_FALSE(ParseAnnouncement(Message(0xc7, Content())).has_value());
  EXPECT_FALSE(ParseAnnouncement({}).has_value());
  EXPECT_FALSE(ParseAnnouncement(Datagram(100, 0x15)).has_value());
}

TEST(ParseAnnouncement, ReadsNothingBehindTheEndOfADatagram) {
  const Datagram whole = Message(0xc2, Content());
  for (std::size_t length = 0; length < whole.size(); ++length) {
    const Datagram part(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(length));
    EXPECT_FALSE(ParseAnnouncement(part).has_value()) << length;
  }
  for (std::size_t i = 20; i < whole.size(); ++i) {
    Datagram changed = whole;
    for (const int value : {0, 1, 0x7f, 0xff}) {
      changed[i] = static_cast<std::uint8_t>(value);
      const auto announcement = ParseAnnouncement(changed);
      EXPECT_TRUE(!announcement || announcement->prefix.front() == 1);
    }
  }
}

}  // namespace
}  // namespace troupe::ros
