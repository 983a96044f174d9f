// Reads CDR in place of Cyclone DDS, of which the module has the headers alone: from the instructions that idlc
// generates for a type. Of these, the types in idl/ use few: numbers, texts, sequences and structures.
#include <dds/ddsc/dds_opcodes.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <optional>
#include <string>

#include "common/base/bytes.h"
#include "transport/wire/cdr.h"

namespace troupe::wire {
namespace {

constexpr std::size_t kHeaderSize = 4;
constexpr std::byte kLittleEndianCdr{1};
constexpr std::size_t kAlignment = 4;

// As idlc declares all sequences.
struct Sequence {
  std::uint32_t maximum;
  std::uint32_t length;
  std::uint8_t* buffer;
  bool release;
};

// Nothing: the type is no number.
std::optional<std::size_t> SizeOfNumber(std::uint32_t type) {
  switch (type) {
    case DDS_OP_VAL_1BY:
    case DDS_OP_VAL_BLN:
      return 1;
    case DDS_OP_VAL_2BY:
      return 2;
    case DDS_OP_VAL_4BY:
      return 4;
    case DDS_OP_VAL_8BY:
      return 8;
    default:
      return std::nullopt;
  }
}

// One instruction: a member of a structure.
struct Member {
  explicit Member(const std::uint32_t* ops)
      : type(DDS_OP_TYPE(*ops)), subtype(DDS_OP_SUBTYPE(*ops)), offset(ops[1]), next(ops + 2) {
    if (type == DDS_OP_VAL_EXT) {
      content = ops + DDS_OP_ADR_JSR(ops[2]);
      next = ops + DDS_OP_ADR_JMP(ops[2]);
    } else if (type == DDS_OP_VAL_SEQ && subtype == DDS_OP_VAL_STU) {
      element_size = ops[2];
      content = ops + DDS_OP_ADR_JSR(ops[3]);
      const std::uint32_t jump = DDS_OP_ADR_JMP(ops[3]);
      next = ops + (jump != 0 ? jump : 4);
    }
  }

  std::uint32_t type;
  std::uint32_t subtype;  // of the elements of a sequence
  std::uint32_t offset;
  const std::uint32_t* content = nullptr;  // the instructions of a structure
  std::size_t element_size = 0;
  const std::uint32_t* next;
};

bool IsEnd(const std::uint32_t* ops) {
  return DDS_OP(*ops) == DDS_OP_RTS;
}

// What ReadStructure has allocated, of a sample that is whole or zero from some member on.
void Free(const std::uint32_t* ops, std::uint8_t* sample) {
  for (; !IsEnd(ops); ops = Member(ops).next) {
    const Member member(ops);
    std::uint8_t* const at = sample + member.offset;
    if (member.type == DDS_OP_VAL_STR) std::free(*reinterpret_cast<char**>(at));
    if (member.type == DDS_OP_VAL_EXT) Free(member.content, at);
    if (member.type != DDS_OP_VAL_SEQ) continue;
    const auto& sequence = *reinterpret_cast<const Sequence*>(at);
    if (!sequence.release) continue;
    for (std::uint32_t i = 0; i < sequence.length; ++i) {
      if (member.subtype == DDS_OP_VAL_STR) std::free(reinterpret_cast<char**>(sequence.buffer)[i]);
      if (member.subtype == DDS_OP_VAL_STU) Free(member.content, sequence.buffer + i * member.element_size);
    }
    std::free(sequence.buffer);
  }
}

// Stops at the first problem.
// The bytes may be those of a damaged file: each length is checked before it is used.
class Reader {
 public:
  explicit Reader(std::span<const std::byte> bytes) : in_(bytes), size_(bytes.size()) {}

  bool failed() const { return is_nonsense_ || !in_.ok(); }
  std::size_t left() const { return in_.remaining(); }

  void ReadStructure(const std::uint32_t* ops, std::uint8_t* sample) {
    for (; !failed() && !IsEnd(ops); ops = Member(ops).next) {
      const Member member(ops);
      std::uint8_t* const at = sample + member.offset;
      if (const std::optional<std::size_t> size = SizeOfNumber(member.type)) {
        ReadNumbers(at, *size, 1, member.type == DDS_OP_VAL_BLN);
      } else if (member.type == DDS_OP_VAL_STR) {
        *reinterpret_cast<char**>(at) = ReadText();
      } else if (member.type == DDS_OP_VAL_EXT) {
        ReadStructure(member.content, at);
      } else if (member.type == DDS_OP_VAL_SEQ) {
        ReadSequence(member, *reinterpret_cast<Sequence*>(at));
      } else {
        is_nonsense_ = true;
      }
    }
  }

