// JSON text with the place of every value, for messages that name a line and a column.
#pragma once

#include <cstddef>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <unordered_map>
#include <vector>

#include "troupe/result.h"

namespace troupe {

class JsonDocument {
 public:
  // Larger texts are refused unread; the other two limits bound memory and stack.
  static constexpr std::size_t kMaxBytes = 16u << 20;
  static constexpr std::size_t kMaxValues = 250'000;
  static constexpr int kMaxDepth = 64;

  // Strict JSON in UTF-8; a key that an object has twice is an error. `file` names the text in messages.
  static Result<JsonDocument> Parse(const std::string& text, const std::string& file);

  ~JsonDocument();
  JsonDocument(JsonDocument&&) noexcept;
  JsonDocument& operator=(JsonDocument&&) noexcept;
  JsonDocument(const JsonDocument&) = delete;  // places are known by the values' addresses
  JsonDocument& operator=(const JsonDocument&) = delete;

  const nlohmann::json& root() const { return *root_; }

  // Where `value` starts. REQUIRES: it is in this document.
  SourceLocation Where(const nlohmann::json& value) const;
  // Where the key of `value` starts; the value itself if it is not an object's member.
  SourceLocation WhereKey(const nlohmann::json& value) const;

  // Where `value` starts, in bytes: for the order of the text. REQUIRES: it is in this document.
  std::size_t Offset(const nlohmann::json& value) const { return places_.at(&value).value; }

  // An error at the place of `value`.
  Error ErrorAt(const nlohmann::json& value, std::string message) const { return {Where(value), std::move(message)}; }

 private:
  struct Place {
    std::size_t value = 0;  // offsets into the text
    std::size_t key = 0;
  };

  JsonDocument(const std::string& text, std::string file);
  SourceLocation WhereOffset(std::size_t offset) const;
  // Of `value`, whose text starts at or after `offset`, and all below it. Returns the offset behind it.
  std::size_t FindPlaces(const std::string& text, const nlohmann::json& value, std::size_t offset, std::size_t key);

  std::string file_;
  std::vector<std::size_t> line_starts_;
  std::unique_ptr<nlohmann::json> root_;
  std::unordered_map<const nlohmann::json*, Place> places_;
};

// "the string 'abc'", "the number 3", "an array of 2", "an object", "null": for messages.
std::string Describe(const nlohmann::json& value);

}  // namespace troupe
