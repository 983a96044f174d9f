#include "ros/connection/announcement.h"

#include <gtest/gtest.h>

#include <vector>

#include "tests/support/announcement_message.h"

namespace troupe::ros {
namespace {

using Datagram = std::vector<std::uint8_t>;

Datagram Message(std::uint8_t writer) {
  return test::AnnouncementMessage({1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12}, 0x1cf2, writer);
}

TEST(ParseAnnouncement, FindsTheParticipantAndItsPort) {
  const auto announcement = ParseAnnouncement(Message(0xc2));
  ASSERT_TRUE(announcement.has_value());
  EXPECT_EQ(announcement->prefix.front(), 1);
  EXPECT_EQ(announcement->prefix.back(), 12);
  EXPECT_EQ(announcement->discovery_port, 0x1cf2);
}

TEST(ParseAnnouncement, SkipsOtherMessages) {
  EXPECT_FALSE(ParseAnnouncement(Message(0xc7)).has_value());
  EXPECT_FALSE(ParseAnnouncement({}).has_value());
  EXPECT_FALSE(ParseAnnouncement(Datagram(100, 0x15)).has_value());
}

TEST(ParseAnnouncement, ReadsNothingBehindTheEndOfADatagram) {
  const Datagram whole = Message(0xc2);
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
