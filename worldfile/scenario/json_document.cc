#include "worldfile/scenario/json_document.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>

#include "worldfile/text/quote.h"

namespace troupe {
namespace {

using nlohmann::json;

// The essential part of a message of the library. "[json.exception.parse_error.101] parse error at line 1, column 5:
// syntax error while parsing value - invalid literal; last read: 'nul}'" loses its preamble, since our messages start
// with the place, and the text that was last read, which may be of any length.
std::string Shortened(const std::string& what) {
  if (what.find("out_of_range") != std::string::npos)
    return "found a number that is too large, expected at most 1.8e308";
  std::size_t start = what.find("] ");
  start = start == std::string::npos ? 0 : start + 2;
  if (what.compare(start, 15, "parse error at ") == 0) {
    const std::size_t colon = what.find(": ", start);
    if (colon != std::string::npos) start = colon + 2;
  }
  std::string message = what.substr(start);
  const std::size_t last_read = message.find("; last read: '");
  if (last_read != std::string::npos) {
    const std::size_t expected = message.rfind("'; expected ");
    message.erase(last_read, expected == std::string::npos ? std::string::npos : expected + 1 - last_read);
  }
  return "not valid JSON: " + message;
}

bool IsJsonBlank(char c) {
  return c == ' ' || c == '\t' || c == '\n' || c == '\r';
}

// Each of these returns the offset behind a part of the text that starts at `offset`.
std::size_t AfterBlanks(const std::string& text, std::size_t offset) {
  while (offset < text.size() && IsJsonBlank(text[offset])) ++offset;
  return offset;
}

// REQUIRES: text[offset] is an opening quote.
std::size_t AfterString(const std::string& text, std::size_t offset) {
  for (++offset; offset < text.size() && text[offset] != '"'; ++offset) {
    if (text[offset] == '\\') ++offset;
  }
  return offset + 1;
}

// A number, true, false or null.
std::size_t AfterScalar(const std::string& text, std::size_t offset) {
  while (offset < text.size() && !IsJsonBlank(text[offset]) && text[offset] != ',' && text[offset] != ']' &&
         text[offset] != '}') {
    ++offset;
  }
  return offset;
}

// The start of the text behind a byte order mark, which the library skips too.
std::size_t StartOf(const std::string& text) {
  return text.compare(0, 3, "\xEF\xBB\xBF") == 0 ? 3 : 0;
}

// Finds the place and the reason at which the text stops being JSON, and duplicate keys. The library gives the
// place only for broken text, so a cursor follows it from token to token.
class SyntaxCheck : public nlohmann::json_sax<json> {
 public:
  explicit SyntaxCheck(const std::string& text) : text_(text), cursor_(StartOf(text)) {}

  // Of the first fault.
  std::size_t offset() const { return offset_; }
  const std::string& message() const { return message_; }

  bool null() override { return Scalar(); }
  bool boolean(bool) override { return Scalar(); }
  bool number_integer(number_integer_t) override { return Scalar(); }
  bool number_unsigned(number_unsigned_t) override { return Scalar(); }
  bool number_float(number_float_t, const string_t&) override { return Scalar(); }
  bool binary(binary_t&) override { return true; }
  bool string(string_t&) override {
    ToToken();
    cursor_ = AfterString(text_, cursor_);
    return true;
  }
  bool start_array(std::size_t) override { return Bracket(); }
  bool end_array() override { return Bracket(); }
  bool start_object(std::size_t) override {
    keys_.emplace_back();
    return Bracket();
  }
  bool end_object() override {
    keys_.pop_back();
    return Bracket();
  }
  bool key(string_t& name) override {
    ToToken();
    if (!keys_.back().insert(name).second) {
      offset_ = cursor_;
      message_ = "found the key " + Quoted(name) + " again, expected it once";
      return false;
    }
    cursor_ = AfterString(text_, cursor_);
    return true;
  }
  bool parse_error(std::size_t position, const std::string&, const json::exception& exception) override {
    message_ = Shortened(exception.what());
    // The library names the last character that it read, counting from 1; an unexpected word or number is better named
    // by its start.
    offset_ = position > 0 ? position - 1 : 0;
    const bool word = message_.find("literal") < message_.find(';') || message_.find("number") != std::string::npos;
    if (word) {
      ToToken();
      offset_ = cursor_;
    }
    return false;
  }

 private:
  void ToToken() {
    while (cursor_ < text_.size() && (IsJsonBlank(text_[cursor_]) || text_[cursor_] == ',' || text_[cursor_] == ':')) {
      ++cursor_;
    }
  }
  bool Scalar() {
    ToToken();
    cursor_ = AfterScalar(text_, cursor_);
    return true;
  }
  bool Bracket() {
    ToToken();
    ++cursor_;
    return true;
  }

