#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "ros/fast_dds/pending_calls.h"
#include "ros/fast_dds/rtps_datagram.h"

namespace troupe::ros {
namespace {

TEST(CallHeader, IsPutBehindTheEncodingInItsByteOrder) {
  const Bytes little = {0, 1, 0, 0, 9, 8};
  EXPECT_EQ(WithHeader(little, {0x0102030405060708, 5}),
            (Bytes{0, 1, 0, 0, 8, 7, 6, 5, 4, 3, 2, 1, 5, 0, 0, 0, 0, 0, 0, 0, 9, 8}));
  const Bytes big = {0, 0, 0, 0, 9, 8};
  EXPECT_EQ(WithHeader(big, {0x0102030405060708, 5}),
            (Bytes{0, 0, 0, 0, 1, 2, 3, 4, 5, 6, 7, 8, 0, 0, 0, 0, 0, 0, 0, 5, 9, 8}));
}

TEST(CallHeader, IsSplitFromASample) {
  for (const std::uint8_t order : {0, 1}) {
    const Bytes sample = {0, order, 0, 2, 7, 7, 7};
    const std::optional<Bytes> headed = WithHeader(sample, {0xfedcba9876543210, -2});
    ASSERT_TRUE(headed);
    const std::optional<HeadedSample> split = SplitHeader(*headed);
    ASSERT_TRUE(split);
    EXPECT_EQ(split->header.client_guid, 0xfedcba9876543210);
    EXPECT_EQ(split->header.sequence_number, -2);
    EXPECT_EQ(split->sample, sample);
  }
}

TEST(CallHeader, AnotherEncodingOrAShortSampleHasNone) {
  EXPECT_FALSE(WithHeader(Bytes{}, {}));
  EXPECT_FALSE(WithHeader(Bytes{0, 1, 0}, {}));
  EXPECT_FALSE(WithHeader(Bytes{0, 3, 0, 0, 1}, {})) << "a parameter list";
  EXPECT_FALSE(WithHeader(Bytes{1, 1, 0, 0, 1}, {}));
  EXPECT_FALSE(SplitHeader(Bytes(19, 0)));
  EXPECT_TRUE(SplitHeader(Bytes(20, 0)));
}

using std::chrono::seconds;
using Calls = PendingCalls<int>;

const Bytes kRequest = {0, 1, 0, 0};

class PendingCallsTest : public testing::Test {
 protected:
  // The numbers of the calls that are sent now.
  std::vector<std::int64_t> Send() {
    std::vector<std::int64_t> sent;
    calls_.SendReady([this](int) { return can_respond_; },
                     [&](std::int64_t number, const Bytes& request) {
                       EXPECT_EQ(request, kRequest);
                       sent.push_back(number);
                     });
    return sent;
  }

