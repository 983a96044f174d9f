#include "ros/fast_dds/rtps_datagram.h"

#include <algorithm>
#include <array>
#include <cstddef>

namespace troupe::ros {
namespace {

// RTPS 2.5, sections 9.4 and 9.6.
constexpr std::size_t kRtpsHeader = 20;
constexpr std::size_t kSubmessageHeader = 4;
constexpr std::uint8_t kData = 0x15;
constexpr std::uint8_t kDataFragment = 0x16;
constexpr std::uint8_t kIsLittleEndian = 0x01;
constexpr std::uint8_t kHasInlineQos = 0x02;
constexpr std::uint8_t kHasPayload = 0x04;
constexpr std::array<std::uint8_t, 4> kAnnouncer = {0x00, 0x01, 0x00, 0xc2};
constexpr std::uint16_t kEndOfParameters = 0x0001;
constexpr std::uint16_t kDomainTag = 0x4014;

using Datagram = std::span<const std::uint8_t>;

bool IsRtps(Datagram datagram) {
  constexpr std::string_view kMagic = "RTPS";
  return datagram.size() >= kRtpsHeader && std::equal(kMagic.begin(), kMagic.end(), datagram.begin());
}

std::uint16_t ReadShort(Datagram datagram, std::size_t at, bool little_endian) {
  const unsigned first = datagram[at];
  const unsigned second = datagram[at + 1];
  return static_cast<std::uint16_t>(little_endian ? first | second << 8U : first << 8U | second);
}

void WriteNumber(Bytes& bytes, std::uint32_t value, std::size_t size, bool little_endian) {
  for (std::size_t i = 0; i < size; ++i) {
    bytes.push_back(static_cast<std::uint8_t>(value >> 8U * (little_endian ? i : size - 1 - i)));
  }
}

// The parameter, padded to a multiple of 4 bytes.
Bytes TagParameter(std::string_view tag, bool little_endian) {
  const std::size_t text = (tag.size() + 1 + 3) / 4 * 4;
  Bytes bytes;
  WriteNumber(bytes, kDomainTag, 2, little_endian);
  WriteNumber(bytes, static_cast<std::uint32_t>(4 + text), 2, little_endian);
  WriteNumber(bytes, static_cast<std::uint32_t>(tag.size() + 1), 4, little_endian);
  bytes.insert(bytes.end(), tag.begin(), tag.end());
  bytes.resize(8 + text, 0);
  return bytes;
}

// Behind the parameters that begin at `at`.
std::optional<std::size_t> EndOfParameters(Datagram datagram, std::size_t at, bool little_endian) {
  while (at + 4 <= datagram.size()) {
    const std::uint16_t id = ReadShort(datagram, at, little_endian);
    if (id == kEndOfParameters) return at + 4;
    at += 4U + ReadShort(datagram, at + 2, little_endian);
  }
  return std::nullopt;
}

// Where the announcement in the submessage begins, with its encoding; nothing if it is another submessage.
std::optional<std::size_t> FindAnnouncement(Datagram datagram, std::size_t submessage) {
  constexpr std::size_t kWriter = 12;
  const std::uint8_t flags = datagram[submessage + 1];
  const bool little_endian = (flags & kIsLittleEndian) != 0;
  if (datagram[submessage] != kData || (flags & kHasPayload) == 0) return std::nullopt;
  if (submessage + kWriter + kAnnouncer.size() > datagram.size() ||
      !std::equal(kAnnouncer.begin(), kAnnouncer.end(), datagram.begin() + submessage + kWriter)) {
    return std::nullopt;
  }
  std::optional<std::size_t> payload = submessage + 8U + ReadShort(datagram, submessage + 6, little_endian);
  if ((flags & kHasInlineQos) != 0) payload = EndOfParameters(datagram, *payload, little_endian);
  if (!payload || *payload + 4 > datagram.size()) return std::nullopt;
  return payload;
}

// What happens to a submessage.
enum class Verdict : std::uint8_t { kKeep, kLeaveOut, kDropAll };

Verdict KeepIf(bool is_safe) {
  return is_safe ? Verdict::kKeep : Verdict::kDropAll;
}

// The fields of a part of a datagram, one after another.
class Fields {
 public:
  Fields(Datagram bytes, bool little_endian) : bytes_(bytes), little_endian_(little_endian) {}