  const std::string& text_;
  std::size_t cursor_;
  std::size_t offset_ = 0;
  std::string message_;
  std::vector<std::set<std::string>> keys_;  // of the objects that are open
};

struct Excess {
  std::size_t offset = 0;
  std::string message;
};

// Counts brackets and commas outside strings. Works on any text, so that no document is built from a malformed one.
std::optional<Excess> FindExcess(const std::string& text) {
  int depth = 0;
  std::size_t values = 1;
  for (std::size_t i = 0; i < text.size();) {
    const char c = text[i];
    if (c == '"') {
      i = AfterString(text, i);
      continue;
    }
    if (c == '[' || c == '{') {
      ++values;
      if (++depth > JsonDocument::kMaxDepth) {
        return Excess{i, "found deeper nesting, expected at most " + std::to_string(JsonDocument::kMaxDepth) +
                             " objects and arrays inside each other"};
      }
    } else if (c == ']' || c == '}') {
      --depth;
    } else if (c == ',') {
      ++values;
    }
    if (values > JsonDocument::kMaxValues) {
      return Excess{i, "found more values, expected at most " + std::to_string(JsonDocument::kMaxValues)};
    }
    ++i;
  }
  return std::nullopt;
}

}  // namespace

JsonDocument::JsonDocument(const std::string& text, std::string file) : file_(std::move(file)), line_starts_{0} {
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '\n') line_starts_.push_back(i + 1);
  }
}

JsonDocument::~JsonDocument() = default;
JsonDocument::JsonDocument(JsonDocument&&) noexcept = default;
JsonDocument& JsonDocument::operator=(JsonDocument&&) noexcept = default;

Result<JsonDocument> JsonDocument::Parse(const std::string& text, const std::string& file) {
  if (text.size() > kMaxBytes) {
    return Error{{file, 0, 0},
                 "found " + std::to_string(text.size()) + " bytes, expected at most " + std::to_string(kMaxBytes)};
  }
  JsonDocument document(text, file);
  if (const auto excess = FindExcess(text)) return Error{document.WhereOffset(excess->offset), excess->message};
  SyntaxCheck syntax(text);
  if (!json::sax_parse(text, &syntax)) return Error{document.WhereOffset(syntax.offset()), syntax.message()};
  document.root_ = std::make_unique<json>(json::parse(text));
  document.FindPlaces(text, *document.root_, StartOf(text), 0);
  return document;
}

// Walks over the text and the parsed value side by side. REQUIRES: the text is JSON without repeated keys.
std::size_t JsonDocument::FindPlaces(const std::string& text, const json& value, std::size_t offset, std::size_t key) {
  offset = AfterBlanks(text, offset);
  places_[&value] = {offset, key > 0 ? key : offset};
  if (value.is_string()) return AfterString(text, offset);
  if (!value.is_structured()) return AfterScalar(text, offset);
  ++offset;
  auto item = value.begin();
  for (std::size_t i = 0; i < value.size(); ++i) {
    offset = AfterBlanks(text, offset);
    if (value.is_object()) {
      const std::size_t key_offset = offset;
      offset = AfterString(text, offset);
      const std::string name = json::parse(text.substr(key_offset, offset - key_offset)).get<std::string>();
      offset = AfterBlanks(text, offset) + 1;  // ':'
      offset = FindPlaces(text, value.at(name), offset, key_offset);
    } else {
      offset = FindPlaces(text, *item++, offset, 0);
    }
    offset = AfterBlanks(text, offset);
    if (i + 1 < value.size()) ++offset;  // ','
  }
  return AfterBlanks(text, offset) + 1;
}

SourceLocation JsonDocument::WhereOffset(std::size_t offset) const {
  const auto next = std::upper_bound(line_starts_.begin(), line_starts_.end(), offset);
  const auto line = static_cast<int>(next - line_starts_.begin());
  return {file_, line, static_cast<int>(offset - *(next - 1)) + 1};
}

SourceLocation JsonDocument::Where(const json& value) const {
  return WhereOffset(places_.at(&value).value);
}

SourceLocation JsonDocument::WhereKey(const json& value) const {
  return WhereOffset(places_.at(&value).key);
}

std::string Describe(const json& value) {
  switch (value.type()) {
    case json::value_t::null:
      return "null";
    case json::value_t::boolean:
      return value.get<bool>() ? "true" : "false";
    case json::value_t::string:
      return "the string " + Quoted(value.get_ref<const std::string&>());
    case json::value_t::array:
      return value.empty() ? "an empty array" : "an array of " + std::to_string(value.size());
    case json::value_t::object:
      return value.empty() ? "an empty object" : "an object";
    default:
      return "the number " + value.dump();
  }
}

}  // namespace troupe
