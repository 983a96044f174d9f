#include "common/base/json_tree.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>

#include "common/base/text.h"

namespace troupe {
namespace {

using nlohmann::json;
using Kind = JsonNode::Kind;

// The words that are values.
struct Word {
  std::string_view text;
  Kind kind;
};
constexpr Word kWords[] = {{"true", Kind::kTrue}, {"false", Kind::kFalse}, {"null", Kind::kNull}};

bool IsDigit(char c) {
  return c >= '0' && c <= '9';
}

// Within a string.
bool IsSpecial(char c) {
  return c == '"' || c == '\\' || static_cast<unsigned char>(c) < 0x20;
}

std::optional<unsigned> HexDigit(char c) {
  const std::size_t digit = std::string_view("0123456789abcdef0123456789ABCDEF").find(c);
  return digit != std::string_view::npos ? std::optional(static_cast<unsigned>(digit % 16)) : std::nullopt;
}

void AppendUtf8(unsigned code, std::string& text) {
  const auto add = [&](unsigned byte) { text += static_cast<char>(byte); };
  if (code < 0x80) {
    add(code);
  } else if (code < 0x800) {
    add(0xc0 | (code >> 6));
    add(0x80 | (code & 0x3f));
  } else {
    if (code < 0x10000) {
      add(0xe0 | (code >> 12));
    } else {
      add(0xf0 | (code >> 18));
      add(0x80 | ((code >> 12) & 0x3f));
    }
    add(0x80 | ((code >> 6) & 0x3f));
    add(0x80 | (code & 0x3f));
  }
}

// True for a number that is too small for a double, not too large.
bool IsTiny(std::string_view number) {
  const std::size_t e = number.find_first_of("eE");
  const std::string_view digits = number.substr(0, e);
  const std::size_t first = digits.find_first_of("123456789");
  const std::size_t point = std::min(digits.find('.'), digits.size());
  double exponent = 0.0;
  if (e != std::string_view::npos) {
    for (const char c : number.substr(e + 1)) {
      if (IsDigit(c)) exponent = 10.0 * exponent + (c - '0');
    }
    if (number[e + 1] == '-') exponent = -exponent;
  }
  return static_cast<double>(point) - static_cast<double>(first) + exponent < 0.0;
}

// A recursive descent parser. Each Parse method begins at the first byte of its construct and ends behind the last one;
// it returns false at a fault.
class Parser {
 public:
  Parser(std::string_view text, std::size_t max_values) : text_(text), max_values_(max_values) {}

  bool ParseText(JsonNode& root) {
    constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
    if (text_.starts_with(kByteOrderMark)) at_ = kByteOrderMark.size();
    SkipBlanks();
    if (!ParseValue(root)) return false;
    root.member = root.span;
    SkipBlanks();
    return at_ == text_.size() || Unexpected("value", "end of input");
  }

  // The offset of the fault.
  std::size_t offset() const { return offset_; }
  const std::string& message() const { return message_; }

 private:
  char Peek() const { return at_ < text_.size() ? text_[at_] : '\0'; }
  void SkipBlanks() { at_ = std::min(text_.find_first_not_of(" \t\r\n", at_), text_.size()); }
  bool SkipDigits() {
    const std::size_t begin = at_;
    while (IsDigit(Peek())) ++at_;
    return at_ > begin;
  }

  bool Fail(std::size_t offset, std::string message) {
    offset_ = offset;
    message_ = std::move(message);
    return false;
  }
  bool Malformed(std::size_t offset, const std::string& construct, const std::string& reason) {
    return Fail(offset, "not valid JSON: syntax error while parsing " + construct + " - " + reason);
  }
  bool Unexpected(const std::string& construct, const std::string& expected) {
    return Malformed(at_, construct, TokenHere() + "; expected " + expected);
  }

  std::string TokenHere() const {
    if (at_ == text_.size()) return "unexpected end of input";
    const char c = Peek();
    // The kinds and the words of messages follow nlohmann::json's parser, so that users find them in a search.
    if (c == '"') return "unexpected string literal";
    if (c == '-' || IsDigit(c)) return "unexpected number literal";
    if (std::string_view("{}[],:").find(c) != std::string_view::npos) return std::string("unexpected '") + c + "'";
    for (const Word& word : kWords) {
      if (text_.substr(at_).starts_with(word.text)) return "unexpected " + std::string(word.text) + " literal";
    }
    return "invalid literal";
  }

  bool ParseValue(JsonNode& node) {
    node.span.begin = at_;
    const char c = Peek();
    bool good = false;
    if (c == '{' || c == '[') {
      node.kind = c == '{' ? Kind::kObject : Kind::kArray;
      good = ParseItems(node);
    } else if (c == '"') {
      node.kind = Kind::kString;
      good = ParseString(node.text);
    } else if (c == '-' || IsDigit(c)) {
      node.kind = Kind::kNumber;
      good = ParseNumber(node);
    } else {
      good = ParseWord(node);
    }
    node.span.end = at_;
    return good;
  }