  // Of 1 to 4 bytes; 0 beyond the end.
  std::uint32_t Read(std::size_t size) {
    std::uint32_t value = 0;
    const std::size_t from = at_;
    if (!Skip(size)) return 0;
    for (std::size_t i = 0; i < size; ++i) {
      value |= std::uint32_t{bytes_[from + i]} << 8U * (little_endian_ ? i : size - 1 - i);
    }
    return value;
  }
  // Whether there is one, and it is from `least` on and not so large that one more would overflow.
  bool HasSequenceNumber(std::int64_t least, std::int64_t& number) {
    number = std::int64_t{static_cast<std::int32_t>(Read(4))} * (std::int64_t{1} << 32);
    number += Read(4);
    return ok_ && number >= least && number < std::int64_t{1} << 48;
  }
  // Behind its first number.
  bool HasBits() {
    const std::uint32_t bits = Read(4);
    return ok_ && bits <= 256 && Skip(std::size_t{(bits + 31) / 32} * 4);
  }
  // Ends with a zero, as Fast DDS reads it up to there.
  bool HasText() {
    const std::uint32_t size = Read(4);
    const std::size_t from = at_;
    return ok_ && size > 0 && size <= 256 && Skip(size) && bytes_[from + size - 1] == 0;
  }
  bool HasTexts() {
    bool has_all = true;
    for (std::uint32_t left = Read(4); ok_ && has_all && left > 0; --left) {
      has_all = HasText();
      at_ = std::min((at_ + 3) / 4 * 4, bytes_.size());
    }
    return ok_ && has_all;
  }
  bool Skip(std::size_t size) {
    ok_ = ok_ && size <= bytes_.size() - at_;
    if (ok_) at_ += size;
    return ok_;
  }
  bool ok() const { return ok_; }
  std::size_t at() const { return at_; }
  std::size_t left() const { return bytes_.size() - at_; }

