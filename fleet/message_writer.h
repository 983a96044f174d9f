// MessageWriter: the archive (message_layout.h) that writes a message as JSON.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/base/json_writer.h"
#include "fleet/codec.h"
#include "fleet/message_layout.h"
#include "fleet/message_names.h"

namespace troupe::fleet {

class MessageWriter {
 public:
  // Without a version: all members of all versions, with the values of the model, to keep them.
  MessageWriter(std::optional<Version> version, std::string& text) : version_(version), json_(text) {}

  template <typename Row>
  void Write(const Row& row) {
    json_.BeginObject();
    ListMembers(*this, row);
    json_.EndObject();
  }

  bool has_older() const { return !version_ || IsBefore3(*version_); }
  bool has_newer() const { return !version_ || !IsBefore3(*version_); }

  template <typename Value>
  void Need(MemberName name, const Value& value, const NumberRange& /*range*/ = {}) {
    json_.Key(has_newer() ? name.newer : name.older);
    WriteValue(value);
  }
  template <typename Value>
  void May(MemberName name, const std::optional<Value>& value, const NumberRange& /*range*/ = {}) {
    if (value) Need(name, *value);
  }
  template <typename Value>
  void NeedOptional(MemberName name, const std::optional<Value>& value, const NumberRange& /*range*/ = {}) {
    May(name, value);
  }
  template <typename Value>
  void MaySince3(MemberName name, const std::optional<Value>& value, const NumberRange& /*range*/ = {}) {
    May(name, value);
  }
  template <typename Value>
  void NeedSince3(MemberName name, const Value& value, const NumberRange& /*range*/ = {}) {
    Need(name, value);
  }
  template <typename Value>
  void NeedList(MemberName name, const std::vector<Value>& list) {
    Need(name, list);
  }
  void NeedTime(MemberName name, const std::string& text) { Need(name, text); }
  void NeedVersion(MemberName name, const std::string& text) { Need(name, text); }
  void Inline(const Header& header) { ListMembers(*this, header); }
  void InlineOptional(const Header& header) { Inline(header); }
  template <typename List>
  void Nested(MemberName name, const List& list) {
    json_.Key(name.newer).BeginObject();
    list(*this);
    json_.EndObject();
  }

 private:
  void WriteValue(bool flag) { json_.Value(flag); }
  void WriteValue(double number) { json_.Value(number); }
  void WriteValue(std::uint32_t number) { json_.Raw(std::to_string(number)); }
  void WriteValue(const std::string& text) { json_.Value(text); }
  void WriteValue(const ParameterValue& value) {
    if (value.kind == ParameterValue::Kind::kString) {
      json_.Value(value.text);
    } else {
      json_.Raw(value.text);
    }
  }
  void WriteValue(const AllowedDeviation& deviation) {
    if (!has_newer()) return WriteValue(std::min(deviation.a, deviation.b));
    json_.BeginObject();
    json_.Member("a", deviation.a).Member("b", deviation.b).Member("theta", deviation.theta);
    json_.EndObject();
  }
  template <NamedEnum Value>
  void WriteValue(Value value) {
    json_.Value(version_ ? TextOf(value, *version_) : std::string(NameOf(value)));
  }
  template <typename Value>
  void WriteValue(const std::vector<Value>& list) {
    json_.BeginList();
    for (const Value& value : list) WriteValue(value);
    json_.EndList();
  }
  template <typename Row>
  requires std::is_class_v<Row>
  void WriteValue(const Row& row) { Write(row); }

  std::optional<Version> version_;
  JsonWriter json_;
};

}  // namespace troupe::fleet