  bool ParseWord(JsonNode& node) {
    for (const Word& word : kWords) {
      if (!text_.substr(at_).starts_with(word.text)) continue;
      node.kind = word.kind;
      at_ += word.text.size();
      return true;
    }
    const std::string found = TokenHere();
    if (found == "invalid literal") return Malformed(at_, "value", found);
    return Unexpected("value", "'[', '{', or a literal");
  }

  bool Count() {
    if (++values_ <= max_values_) return true;
    return Fail(at_, "found more values, expected at most " + std::to_string(max_values_));
  }

  bool ParseItems(JsonNode& node) {
    const char close = node.is_object() ? '}' : ']';
    if (!Count()) return false;
    if (++depth_ > JsonTree::kMaxDepth) {
      return Fail(at_, "found deeper nesting, expected at most " + std::to_string(JsonTree::kMaxDepth) +
                           " objects and arrays inside each other");
    }
    ++at_;
    SkipBlanks();
    // A set, not Find: an object of 100,000 members would cost their square.
    std::set<std::string> keys;
    while (Peek() != close || !node.items.empty()) {
      if (!ParseItem(node, keys)) return false;
      SkipBlanks();
      if (Peek() == close) break;
      if (Peek() != ',') return Unexpected(node.is_object() ? "object" : "array", std::string("'") + close + "'");
      // Counted at the comma, before the next item is made: memory stays within the limit.
      if (!Count()) return false;
      ++at_;
      SkipBlanks();
    }
    ++at_;
    --depth_;
    return true;
  }

  bool ParseItem(JsonNode& holder, std::set<std::string>& keys) {
    JsonNode& item = holder.items.emplace_back();
    item.member.begin = at_;
    if (holder.is_object()) {
      if (Peek() != '"') return Unexpected("object key", "string literal");
      if (!ParseString(item.key)) return false;
      if (!keys.insert(item.key).second) {
        return Fail(item.member.begin, "found the key " + Quoted(item.key) + " again, expected it once");
      }
      SkipBlanks();
      if (Peek() != ':') return Unexpected("object separator", "':'");
      ++at_;
      SkipBlanks();
    }
    const bool good = ParseValue(item);
    item.member.end = at_;
    return good;
  }

  bool BadString(std::size_t offset, const std::string& reason) {
    return Malformed(offset, "value", "invalid string: " + reason);
  }

  bool ParseString(std::string& characters) {
    const std::size_t begin = ++at_;
    for (;;) {
      if (at_ == text_.size()) return BadString(begin - 1, "missing closing quote");
      std::size_t special = at_;
      while (special < text_.size() && !IsSpecial(text_[special])) ++special;
      characters += text_.substr(at_, special - at_);
      at_ = special;
      if (Peek() == '"') break;
      if (at_ == text_.size()) continue;
      if (Peek() != '\\') return BadString(at_, "a control character must be escaped");
      if (!ParseEscape(characters)) return false;
    }
    // Checked once for the whole string, in its raw form: escapes are ASCII, and yield valid UTF-8 by themselves.
    const std::size_t odd = FindInvalidUtf8(text_.substr(begin, at_ - begin));
    if (odd != std::string_view::npos) return BadString(begin + odd, "ill-formed UTF-8 byte");
    ++at_;
    return true;
  }

  bool ParseEscape(std::string& characters) {
    constexpr std::string_view kNames = "\"\\/bfnrt";
    constexpr std::string_view kCharacters = "\"\\/\b\f\n\r\t";
    const std::size_t begin = at_++;
    if (Peek() == 'u') {
      ++at_;
      return ParseUnicode(begin, characters);
    }
    const std::size_t index = at_ < text_.size() ? kNames.find(Peek()) : std::string_view::npos;
    if (index == std::string_view::npos) return BadString(begin, "forbidden character after backslash");
    characters += kCharacters[index];
    ++at_;
    return true;
  }

  std::optional<unsigned> FourHexDigits() {
    unsigned code = 0;
    for (int i = 0; i < 4; ++i, ++at_) {
      const std::optional<unsigned> digit = HexDigit(Peek());
      if (!digit) return std::nullopt;
      code = code * 16 + *digit;
    }
    return code;
  }

  bool ParseUnicode(std::size_t begin, std::string& characters) {
    const auto is_high = [](unsigned code) { return code >= 0xd800 && code < 0xdc00; };
    const auto is_low = [](unsigned code) { return code >= 0xdc00 && code < 0xe000; };
    std::optional<unsigned> code = FourHexDigits();
    if (!code) return BadString(begin, "'\\u' must be followed by 4 hex digits");
    if (is_high(*code) && text_.substr(at_).starts_with("\\u")) {
      at_ += 2;
      const std::optional<unsigned> low = FourHexDigits();
      if (!low || !is_low(*low)) return BadString(begin, "a surrogate must be followed by its second half");
      // Two halves of UTF-16 for one character above U+FFFF (RFC 8259, section 7).
      code = 0x10000 + ((*code - 0xd800) << 10) + (*low - 0xdc00);
    }
    if (is_high(*code) || is_low(*code)) return BadString(begin, "a surrogate without its other half");
    AppendUtf8(*code, characters);
    return true;
  }

