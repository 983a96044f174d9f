#include "fleet/codec.h"

#include <algorithm>
#include <cctype>

#include "common/base/text.h"
#include "fleet/message_reader.h"
#include "fleet/message_writer.h"

namespace troupe::fleet {
namespace {

// Without underscores, in upper case.
std::string PlainName(std::string_view name) {
  std::string plain;
  for (const char c : name) {
    if (c != '_') plain += c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
  }
  return plain;
}

void AppendQuoted(std::string_view text, std::string& json) {
  JsonWriter(json).Value(text);
}

// The depth of a tree is limited.
void AppendJson(const JsonNode& node, std::string& json) {
  using Kind = JsonNode::Kind;
  switch (node.kind) {
    case Kind::kNull:
      json += "null";
      break;
    case Kind::kFalse:
      json += "false";
      break;
    case Kind::kTrue:
      json += "true";
      break;
    case Kind::kNumber:
      json += node.text;
      break;
    case Kind::kString:
      AppendQuoted(node.text, json);
      break;
    case Kind::kArray:
    case Kind::kObject: {
      const bool is_object = node.is_object();
      json += is_object ? '{' : '[';
      for (std::size_t i = 0; i < node.items.size(); ++i) {
        if (i > 0) json += ',';
        if (is_object) {
          AppendQuoted(node.items[i].key, json);
          json += ':';
        }
        AppendJson(node.items[i], json);
      }
      json += is_object ? '}' : ']';
      break;
    }
  }
}

// The names that members have, or had, elsewhere: in 2.0, and in its text.
constexpr std::pair<std::string_view, std::string_view> kOtherNames[] = {{"allowedDeviationXY", "allowedDeviationXy"},
                                                                         {"actionType", "actionName"},
                                                                         {"actions", "action"},
                                                                         {"grantType", "responseType"},
                                                                         {"maxRotationSpeed", "maximumRotationSpeed"}};

std::string ShortDescription(const JsonNode& node) {
  JsonNode shown;
  shown.kind = node.kind;
  shown.text = std::string(CutUtf8(node.text, 40));
  shown.number = node.number;
  if (!node.items.empty()) return node.is_object() ? "an object" : "an array of " + std::to_string(node.items.size());
  return Describe(shown);
}

std::string NumberText(double number) {
  std::string text;
  JsonWriter(text).Value(number);
  return text;
}

std::string RangeText(const NumberRange& range) {
  constexpr NumberRange kAny;
  if (range.min == kAny.min && range.max == kAny.max) return "a number";
  if (range.max == kAny.max) return "a number of at least " + NumberText(range.min);
  return "a number from " + NumberText(range.min) + " to " + NumberText(range.max);
}

// The number that a text is as a whole.
std::optional<double> NumberOfText(std::string_view text) {
  while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
  while (!text.empty() && text.back() == ' ') text.remove_suffix(1);
  double number = 0.0;
  const auto read = std::from_chars(text.data(), text.data() + text.size(), number);
  if (read.ec != std::errc() || read.ptr != text.data() + text.size() || !std::isfinite(number)) return std::nullopt;
  return number;
}

}  // namespace

std::string MessageFault::ToString() const {
  return pointer.empty() ? text : pointer + ": " + text;
}

std::optional<double> ParameterValue::Number() const {
  return kind == Kind::kNumber || kind == Kind::kString ? NumberOfText(text) : std::nullopt;
}

std::optional<bool> ParameterValue::Boolean() const {
  const std::string plain = PlainName(text);
  if (kind == Kind::kJson || (plain != "TRUE" && plain != "FALSE")) return std::nullopt;
  return plain == "TRUE";
}

ParameterValue ParameterValue::Of(double number) {
  return {Kind::kNumber, NumberText(number)};
}

// The reader.

const JsonNode* MessageReader::Find(MemberName name) {
  const auto [own, other] = has_newer() ? std::pair(name.newer, name.older) : std::pair(name.older, name.newer);
  if (const JsonNode* const found = object_->Find(own)) return found;
  const auto find_other = [&](std::string_view other_name) {
    const JsonNode* const found = object_->Find(other_name);
    if (found != nullptr) NoteAt(Lenience::kOtherName, pointer_ + '/' + std::string(other_name));
    return found;
  };
  if (other != own) {
    if (const JsonNode* const found = find_other(other)) return found;
  }
  for (const auto& [known, elsewhere] : kOtherNames) {
    if (known != own) continue;
    if (const JsonNode* const found = find_other(elsewhere)) return found;
  }
  return nullptr;
}

void MessageReader::Miss(MemberName name) {
  if (may_miss_) return;
  FailWith("found no member '" + std::string(has_newer() ? name.newer : name.older) + "', expected one");
}

void MessageReader::NoteMissing(MemberName name) {
  NoteAt(Lenience::kMissingList, pointer_ + '/' + std::string(has_newer() ? name.newer : name.older));
}

void MessageReader::Note(Lenience lenience, const JsonNode& /*node*/) {
  NoteAt(lenience, pointer_);
}

void MessageReader::NoteAt(Lenience lenience, std::string pointer) {
  if (lenient_.size() < kMaxLenientPlaces) lenient_.push_back({lenience, std::move(pointer)});
}

void MessageReader::Fail(const JsonNode& node, std::string_view expected) {
  FailWith("found " + ShortDescription(node) + ", expected " + std::string(expected));
}

void MessageReader::FailWith(std::string text) {
  if (faults_.size() < kMaxMessageFaults) faults_.push_back({pointer_, std::move(text)});
}

std::size_t MessageReader::Enter(std::string_view segment) {
  const std::size_t length = pointer_.size();
  pointer_ += '/';
  for (const char c : segment.substr(0, 100)) {
    if (c == '~') {
      pointer_ += "~0";
    } else if (c == '/') {
      pointer_ += "~1";
    } else {
      pointer_ += c;
    }
  }
  return length;
}

int MessageReader::LikenessOf(std::string_view text, std::string_view name, std::string_view expected) {
  if (text == expected && PlainName(expected) == PlainName(name)) return 2;
  return PlainName(text) == PlainName(name) ? 1 : 0;
}

std::optional<double> MessageReader::NumberOf(const JsonNode& node, std::string_view expected) {
  if (node.is_number()) return node.number;
  if (node.is_string()) {
    if (const std::optional<double> number = NumberOfText(node.text)) {
      Note(Lenience::kNumberAsString, node);
      return number;
    }
  }
  Fail(node, expected);
  return std::nullopt;
}

void MessageReader::ReadValue(const JsonNode& node, bool& value, const NumberRange& /*range*/) {
  if (node.is_boolean()) {
    value = node.is_true();
    return;
  }
  if (node.is_number() && (node.number == 0.0 || node.number == 1.0)) {
    value = node.number == 1.0;
    return Note(Lenience::kBooleanAsNumber, node);
  }
  const std::string plain = node.is_string() ? PlainName(node.text) : "";
  if (plain != "TRUE" && plain != "FALSE") return Fail(node, "true or false");
  value = plain == "TRUE";
  Note(Lenience::kBooleanAsString, node);
}

void MessageReader::ReadValue(const JsonNode& node, double& value, const NumberRange& range) {
  const std::optional<double> number = NumberOf(node, RangeText(range));
  if (!number) return;
  value = *number;
  if (value >= range.min && value <= range.max) return;
  // More turns than these have no exact remainder.
  if (!range.is_angle || std::fabs(value) > 1e6) return Fail(node, RangeText(range));
  value = std::remainder(value, 2.0 * 3.14159265358979323846);
  Note(Lenience::kAngleOutOfRange, node);
}

void MessageReader::ReadValue(const JsonNode& node, std::uint32_t& value, const NumberRange& range) {
  constexpr double kMax = 4294967295.0;
  const NumberRange whole = {std::max(range.min, 0.0), std::min(range.max, kMax)};
  const std::string expected = "a whole " + RangeText(whole).substr(2);
  const std::optional<double> number = NumberOf(node, expected);
  if (!number) return;
  if (!(*number >= whole.min && *number <= whole.max) || *number != std::trunc(*number)) return Fail(node, expected);
  value = static_cast<std::uint32_t>(*number);
}

void MessageReader::ReadValue(const JsonNode& node, std::string& value, const NumberRange& /*range*/) {
  if (node.is_number()) {
    Note(Lenience::kStringAsNumber, node);
  } else if (!node.is_string()) {
    return Fail(node, "a string");
  }
  value = node.text;
}

void MessageReader::ReadValue(const JsonNode& node, ParameterValue& value, const NumberRange& /*range*/) {
  using Kind = ParameterValue::Kind;
  if (node.is_string()) {
    value = {Kind::kString, node.text};
    return;
  }
  if (node.kind == JsonNode::Kind::kNull) Note(Lenience::kNullForMissing, node);
  value.kind = node.is_number() ? Kind::kNumber : node.is_boolean() ? Kind::kBoolean : Kind::kJson;
  value.text.clear();
  AppendJson(node, value.text);
}

void MessageReader::ReadValue(const JsonNode& node, AllowedDeviation& value, const NumberRange& /*range*/) {
  if (node.is_object()) {
    if (!has_newer()) Note(Lenience::kOtherForm, node);
    const JsonNode* const outer = std::exchange(object_, &node);
    Need("a", value.a, kNotNegative);
    Need("b", value.b, kNotNegative);
    Need("theta", value.theta, {-1.570796327, 1.570796327});
    object_ = outer;
    return;
  }
  if (has_newer()) Note(Lenience::kOtherForm, node);
  double radius = 0.0;
  ReadValue(node, radius, kNotNegative);
  value = {radius, radius, 0.0};
}

void MessageReader::NeedTime(MemberName name, std::string& text) {
  const std::size_t faults = faults_.size();
  Need(name, text);
  if (faults_.size() > faults || (may_miss_ && text.empty())) return;
  const std::size_t length = Enter(name.older);
  if (version_ && !ParseTimestamp(text)) {
    FailWith("found the string '" + std::string(CutUtf8(text, 40)) +
             "', expected a time such as 2026-01-31T12:00:00.00Z");
  } else if (version_ && !text.ends_with('Z')) {
    NoteAt(Lenience::kTimestampForm, pointer_);
  }
  pointer_.resize(length);
}

void MessageReader::NeedVersion(MemberName name, std::string& text) {
  const std::size_t faults = faults_.size();
  Need(name, text);
  if (faults_.size() > faults || (may_miss_ && text.empty())) return;
  const std::size_t length = Enter(name.older);
  const std::optional<Version> found = FindVersion(text);
  if (version_ && (!found || IsBefore3(*found) != IsBefore3(*version_))) {
    FailWith("found the string '" + std::string(CutUtf8(text, 40)) + "', expected " + (has_newer() ? "3" : "2") +
             ".x.y");
  }
  pointer_.resize(length);
}

void MessageReader::Inline(Header& header) {
  ListMembers(*this, header);
}

void MessageReader::InlineOptional(Header& header) {
  may_miss_ = has_older();
  ListMembers(*this, header);
  may_miss_ = false;
}

template <typename Message>
Decoded<Message> Decode(std::string_view payload, Version version, const DecodeLimits& limits) {
  Decoded<Message> decoded;
  const Result<JsonTree> tree = JsonTree::Parse(payload, "", {limits.bytes, limits.values});
  if (!tree.ok()) {
    decoded.faults.push_back({"", tree.error().ToString()});
    return decoded;
  }
  MessageReader(version, decoded.faults, decoded.lenient).Read(tree.value().root(), decoded.message);
  return decoded;
}

template <typename Message>
std::string Encode(const Message& message, Version version) {
  std::string text;
  MessageWriter(version, text).Write(message);
  return text;
}

template Decoded<Order> Decode(std::string_view, Version, const DecodeLimits&);
template Decoded<InstantActions> Decode(std::string_view, Version, const DecodeLimits&);
template Decoded<State> Decode(std::string_view, Version, const DecodeLimits&);
template Decoded<Connection> Decode(std::string_view, Version, const DecodeLimits&);
template Decoded<Visualization> Decode(std::string_view, Version, const DecodeLimits&);
template Decoded<Factsheet> Decode(std::string_view, Version, const DecodeLimits&);
template Decoded<ZoneSet> Decode(std::string_view, Version, const DecodeLimits&);
template Decoded<Responses> Decode(std::string_view, Version, const DecodeLimits&);
template std::string Encode(const Order&, Version);
template std::string Encode(const InstantActions&, Version);
template std::string Encode(const State&, Version);
template std::string Encode(const Connection&, Version);
template std::string Encode(const Visualization&, Version);
template std::string Encode(const Factsheet&, Version);
template std::string Encode(const ZoneSet&, Version);
template std::string Encode(const Responses&, Version);

}  // namespace troupe::fleet
