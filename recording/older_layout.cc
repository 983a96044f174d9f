#include "recording/older_layout.h"

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string_view>
#include <tuple>
#include <utility>

namespace troupe {

// A type of a field: a number, a text or a struct, or a sequence of one.
struct LayoutType {
  std::size_t size = 0;  // bytes of a number; 0: no number
  bool is_text = false;
  bool is_sequence = false;
  std::string name;  // of the number or the struct
  const LayoutChange::Struct* fields = nullptr;
};

struct LayoutChange::Struct {
  struct Field {
    std::string name;
    LayoutType type;
  };
  std::vector<Field> fields;

  const Field* Find(const std::string& name) const {
    for (const Field& field : fields) {
      if (field.name == name) return &field;
    }
    return nullptr;
  }
};

namespace {

using Struct = LayoutChange::Struct;
using Types = std::map<std::string, std::unique_ptr<Struct>>;

Error UnknownLayout(const std::string& problem) {
  return {{}, "found the schema of a message that cannot be read: " + problem};
}

// Words and signs, without comments, directives and annotations.
std::vector<std::string> WordsOf(std::string_view text) {
  std::vector<std::string> words;
  const auto is_letter = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; };
  for (std::size_t i = 0; i < text.size();) {
    if (text[i] == '#' || text.substr(i, 2) == "//") {
      while (i < text.size() && text[i] != '\n') ++i;
    } else if (text[i] == '@') {
      for (++i; i < text.size() && is_letter(text[i]);) ++i;
      if (i < text.size() && text[i] == '(') i = std::min(text.find(')', i), text.size() - 1) + 1;
    } else if (is_letter(text[i])) {
      const std::size_t begin = i;
      while (i < text.size() && is_letter(text[i])) ++i;
      words.emplace_back(text.substr(begin, i - begin));
    } else {
      if (std::isspace(static_cast<unsigned char>(text[i])) == 0) words.emplace_back(1, text[i]);
      ++i;
    }
  }
  return words;
}

std::size_t SizeOfNumber(const std::string& name) {
  if (name == "octet" || name == "boolean") return 1;
  if (name == "long" || name == "unsigned long" || name == "float") return 4;
  return name == "long long" || name == "unsigned long long" || name == "double" ? 8 : 0;
}

// The structs of a text; a struct comes before those that use it.
class IdlParser {
 public:
  explicit IdlParser(const std::string& text) : words_(WordsOf(text)) {}

  Result<std::shared_ptr<const Types>> Parse() {
    auto types = std::make_shared<Types>();
    while (at_ < words_.size()) {
      if (Take("module")) {
        ++at_;  // its name; all are in one
      } else if (Take("struct")) {
        const std::string name = Next();
        auto made = std::make_unique<Struct>();
        if (!Take("{")) return UnknownLayout("struct " + name);
        while (at_ < words_.size() && !Take("}")) {
          std::optional<LayoutType> type = ParseType(*types);
          if (!type) return UnknownLayout("a field of " + name);
          made->fields.push_back({Next(), std::move(*type)});
          if (!Take(";")) return UnknownLayout("field " + made->fields.back().name + " of " + name);
        }
        types->emplace(name, std::move(made));
      } else if (!Take("{") && !Take("}") && !Take(";")) {
        return UnknownLayout("'" + words_[at_] + "'");
      }
    }
    return std::shared_ptr<const Types>(std::move(types));
  }

 private:
  bool Take(std::string_view word) {
    if (at_ >= words_.size() || words_[at_] != word) return false;
    ++at_;
    return true;
  }
  std::string Next() { return at_ < words_.size() ? words_[at_++] : std::string(); }

  std::optional<LayoutType> ParseType(const Types& types) {
    LayoutType type;
    if (Take("sequence")) {
      if (!Take("<")) return std::nullopt;
      std::optional<LayoutType> element = ParseType(types);
      if (!element || element->is_sequence || !Take(">")) return std::nullopt;
      type = std::move(*element);
      type.is_sequence = true;
      return type;
    }
    type.name = Next();
    if (type.name == "unsigned") type.name += " " + Next();
    if (type.name.ends_with("long") && Take("long")) type.name += " long";
    type.size = SizeOfNumber(type.name);
    type.is_text = type.name == "string";
    if (type.size > 0 || type.is_text) return type;
    const auto found = types.find(type.name);
    if (found == types.end()) return std::nullopt;
    type.fields = found->second.get();
    return type;
  }

  std::vector<std::string> words_;
  std::size_t at_ = 0;
};

// Success if the fields that both have are of the same types.
Status Compare(const Struct& from, const Struct& to) {
  for (const Struct::Field& field : to.fields) {
    const Struct::Field* const old = from.Find(field.name);
    if (old == nullptr) continue;
    if (old->type.is_sequence != field.type.is_sequence || old->type.name != field.type.name) {
      return UnknownLayout("field " + field.name + " has another type");
    }
    if (field.type.fields == nullptr) continue;
    if (Status status = Compare(*old->type.fields, *field.type.fields); !status.ok()) return status;
  }
  return {};
}

// Reads a sample of the one layout and writes it in the other. Stops at the first problem.
class Copier {
 public:
  explicit Copier(std::span<const std::byte> bytes) : bytes_(bytes) {}

  bool failed() const { return failed_; }
  std::size_t left() const { return bytes_.size() - at_; }
  std::vector<std::byte> Release() { return std::move(out_); }