  bool ParseNumber(JsonNode& node) {
    const std::size_t begin = at_;
    const auto expected = [&](const char* what) {
      return Malformed(begin, "value", std::string("invalid number; expected ") + what);
    };
    if (Peek() == '-') ++at_;
    if (Peek() == '0') {
      ++at_;
    } else if (!SkipDigits()) {
      return expected("digit after '-'");
    }
    if (Peek() == '.') {
      ++at_;
      if (!SkipDigits()) return expected("digit after '.'");
    }
    if (Peek() == 'e' || Peek() == 'E') {
      ++at_;
      if (Peek() == '+' || Peek() == '-') ++at_;
      if (!SkipDigits()) return expected("digit in the exponent");
    }
    node.text = text_.substr(begin, at_ - begin);
    // Not the C library's functions, which depend on the locale.
    const auto read = std::from_chars(node.text.data(), node.text.data() + node.text.size(), node.number);
    if (read.ec == std::errc()) return true;
    // from_chars reports underflow and overflow alike, so that the text decides: 1e-400 is 0, 1e400 is a fault.
    node.number = 0.0;
    return IsTiny(node.text) || Fail(begin, "found a number that is too large, expected at most 1.8e308");
  }

  const std::string_view text_;
  const std::size_t max_values_;
  std::size_t at_ = 0;
  int depth_ = 0;
  std::size_t values_ = 1;
  std::size_t offset_ = 0;
  std::string message_;
};

}  // namespace

const JsonNode* JsonNode::Find(std::string_view name) const {
  const auto found = std::find_if(items.begin(), items.end(), [&](const JsonNode& item) { return item.key == name; });
  return is_object() && found != items.end() ? &*found : nullptr;
}

const JsonNode& JsonNode::Member(std::string_view name) const {
  const JsonNode* const found = Find(name);
  TROUPE_CHECK(found != nullptr);
  return *found;
}

const std::vector<JsonNode>& JsonNode::ItemsOf(std::string_view name) const {
  static const std::vector<JsonNode> kNone;
  const JsonNode* const found = Find(name);
  return found != nullptr ? found->items : kNone;
}

Result<JsonTree> JsonTree::Parse(std::string_view text, const std::string& file, const JsonLimits& limits) {
  if (text.size() > limits.bytes) {
    return Error{{file, 0, 0},
                 "found " + std::to_string(text.size()) + " bytes, expected at most " + std::to_string(limits.bytes)};
  }
  JsonTree tree(text, file);
  Parser parser(text, limits.values);
  if (!parser.ParseText(tree.root_)) return Error{tree.lines_.Where(file, parser.offset()), parser.message()};
  return tree;
}

std::vector<const JsonNode*> JsonTree::PathTo(std::size_t offset) const {
  std::vector<const JsonNode*> path;
  const JsonNode* at = root_.span.Contains(offset) ? &root_ : nullptr;
  while (at != nullptr) {
    path.push_back(at);
    const auto inner = std::find_if(at->items.begin(), at->items.end(),
                                    [&](const JsonNode& item) { return item.member.Contains(offset); });
    at = inner != at->items.end() ? &*inner : nullptr;
  }
  return path;
}

json ToJson(const JsonNode& node) {
  switch (node.kind) {
    case Kind::kNull:
      return nullptr;
    case Kind::kFalse:
      return false;
    case Kind::kTrue:
      return true;
    case Kind::kString:
      return node.text;
    case Kind::kNumber: {
      const char* const end = node.text.data() + node.text.size();
      // Integers stay integers: a double would round a seed above 2^53.
      std::uint64_t positive = 0;
      if (const auto read = std::from_chars(node.text.data(), end, positive); read.ec == std::errc() && read.ptr == end)
        return positive;
      std::int64_t integer = 0;
      if (const auto read = std::from_chars(node.text.data(), end, integer); read.ec == std::errc() && read.ptr == end)
        return integer;
      return node.number;
    }
    case Kind::kArray: {
      json array = json::array();
      for (const JsonNode& item : node.items) array.push_back(ToJson(item));
      return array;
    }
    case Kind::kObject: {
      json object = json::object();
      for (const JsonNode& item : node.items) object[item.key] = ToJson(item);
      return object;
    }
  }
  return nullptr;
}

std::string Describe(const JsonNode& node) {
  switch (node.kind) {
    case Kind::kString:
      return "the string " + Quoted(node.text);
    case Kind::kArray:
      return node.items.empty() ? "an empty array" : "an array of " + std::to_string(node.items.size());
    case Kind::kObject:
      return node.items.empty() ? "an empty object" : "an object";
    case Kind::kNumber:
      return "the number " + ToJson(node).dump();
    default:
      return ToJson(node).dump();
  }
}

}  // namespace troupe
