#include "ros/fast_dds/rtps_datagram.h"

#include <gtest/gtest.h>

#include <string>

namespace troupe::ros {
namespace {

Bytes Header(std::uint8_t vendor) {
  Bytes bytes = {'R', 'T', 'P', 'S', 2, 3, 1, vendor};
  bytes.resize(20, 7);
  return bytes;
}

Bytes operator+(Bytes left, const Bytes& right) {
  left.insert(left.end(), right.begin(), right.end());
  return left;
}

const Bytes kTimestamp = {0x09, 1, 8, 0, 1, 2, 3, 4, 5, 6, 7, 8};
// The begin of the data of an announcement, in little endian, without its length.
const Bytes kToAnnouncement = {0, 0, 16, 0, 0, 1, 0, 0xc7, 0, 1, 0, 0xc2, 0, 0, 0, 0, 1, 0, 0, 0};
const Bytes kParameters = {0, 3, 0, 0, 0x15, 0, 4, 0, 2, 3, 0, 0, 1, 0, 0, 0};
const Bytes kTag = {0x14, 0x40, 8, 0, 3, 0, 0, 0, 'm', 'e', 0, 0};

Bytes Tagged() {
  return Bytes(kParameters.begin(), kParameters.begin() + 4) + kTag + Bytes(kParameters.begin() + 4, kParameters.end());
}

TEST(RtpsDatagram, TellsTheImplementation) {
  EXPECT_TRUE(IsFromCyclone(Header(0x10)));
  EXPECT_FALSE(IsFromCyclone(Header(0x0f)));
  EXPECT_FALSE(IsFromCyclone(Bytes{'R', 'T', 'P', 'S', 2, 3, 1, 0x10}));
}

TEST(RtpsDatagram, AnAnnouncementGetsATag) {
  const Bytes data = {0x15, 5, 36, 0};
  const Bytes longer = {0x15, 5, 48, 0};
  const Bytes after = {0x07, 1, 4, 0, 1, 2, 3, 4};
  EXPECT_EQ(WithDomainTag(Header(0x0f) + kTimestamp + data + kToAnnouncement + kParameters + after, "me"),
            Header(0x0f) + kTimestamp + longer + kToAnnouncement + Tagged() + after);
  const Bytes to_the_end = {0x15, 5, 0, 0};
  EXPECT_EQ(WithDomainTag(Header(0x0f) + to_the_end + kToAnnouncement + kParameters, "me"),
            Header(0x0f) + to_the_end + kToAnnouncement + Tagged());
}

TEST(RtpsDatagram, TheTagIsBehindInlineQos) {
  const Bytes inline_qos = {0x70, 0, 4, 0, 9, 9, 9, 9, 1, 0, 0, 0};
  const Bytes data = {0x15, 7, 48, 0};
  const Bytes longer = {0x15, 7, 60, 0};
  EXPECT_EQ(WithDomainTag(Header(0x0f) + data + kToAnnouncement + inline_qos + kParameters, "me"),
            Header(0x0f) + longer + kToAnnouncement + inline_qos + Tagged());
}

TEST(RtpsDatagram, OtherDatagramsStayAsTheyAre) {
  Bytes other_writer = kToAnnouncement;
  other_writer[11] = 0xc3;
  EXPECT_FALSE(WithDomainTag(Header(0x0f) + Bytes{0x15, 5, 36, 0} + other_writer + kParameters, "me"));
  EXPECT_FALSE(WithDomainTag(Header(0x0f) + kTimestamp, "me"));
  EXPECT_FALSE(WithDomainTag(Bytes(100, 1), "me"));
  EXPECT_FALSE(WithDomainTag({}, "me"));
}

// Every prefix, for bounds: sanitizers find a read beyond it.
TEST(RtpsDatagram, ATruncatedOneIsNotReadBeyondItsEnd) {
  for (const std::uint8_t flags : {5, 7}) {
    const Bytes whole = Header(0x0f) + kTimestamp + Bytes{0x15, flags, 36, 0} + kToAnnouncement + kParameters;
    for (std::size_t size = 0; size <= whole.size(); ++size) {
      const Bytes part(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size));
      const std::optional<Bytes> tagged = WithDomainTag(part, "me");
      if (tagged) {
        EXPECT_EQ(tagged->size(), size + kTag.size());
      }
    }
  }
}

}  // namespace
}  // namespace troupe::ros