 private:
  Datagram bytes_;
  bool little_endian_;
  std::size_t at_ = 0;
  bool ok_ = true;
};

constexpr std::uint16_t kText = 1;
constexpr std::uint16_t kTexts = 2;
constexpr std::uint16_t kLocator = 3;

// A parameter that Fast DDS may read, with its size in bytes, or kText, kTexts or kLocator.
struct Parameter {
  std::uint16_t id;
  std::uint16_t size;
};
constexpr Parameter kInlineParameters[] = {{0x70, 16}, {0x71, 4}, {0x800f, 24}};
// Identities, addresses and the QoS that are compared in matching. Not: users' data, types, tokens, filters.
constexpr Parameter kAnnouncedParameters[] = {
    {0x70, 16},       {0x15, 4},        {0x16, 4},        {0x50, 16},       {0x5a, 16},       {0x52, 16},
    {0x53, 4},        {0x02, 8},        {0x58, 4},        {0x77, 4},        {0x0f, 4},        {0x43, 4},
    {0x2f, kLocator}, {0x30, kLocator}, {0x31, kLocator}, {0x32, kLocator}, {0x33, kLocator}, {0x48, kLocator},
    {0x62, kText},    {0x05, kText},    {0x07, kText},    {0x29, kTexts},   {0x1d, 4},        {0x1e, 28},
    {0x23, 8},        {0x27, 8},        {0x1b, 12},       {0x1a, 12},       {0x2b, 8},        {0x25, 4},
    {0x40, 8},        {0x41, 12},       {0x1f, 4},        {0x06, 4},        {0x21, 8},        {0x04, 8},
    {0x49, 4},        {0x60, 4},        {0x8005, 4}};

bool HasContent(const Parameter& parameter, Datagram value, bool little_endian) {
  Fields fields(value, little_endian);
  if (parameter.size == kText) return fields.HasText();
  if (parameter.size == kTexts) return fields.HasTexts();
  if (parameter.size != kLocator) return value.size() == parameter.size;
  const std::uint32_t kind = fields.Read(4);
  const std::uint32_t port = fields.Read(4);
  return value.size() == 24 && kind == 1 && port > 0 && port <= 0xffff;  // of other transports than UDP it is of no use
}

// Makes padding of the parameters that are not `known`, or malformed. False: the list has no end.
bool CleanParameters(std::span<std::uint8_t> bytes, bool little_endian, std::span<const Parameter> known,
                     std::size_t& size) {
  std::size_t at = 0;
  for (;;) {
    if (at + 4 > bytes.size()) return false;
    const std::uint16_t id = ReadShort(bytes, at, little_endian);
    const std::size_t length = id == kEndOfParameters ? 0 : ReadShort(bytes, at + 2, little_endian);
    const Datagram value = Datagram(bytes).subspan(at + 4);
    if (length % 4 != 0 || length > value.size()) return false;
    const auto found = std::find_if(known.begin(), known.end(), [id](const Parameter& each) { return each.id == id; });
    const bool is_kept = found != known.end() && HasContent(*found, value.first(length), little_endian);
    at += 4 + length;
    if (id == kEndOfParameters) break;
    if (!is_kept) bytes[at - length - 4] = bytes[at - length - 3] = 0;
  }
  size = at;
  return true;
}

// The built-in writers to which Fast DDS listens, each with its reader: announcements of participants, writers and
// readers, and signs of life.
constexpr std::uint32_t kAnnouncers[][2] = {
    {0x000100c2, 0x000100c7}, {0x000003c2, 0x000003c7}, {0x000004c2, 0x000004c7}, {0x000200c2, 0x000200c7}};
constexpr std::uint32_t kSignsOfLife = 0x000200c2;

bool IsOfUser(std::uint32_t entity) {
  return (entity & 0xc0U) == 0;
}

std::uint32_t ReadEntity(Datagram bytes, std::size_t at) {
  return Fields(bytes.subspan(at), false).Read(4);
}

bool IsSafePayload(std::span<std::uint8_t> payload, std::uint32_t writer) {
  constexpr std::size_t kSignOfLife = 24;
  if (payload.size() < 4) return false;
  if (IsOfUser(writer)) return IsPlainCdr(payload);
  if (writer == kSignsOfLife) return IsPlainCdr(payload) && payload.size() >= kSignOfLife;
  std::size_t size = 0;
  return payload[0] == 0 && (payload[1] == 2 || payload[1] == 3) &&
         CleanParameters(payload.subspan(4), payload[1] == 3, kAnnouncedParameters, size);
}

// DATA, and DATA_FRAG, which has fields of a fragment behind the others. `bytes`: behind the header of the submessage.
Verdict JudgeData(std::span<std::uint8_t> bytes, std::uint8_t flags, bool is_fragment) {
  constexpr std::size_t kMaxSampleBytes = std::size_t{64} << 20;
  constexpr std::size_t kMinFragment = 16;
  constexpr std::uint8_t kDataHasKey = 0x08;
  constexpr std::uint8_t kFragmentHasKey = 0x04;
  const bool little_endian = (flags & kIsLittleEndian) != 0;
  Fields fields(bytes, little_endian);
  fields.Skip(2);
  if (fields.Read(2) != (is_fragment ? 28 : 16)) return Verdict::kDropAll;  // from behind it to inline QoS
  fields.Skip(8);
  std::int64_t number = 0;
  if (!fields.HasSequenceNumber(1, number)) return Verdict::kDropAll;
  const std::uint32_t reader = ReadEntity(bytes, 4);
  const std::uint32_t writer = ReadEntity(bytes, 8);
  const bool is_announced = std::any_of(std::begin(kAnnouncers), std::end(kAnnouncers), [&](const auto& pair) {
    return writer == pair[0] && (reader == pair[1] || reader == 0);
  });
  if (!(IsOfUser(writer) && IsOfUser(reader)) && (!is_announced || is_fragment)) return Verdict::kLeaveOut;

  const std::size_t first = fields.Read(is_fragment ? 4 : 0);  // from 1 on
  const std::size_t count = fields.Read(is_fragment ? 2 : 0);
  const std::size_t fragment = fields.Read(is_fragment ? 2 : 0);  // bytes
  const std::size_t sample = fields.Read(is_fragment ? 4 : 0);    // bytes
  if (!fields.ok()) return Verdict::kDropAll;
  std::span<std::uint8_t> payload = bytes.subspan(fields.at());
  if ((flags & kHasInlineQos) != 0) {
    std::size_t size = 0;
    if (!CleanParameters(payload, little_endian, kInlineParameters, size)) return Verdict::kDropAll;
    payload = payload.subspan(size);
  }
  if (is_fragment) {
    if ((flags & kFragmentHasKey) != 0 || first == 0 || count == 0 || fragment < kMinFragment ||
        sample > kMaxSampleBytes || (first - 1) * fragment >= sample) {
      return Verdict::kDropAll;
    }
    const std::size_t expected = std::min(count * fragment, sample - (first - 1) * fragment);
    const bool is_whole =
        payload.size() >= expected && payload.size() < expected + 4 && (first + count - 2) * fragment < sample;
    return KeepIf(is_whole && (first > 1 || IsPlainCdr(payload)));
  }
  const bool has_key = (flags & kDataHasKey) != 0;
  if ((flags & kHasPayload) == 0) return KeepIf(!has_key || payload.size() >= 4);
  return KeepIf(!has_key && IsSafePayload(payload, writer));
}

Verdict JudgeGap(Fields& fields) {
  constexpr std::int64_t kMaxNumbers = 1 << 17;
  std::int64_t from = 0;
  std::int64_t to = 0;
  return KeepIf(fields.Skip(8) && fields.HasSequenceNumber(1, from) && fields.HasSequenceNumber(1, to) && to >= from &&
                to - from <= kMaxNumbers && fields.HasBits());
}

Verdict JudgeHeartbeat(Fields& fields) {
  std::int64_t first = 0;
  std::int64_t last = 0;
  return KeepIf(fields.Skip(8) && fields.HasSequenceNumber(1, first) && fields.HasSequenceNumber(0, last) &&
                last >= first - 1 && fields.Skip(4));
}

Verdict JudgeAcknowledgement(Fields& fields) {
  std::int64_t base = 0;
  return KeepIf(fields.Skip(8) && fields.HasSequenceNumber(0, base) && fields.HasBits() && fields.Skip(4));
}

Verdict JudgeMissingFragments(Fields& fields) {
  std::int64_t number = 0;
  return KeepIf(fields.Skip(8) && fields.HasSequenceNumber(1, number) && fields.Read(4) > 0 && fields.HasBits() &&
                fields.Skip(4));
}

// `bytes`: behind its header. RTPS 2.5, table 9.13.
Verdict Judge(std::uint8_t kind, std::uint8_t flags, std::span<std::uint8_t> bytes) {
  constexpr std::uint8_t kHasNoTime = 0x02;
  Fields fields(bytes, (flags & kIsLittleEndian) != 0);
  switch (kind) {
    case 0x06:
      return JudgeAcknowledgement(fields);
    case 0x07:
      return JudgeHeartbeat(fields);
    case 0x08:
      return JudgeGap(fields);
    case 0x09:
      return KeepIf((flags & kHasNoTime) != 0 || bytes.size() >= 8);
    case 0x0c:  // what follows is of another participant, which could be one on Cyclone DDS
      return Verdict::kDropAll;
    case 0x0e:
      return KeepIf(bytes.size() >= 12);
    case 0x12:
      return JudgeMissingFragments(fields);
    case kData:
      return JudgeData(bytes, flags, false);
    case kDataFragment:
      return JudgeData(bytes, flags, true);
    default:
      return Verdict::kLeaveOut;
  }
}

constexpr std::size_t kEncoding = 4;
constexpr std::size_t kHeader = 16;

bool IsLittleEndian(std::span<const std::uint8_t> sample) {
  return sample[1] == 1;
}

void Append(Bytes& bytes, std::uint64_t value, bool little_endian) {
  for (unsigned i = 0; i < 8; ++i) {
    bytes.push_back(static_cast<std::uint8_t>(value >> 8U * (little_endian ? i : 7 - i)));
  }
}

std::uint64_t ReadNumber(std::span<const std::uint8_t> bytes, bool little_endian) {
  std::uint64_t value = 0;
  for (unsigned i = 0; i < 8; ++i) value |= std::uint64_t{bytes[i]} << 8U * (little_endian ? i : 7 - i);
  return value;
}

}  // namespace

std::optional<Bytes> SafeParts(Datagram datagram) {
  constexpr std::uint8_t kTimestamp = 0x09;
  constexpr std::uint8_t kPadding = 0x01;
  if (!IsRtps(datagram) || datagram[4] != 2) return std::nullopt;
  Bytes parts(datagram.begin(), datagram.begin() + kRtpsHeader);
  for (std::size_t at = kRtpsHeader; at < datagram.size();) {
    const Datagram rest = datagram.subspan(at);
    if (rest.size() < kSubmessageHeader) return std::nullopt;
    const std::uint8_t kind = rest[0];
    const std::uint8_t flags = rest[1];
    std::size_t length = ReadShort(rest, 2, (flags & kIsLittleEndian) != 0);
    if (length == 0 && kind != kTimestamp && kind != kPadding) length = rest.size() - kSubmessageHeader;
    const bool is_last = kSubmessageHeader + length == rest.size();
    if (kSubmessageHeader + length > rest.size() || (length % 4 != 0 && !is_last)) return std::nullopt;
    const Datagram submessage = rest.first(kSubmessageHeader + length);
    const std::size_t kept = parts.size();
    parts.insert(parts.end(), submessage.begin(), submessage.end());
    const Verdict verdict = Judge(kind, flags, std::span(parts).subspan(kept + kSubmessageHeader));
    if (verdict == Verdict::kDropAll) return std::nullopt;
    if (verdict == Verdict::kLeaveOut) parts.resize(kept);
    at += submessage.size();
  }
  if (parts.size() == kRtpsHeader) return std::nullopt;
  return parts;
}

bool IsFromCyclone(Datagram datagram) {
  return IsRtps(datagram) && datagram[6] == 0x01 && datagram[7] == 0x10;
}

std::optional<Bytes> WithDomainTag(Datagram datagram, std::string_view tag) {
  if (!IsRtps(datagram)) return std::nullopt;
  std::size_t submessage = kRtpsHeader;
  while (submessage + kSubmessageHeader <= datagram.size()) {
    const bool little_endian = (datagram[submessage + 1] & kIsLittleEndian) != 0;
    const std::uint16_t length = ReadShort(datagram, submessage + 2, little_endian);
    if (const auto announcement = FindAnnouncement(datagram, submessage)) {
      const std::size_t parameters = *announcement + 4;
      const Bytes added = TagParameter(tag, datagram[*announcement + 1] == 3);
      Bytes tagged(datagram.begin(), datagram.begin() + static_cast<std::ptrdiff_t>(parameters));
      tagged.insert(tagged.end(), added.begin(), added.end());
      tagged.insert(tagged.end(), datagram.begin() + static_cast<std::ptrdiff_t>(parameters), datagram.end());
      if (length != 0) {  // 0: to the end of the datagram
        Bytes field;
        WriteNumber(field, static_cast<std::uint32_t>(length + added.size()), 2, little_endian);
        std::copy(field.begin(), field.end(), tagged.begin() + static_cast<std::ptrdiff_t>(submessage + 2));
      }
      return tagged;
    }
    if (length == 0) return std::nullopt;
    submessage += kSubmessageHeader + length;
  }
  return std::nullopt;
}

bool IsPlainCdr(std::span<const std::uint8_t> sample) {
  return sample.size() >= kEncoding && sample[0] == 0 && sample[1] <= 1;
}

// The header is a multiple of 8 bytes, so that no value behind it changes its alignment.
std::optional<Bytes> WithHeader(std::span<const std::uint8_t> sample, const CallHeader& header) {
  if (!IsPlainCdr(sample)) return std::nullopt;
  const bool little_endian = IsLittleEndian(sample);
  Bytes bytes;
  bytes.reserve(sample.size() + kHeader);
  bytes.assign(sample.begin(), sample.begin() + kEncoding);
  Append(bytes, header.client_guid, little_endian);
  Append(bytes, static_cast<std::uint64_t>(header.sequence_number), little_endian);
  bytes.insert(bytes.end(), sample.begin() + kEncoding, sample.end());
  return bytes;
}

std::optional<HeadedSample> SplitHeader(std::span<const std::uint8_t> sample) {
  if (!IsPlainCdr(sample) || sample.size() < kEncoding + kHeader) return std::nullopt;
  const bool little_endian = IsLittleEndian(sample);
  HeadedSample split;
  split.header.client_guid = ReadNumber(sample.subspan(kEncoding), little_endian);
  split.header.sequence_number = static_cast<std::int64_t>(ReadNumber(sample.subspan(kEncoding + 8), little_endian));
  split.sample.assign(sample.begin(), sample.begin() + kEncoding);
  split.sample.insert(split.sample.end(), sample.begin() + kEncoding + kHeader, sample.end());
  return split;
}

}  // namespace troupe::ros