 private:
  // Numbers are aligned to their size, counted from the first byte.
  void ReadNumbers(std::uint8_t* to, std::size_t size, std::size_t count, bool is_flag) {
    const std::size_t at = size_ - in_.remaining();
    in_.ReadBytes((size - at % size) % size);
    const std::span<const std::byte> bytes = in_.ReadBytes(std::uint64_t{size} * count);
    if (!bytes.empty()) std::memcpy(to, bytes.data(), bytes.size());
    if (is_flag) is_nonsense_ = is_nonsense_ || std::any_of(bytes.begin(), bytes.end(), IsNoFlag);
  }

  static bool IsNoFlag(std::byte byte) { return byte > std::byte{1}; }

  std::uint32_t ReadCount() {
    std::uint32_t count = 0;
    ReadNumbers(reinterpret_cast<std::uint8_t*>(&count), sizeof count, 1, false);
    return count;
  }

  char* ReadText() {
    const std::span<const std::byte> bytes = in_.ReadBytes(ReadCount());  // with the zero at the end
    is_nonsense_ = is_nonsense_ || bytes.empty() || bytes.back() != std::byte{0};
    if (failed()) return nullptr;
    auto* const text = static_cast<char*>(std::malloc(bytes.size()));
    std::memcpy(text, bytes.data(), bytes.size());
    return text;
  }

  void ReadSequence(const Member& member, Sequence& sequence) {
    const std::uint32_t count = ReadCount();
    if (failed() || count == 0) return;
    const std::optional<std::size_t> number = SizeOfNumber(member.subtype);
    const bool is_text = member.subtype == DDS_OP_VAL_STR;
    const std::size_t size = number ? *number : is_text ? sizeof(char*) : member.element_size;
    // Each element takes a byte at least.
    if (size == 0 || count > left()) {
      is_nonsense_ = true;
      return;
    }
    sequence.buffer = static_cast<std::uint8_t*>(std::calloc(count, size));
    sequence.length = sequence.maximum = count;
    sequence.release = true;
    if (number) return ReadNumbers(sequence.buffer, size, count, member.subtype == DDS_OP_VAL_BLN);
    for (std::uint32_t i = 0; i < count && !failed(); ++i) {
      std::uint8_t* const element = sequence.buffer + i * size;
      if (is_text) {
        *reinterpret_cast<char**>(element) = ReadText();
      } else {
        ReadStructure(member.content, element);
      }
    }
  }

  ByteReader in_;
  std::size_t size_;  // of all bytes
  bool is_nonsense_ = false;
};

}  // namespace

Status SampleFromCdr(std::span<const std::byte> bytes, const dds_topic_descriptor_t& descriptor, void* sample) {
  const auto malformed = [&](const char* problem) {
    return Error{{}, std::string("bytes of a ") + descriptor.m_typename + ": " + problem};
  };
  if (bytes.size() < kHeaderSize || bytes[0] != std::byte{0} || bytes[1] != kLittleEndianCdr) {
    return malformed("found another representation, expected plain CDR, little-endian");
  }
  const std::size_t padding = std::to_integer<std::size_t>(bytes[3]) % kAlignment;
  bytes = bytes.subspan(kHeaderSize);
  if (padding > bytes.size()) return malformed("found more padding than bytes");
  Reader reader(bytes.first(bytes.size() - padding));
  auto* const at = static_cast<std::uint8_t*>(sample);
  reader.ReadStructure(descriptor.m_ops, at);
  if (!reader.failed() && reader.left() == 0) return {};
  Free(descriptor.m_ops, at);
  std::memset(sample, 0, descriptor.m_size);
  return malformed(reader.failed() ? "found one that ends early or has a field that makes no sense"
                                   : "found more after its end");
}

}  // namespace troupe::wire

extern "C" void dds_sample_free(void* sample, const dds_topic_descriptor_t* descriptor, dds_free_op_t /*op*/) {
  troupe::wire::Free(descriptor->m_ops, static_cast<std::uint8_t*>(sample));
}
