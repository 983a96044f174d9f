// JsonWriter: writes the text of a JSON value piece by piece, without making the value first. For the lines of
// readings, records and traces, which are many; a value that exists as nlohmann::json is written by JsonText (json.h).
//
// No tree and no allocation per value: a line of a scan has hundreds of numbers, and the text is the only memory.
#pragma once

#include <charconv>
#include <concepts>
#include <cstddef>
#include <limits>
#include <span>
#include <string>
#include <string_view>

namespace troupe {

// Appends to a text that outlives the writer. REQUIRES of the caller: the calls make one value, with a key before each
// member of an object and none elsewhere.
class JsonWriter {
 public:
  explicit JsonWriter(std::string& text) : text_(text) {}

  JsonWriter& BeginObject() { return Begin('{'); }
  JsonWriter& EndObject() { return End('}'); }
  JsonWriter& BeginList() { return Begin('['); }
  JsonWriter& EndList() { return End(']'); }
  // A name without characters that JSON escapes.
  JsonWriter& Key(std::string_view name) {
    Separate();
    text_ += '"';
    text_ += name;
    text_ += "\":";
    separates_ = false;
    return *this;
  }

  // The shortest decimal that reads back as the same double; null if it is not finite, which JSON cannot say.
  JsonWriter& Value(double number);
  JsonWriter& Value(std::span<const double> numbers);
  // Bytes that are not UTF-8 become U+FFFD.
  JsonWriter& Value(std::string_view text);
  JsonWriter& Value(const std::string& text) { return Value(std::string_view(text)); }
  JsonWriter& Value(const char* text) { return Value(std::string_view(text)); }
  JsonWriter& Value(std::same_as<bool> auto flag) { return Raw(flag ? "true" : "false"); }
  template <std::integral Integer>
  requires(!std::same_as<Integer, bool>) JsonWriter& Value(Integer integer) {
    char digits[std::numeric_limits<Integer>::digits10 + 3];
    const char* const end = std::to_chars(digits, digits + sizeof digits, integer).ptr;
    return Raw({digits, static_cast<std::size_t>(end - digits)});
  }
  JsonWriter& Null() { return Raw("null"); }
  // The text of a value.
  JsonWriter& Raw(std::string_view json) {
    Separate();
    text_ += json;
    return *this;
  }

  template <typename Content>
  JsonWriter& Member(std::string_view key, const Content& value) {
    return Key(key).Value(value);
  }

 private:
  void Separate() {
    if (separates_) text_ += ',';
    separates_ = true;
  }
  JsonWriter& Begin(char bracket) {
    Separate();
    text_ += bracket;
    separates_ = false;
    return *this;
  }
  JsonWriter& End(char bracket) {
    text_ += bracket;
    separates_ = true;
    return *this;
  }

  std::string& text_;
  bool separates_ = false;  // a value stands before the next one
};

}  // namespace troupe