  void Copy(const Struct& from, const Struct& to) {
    std::vector<std::size_t> places;
    const std::size_t begin = at_;
    for (const Struct::Field& field : from.fields) {
      places.push_back(at_);
      Skip(field.type);
    }
    const std::size_t end = at_;
    at_ = begin;
    for (const Struct::Field& field : to.fields) {
      const Struct::Field* const old = failed_ ? nullptr : from.Find(field.name);
      if (old == nullptr) {
        WriteDefault(field.type);
        continue;
      }
      at_ = places[static_cast<std::size_t>(old - from.fields.data())];
      Copy(old->type, field.type);
    }
    at_ = end;
  }

 private:
  void Copy(const LayoutType& from, const LayoutType& to) {
    if (!to.is_sequence) return CopyElements(from, to, 1);
    const std::uint32_t count = ReadCount();
    WriteCount(count);
    if (count > 0) CopyElements(from, to, count);
  }

  void CopyElements(const LayoutType& from, const LayoutType& to, std::size_t count) {
    if (to.size > 0) {
      const std::span<const std::byte> numbers = Read(to.size, count);
      Write(to.size, numbers);
      return;
    }
    for (std::size_t i = 0; i < count && !failed_; ++i) {
      if (to.is_text) {
        const std::uint32_t length = ReadCount();
        WriteCount(length);
        Write(1, Read(1, length));
      } else {
        Copy(*from.fields, *to.fields);
      }
    }
  }

  void Skip(const LayoutType& type) {
    const std::size_t count = type.is_sequence ? ReadCount() : 1;
    if (type.size > 0) {
      if (count > 0) Read(type.size, count);
      return;
    }
    for (std::size_t i = 0; i < count && !failed_; ++i) {
      if (type.is_text) {
        Read(1, ReadCount());
      } else {
        for (const Struct::Field& field : type.fields->fields) Skip(field.type);
      }
    }
  }

  void WriteDefault(const LayoutType& type) {
    if (type.is_sequence) {
      WriteCount(0);
    } else if (type.is_text) {
      WriteCount(1);
      out_.push_back(std::byte{0});
    } else if (type.size > 0) {
      Align(type.size);
      out_.resize(out_.size() + type.size);
    } else {
      for (const Struct::Field& field : type.fields->fields) WriteDefault(field.type);
    }
  }

  // Numbers of `size` bytes, at a place that is a multiple of it.
  std::span<const std::byte> Read(std::size_t size, std::size_t count) {
    at_ += (size - at_ % size) % size;
    if (at_ > bytes_.size() || count > left() / size) {
      failed_ = true;
      at_ = bytes_.size();
      return {};
    }
    const std::span<const std::byte> read = bytes_.subspan(at_, size * count);
    at_ += read.size();
    return read;
  }
  std::uint32_t ReadCount() {
    std::uint32_t count = 0;
    const std::span<const std::byte> bytes = Read(sizeof count, 1);
    if (!bytes.empty()) std::memcpy(&count, bytes.data(), sizeof count);
    return count;
  }
  void Align(std::size_t size) { out_.resize(out_.size() + (size - out_.size() % size) % size); }
  void Write(std::size_t size, std::span<const std::byte> bytes) {
    Align(size);
    out_.insert(out_.end(), bytes.begin(), bytes.end());
  }
  void WriteCount(std::uint32_t count) { Write(sizeof count, std::as_bytes(std::span(&count, 1))); }

  std::span<const std::byte> bytes_;
  std::size_t at_ = 0;
  bool failed_ = false;
  std::vector<std::byte> out_;
};

}  // namespace

bool LayoutChange::IsNone(const std::string& from, const std::string& to) {
  return from == to || WordsOf(from) == WordsOf(to);
}

Result<LayoutChange> LayoutChange::Between(const std::string& from, const std::string& to, const std::string& type) {
  LayoutChange change;
  for (const auto& [text, types, found] :
       {std::tuple(&from, &change.from_, &change.from_type_), std::tuple(&to, &change.to_, &change.to_type_)}) {
    Result<std::shared_ptr<const Types>> parsed = IdlParser(*text).Parse();
    if (!parsed.ok()) return parsed.error();
    *types = std::move(parsed).value();
    const auto entry = (*types)->find(type.substr(type.rfind(':') + 1));
    if (entry == (*types)->end()) return UnknownLayout("it has no type " + type);
    *found = entry->second.get();
  }
  if (Status status = Compare(*change.from_type_, *change.to_type_); !status.ok()) return status.error();
  return change;
}

Result<std::vector<std::byte>> LayoutChange::Apply(std::span<const std::byte> sample) const {
  constexpr std::size_t kHeader = 4;     // of the encapsulation; its last byte counts the padding at the end
  constexpr std::size_t kAlignment = 4;  // of the whole
  const Error malformed{{}, "found a message that is not of its schema"};
  if (sample.size() < kHeader || sample[0] != std::byte{0} || sample[1] != std::byte{1}) return malformed;
  const std::size_t padding = std::to_integer<std::size_t>(sample[3]) % kAlignment;
  if (padding > sample.size() - kHeader) return malformed;
  Copier copier(sample.subspan(kHeader, sample.size() - kHeader - padding));
  copier.Copy(*from_type_, *to_type_);
  if (copier.failed() || copier.left() != 0) return malformed;
  const std::vector<std::byte> content = copier.Release();
  const std::size_t added = (kAlignment - content.size() % kAlignment) % kAlignment;
  std::vector<std::byte> result(kHeader, std::byte{0});
  result[1] = std::byte{1};
  result[3] = static_cast<std::byte>(added);
  result.insert(result.end(), content.begin(), content.end());
  result.resize(result.size() + added);
  return result;
}

}  // namespace troupe