  Calls calls_;
  Calls::Time start_{};
  bool can_respond_ = true;
};

TEST_F(PendingCallsTest, EachCallerGetsOneResponse) {
  calls_.Add(1, {1, 10}, kRequest, start_);
  calls_.Add(2, {2, 20}, kRequest, start_);
  EXPECT_EQ(Send(), (std::vector<std::int64_t>{1, 2}));
  EXPECT_TRUE(Send().empty());
  const auto second = calls_.RemoveCaller(2);
  ASSERT_TRUE(second);
  EXPECT_EQ(second->endpoint, 2);
  EXPECT_EQ(second->number, 20);
  EXPECT_FALSE(calls_.RemoveCaller(2));
  EXPECT_TRUE(calls_.RemoveCaller(1));
  EXPECT_FALSE(calls_.RemoveCaller(3));
}

TEST_F(PendingCallsTest, ACallWaitsForTheReaderOfItsClient) {
  can_respond_ = false;
  calls_.Add(1, {1, 1}, kRequest, start_);
  EXPECT_TRUE(Send().empty());
  can_respond_ = true;
  EXPECT_EQ(Send(), std::vector<std::int64_t>{1});
  can_respond_ = false;
  calls_.Add(2, {1, 2}, kRequest, start_);
  calls_.RemoveCaller(1);
  calls_.Add(3, {2, 3}, kRequest, start_ + Calls::kWaitForReader);
  can_respond_ = true;
  EXPECT_EQ(Send(), std::vector<std::int64_t>{3}) << "the other client has no reader";
}

TEST_F(PendingCallsTest, IsBounded) {
  for (std::size_t i = 1; i <= 2 * Calls::kMaxCalls; ++i) {
    calls_.Add(static_cast<std::int64_t>(i), {1, 1}, kRequest, start_);
  }
  EXPECT_EQ(calls_.size(), Calls::kMaxCalls);
  EXPECT_FALSE(calls_.RemoveCaller(1));
  EXPECT_TRUE(calls_.RemoveCaller(Calls::kMaxCalls + 1));
  const Bytes large(Calls::kMaxBytes / 2, 1);
  for (int i = 1; i <= 10; ++i) calls_.Add(10'000 + i, {1, 1}, large, start_);
  EXPECT_LE(calls_.size(), 2u);
  calls_.Forget(1);
  EXPECT_EQ(calls_.size(), 0u);
}

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
// The start of the data of an announcement, in little endian, without its length.
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

Bytes Submessage(std::uint8_t kind, std::uint8_t flags, const Bytes& body) {
  return Bytes{kind, flags, static_cast<std::uint8_t>(body.size()), 0} + body;
}
Bytes Sequence(std::int32_t high, std::uint32_t low) {
  Bytes bytes;
  for (const std::uint32_t word : {static_cast<std::uint32_t>(high), low}) {
    for (unsigned i = 0; i < 4; ++i) bytes.push_back(static_cast<std::uint8_t>(word >> 8U * i));
  }
  return bytes;
}
bool IsSafe(const Bytes& submessage) {
  const Bytes datagram = Header(0x0f) + submessage;
  const std::optional<Bytes> parts = SafeParts(datagram);
  return parts && *parts == datagram;
}
const Bytes kEntities = {0, 0, 1, 7, 0, 0, 1, 2};  // a reader and a writer
const Bytes kCount = {1, 0, 0, 0};

TEST(SafeParts, StatisticsAndKindsThatNoClientNeedsAreLeftOut) {
  const Bytes heartbeat = Submessage(0x07, 1, kEntities + Sequence(0, 1) + Sequence(0, 9) + kCount);
  EXPECT_TRUE(IsSafe(kTimestamp + heartbeat));
  for (const std::uint8_t kind : {0x00, 0x01, 0x0d, 0x0f, 0x13, 0x30, 0x80, 0x81, 0xff}) {
    const Bytes other = Submessage(kind, 1, Bytes(56, 0));
    EXPECT_EQ(SafeParts(Header(0x0f) + other + heartbeat), Header(0x0f) + heartbeat) << int{kind};
    EXPECT_EQ(SafeParts(Header(0x0f) + other + Bytes{0, 0, 0, 0}), std::nullopt) << int{kind};
  }
  EXPECT_EQ(SafeParts(Header(0x0f)), std::nullopt);
  EXPECT_EQ(SafeParts(Bytes(100, 1)), std::nullopt);
}

TEST(SafeParts, SequenceNumbersAreInRange) {
  const auto heartbeat = [](const Bytes& first, const Bytes& last) {
    return Submessage(0x07, 1, kEntities + first + last + kCount);
  };
  EXPECT_TRUE(IsSafe(heartbeat(Sequence(0, 1), Sequence(0, 0))));
  EXPECT_FALSE(IsSafe(heartbeat(Sequence(0, 0), Sequence(-1, 5))));
  EXPECT_FALSE(IsSafe(heartbeat(Sequence(0, 5), Sequence(0, 3))));
  EXPECT_FALSE(IsSafe(heartbeat(Sequence(0, 1), Sequence(0x7fffffff, 0xffffffff))));
  const auto gap = [](const Bytes& from, const Bytes& to) {
    return Submessage(0x08, 1, kEntities + from + to + Bytes(4, 0));
  };
  EXPECT_TRUE(IsSafe(gap(Sequence(0, 1), Sequence(0, 1000))));
  EXPECT_FALSE(IsSafe(gap(Sequence(0, 1), Sequence(1, 0)))) << "it would be counted one by one";
  EXPECT_FALSE(IsSafe(gap(Sequence(0, 9), Sequence(0, 1))));
  const auto acknowledgement = [](const Bytes& bits) {
    return Submessage(0x06, 1, kEntities + Sequence(0, 0) + bits + kCount);
  };
  EXPECT_TRUE(IsSafe(acknowledgement({0, 0, 0, 0})));
  EXPECT_TRUE(IsSafe(acknowledgement({33, 0, 0, 0, 1, 2, 3, 4, 5, 6, 7, 8})));
  EXPECT_FALSE(IsSafe(acknowledgement({0xff, 0xff, 0xff, 0xff})));
}

TEST(SafeParts, AnnouncementsKeepTheParametersThatAreKnown) {
  const auto announcement = [](const Bytes& parameters) {
    const Bytes body = kToAnnouncement + Bytes{0, 3, 0, 0} + parameters;
    return Header(0x0f) + Submessage(0x15, 5, body);
  };
  const Bytes version = {0x15, 0, 4, 0, 2, 3, 0, 0};
  const Bytes end = {1, 0, 0, 0};
  EXPECT_EQ(SafeParts(announcement(version + kTag + end)),
            announcement(version + Bytes{0, 0, 8, 0, 3, 0, 0, 0, 'm', 'e', 0, 0} + end));
  const Bytes udp = Bytes{0x32, 0, 24, 0, 1, 0, 0, 0, 0xf2, 0x1c, 0, 0} + Bytes(16, 9);
  EXPECT_EQ(SafeParts(announcement(udp + end)), announcement(udp + end));
  EXPECT_EQ(SafeParts(announcement(version)), std::nullopt) << "without an end";
  EXPECT_EQ(SafeParts(announcement(Bytes{0x05, 0, 200, 0, 1, 0, 0, 0, 0, 0, 0, 0} + end)), std::nullopt);
  const Bytes name = {0x05, 0, 8, 0, 4, 0, 0, 0, 'a', 'b', 'c', 0};
  EXPECT_EQ(SafeParts(announcement(name + end)), announcement(name + end));
  const Bytes malformed[] = {{0x15, 0, 8, 0, 2, 3, 0, 0, 0, 0, 0, 0},
                             {0x05, 0, 8, 0, 4, 0, 0, 0, 'a', 'b', 'c', 'd'},
                             {0x05, 0, 8, 0, 0xff, 0xff, 0xff, 0xff, 'a', 0, 0, 0},
                             {0x29, 0, 8, 0, 2, 0, 0, 0, 9, 0, 0, 0},
                             {0x32, 0, 8, 0, 1, 0, 0, 0, 0xf2, 0x1c, 0, 0}};
  for (const Bytes& parameter : malformed) {
    Bytes padding = parameter;
    padding[0] = 0;
    EXPECT_EQ(SafeParts(announcement(parameter + end)), announcement(padding + end));
  }
}

TEST(SafeParts, SamplesOfUsersAreInTheEncodingOfRos) {
  const Bytes head = Bytes{0, 0, 16, 0} + kEntities + Sequence(0, 1);
  EXPECT_TRUE(IsSafe(Submessage(0x15, 5, head + Bytes{0, 1, 0, 0, 7, 0, 0, 0})));
  EXPECT_FALSE(IsSafe(Submessage(0x15, 5, head + Bytes{0, 3, 0, 0, 7, 0, 0, 0}))) << "a list of parameters";
  EXPECT_FALSE(IsSafe(Submessage(0x15, 5, head)));
  const Bytes identity = Bytes{0x0f, 0x80, 24, 0} + Bytes(24, 7);
  EXPECT_TRUE(IsSafe(Submessage(0x15, 7, head + identity + Bytes{1, 0, 0, 0} + Bytes{0, 1, 0, 0, 7, 0, 0, 0})));
  Bytes far = head;
  far[2] = 0xf0;
  EXPECT_FALSE(IsSafe(Submessage(0x15, 5, far + Bytes{0, 1, 0, 0})));
  const auto fragment = [](std::uint8_t first, std::uint8_t size, std::uint8_t sample, std::size_t payload) {
    const Bytes fields = {first, 0, 0, 0, 1, 0, size, 0, sample, 0, 0, 0};
    return Submessage(0x16, 1, Bytes{0, 0, 28, 0} + kEntities + Sequence(0, 1) + fields + Bytes(payload, 0));
  };
  EXPECT_TRUE(IsSafe(fragment(1, 32, 40, 32)));
  EXPECT_TRUE(IsSafe(fragment(2, 32, 40, 8)));
  EXPECT_FALSE(IsSafe(fragment(3, 32, 40, 8)));
  EXPECT_FALSE(IsSafe(fragment(1, 0, 40, 32)));
  EXPECT_FALSE(IsSafe(fragment(1, 32, 40, 16)));
}

// Every prefix, for bounds: sanitizers find a read beyond it.
TEST(RtpsDatagram, ATruncatedOneIsNotReadBeyondItsEnd) {
  for (const std::uint8_t flags : {5, 7}) {
    const Bytes whole = Header(0x0f) + kTimestamp + Bytes{0x15, flags, 36, 0} + kToAnnouncement + kParameters;
    for (std::size_t size = 0; size <= whole.size(); ++size) {
      const Bytes part(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size));
      SafeParts(part);
      const std::optional<Bytes> tagged = WithDomainTag(part, "me");
      if (tagged) {
        EXPECT_EQ(tagged->size(), size + kTag.size());
      }
    }
  }
}

}  // namespace
}  // namespace troupe::ros
