// MessageReader: the archive (message_layout.h) that reads a message from a JSON tree, with the leniencies of codec.h.
//
// It is at one object at a time. Reading goes on after a fault, so that several are found at once.
#pragma once

#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/base/json_tree.h"
#include "fleet/codec.h"
#include "fleet/message_layout.h"
#include "fleet/message_names.h"

namespace troupe::fleet {

class MessageReader {
 public:
  // Without a version: what a MessageWriter without one has written.
  MessageReader(std::optional<Version> version, std::vector<MessageFault>& faults, std::vector<LenientPlace>& lenient)
      : version_(version), faults_(faults), lenient_(lenient) {}

  template <typename Row>
  void Read(const JsonNode& node, Row& row) {
    if (!node.is_object()) return Fail(node, "an object");
    const JsonNode* const outer = std::exchange(object_, &node);
    ListMembers(*this, row);
    object_ = outer;
  }

  bool has_older() const { return !version_ || IsBefore3(*version_); }
  bool has_newer() const { return !version_ || !IsBefore3(*version_); }

  template <typename Value>
  void Need(MemberName name, Value& value, const NumberRange& range = {}) {
    if (const JsonNode* const member = Find(name)) {
      ReadMember(*member, value, range);
    } else {
      Miss(name);
    }
  }
  template <typename Value>
  void May(MemberName name, std::optional<Value>& value, const NumberRange& range = {}) {
    const JsonNode* const member = Find(name);
    if (member == nullptr) return;
    if (member->kind == JsonNode::Kind::kNull) return Note(Lenience::kNullForMissing, *member);
    ReadMember(*member, value.emplace(), range);
  }
  template <typename Value>
  void NeedOptional(MemberName name, std::optional<Value>& value, const NumberRange& range = {}) {
    Need(name, value.emplace(), range);
  }
  // Before 3.0 it has to be there.
  template <typename Value>
  void MaySince3(MemberName name, std::optional<Value>& value, const NumberRange& range = {}) {
    if (has_newer()) {
      May(name, value, range);
    } else {
      NeedOptional(name, value, range);
    }
  }
  // Before 3.0 it may be missing.
  template <typename Value>
  void NeedSince3(MemberName name, Value& value, const NumberRange& range = {}) {
    if (has_newer() || Find(name) != nullptr) Need(name, value, range);
  }
  template <typename Value>
  void NeedList(MemberName name, std::vector<Value>& list) {
    const JsonNode* const member = Find(name);
    if (member == nullptr) return NoteMissing(name);
    if (member->kind == JsonNode::Kind::kNull) return Note(Lenience::kNullForMissing, *member);
    ReadMember(*member, list, {});
  }
  void NeedTime(MemberName name, std::string& text);
  void NeedVersion(MemberName name, std::string& text);
  void Inline(Header& header);
  // Before 3.0 any of its members may be missing.
  void InlineOptional(Header& header);
  template <typename List>
  void Nested(MemberName name, const List& list) {
    const JsonNode* const member = Find(name);
    if (member == nullptr) return Miss(name);
    const std::size_t length = Enter(member->key);
    if (member->is_object()) {
      const JsonNode* const outer = std::exchange(object_, member);
      list(*this);
      object_ = outer;
    } else {
      Fail(*member, "an object");
    }
    pointer_.resize(length);
  }

 private:
  // The member of that name, or of the name that another version has for it.
  const JsonNode* Find(MemberName name);
  void Miss(MemberName name);
  void NoteMissing(MemberName name);
  void Note(Lenience lenience, const JsonNode& node);
  void NoteAt(Lenience lenience, std::string pointer);
  void Fail(const JsonNode& node, std::string_view expected);
  void FailWith(std::string text);
  std::size_t Enter(std::string_view segment);

  template <typename Value>
  void ReadMember(const JsonNode& node, Value& value, const NumberRange& range) {
    const std::size_t length = Enter(node.key);
    ReadValue(node, value, range);
    pointer_.resize(length);
  }

  void ReadValue(const JsonNode& node, bool& value, const NumberRange& range);
  void ReadValue(const JsonNode& node, double& value, const NumberRange& range);
  void ReadValue(const JsonNode& node, std::uint32_t& value, const NumberRange& range);
  void ReadValue(const JsonNode& node, std::string& value, const NumberRange& range);
  void ReadValue(const JsonNode& node, ParameterValue& value, const NumberRange& range);
  void ReadValue(const JsonNode& node, AllowedDeviation& value, const NumberRange& range);
  template <NamedEnum Value>
  void ReadValue(const JsonNode& node, Value& value, const NumberRange& /*range*/) {
    if (node.is_string()) {
      for (std::size_t i = 0; i < NamesOf(Value()).size(); ++i) {
        const Value each = static_cast<Value>(i);
        const int likeness =
            LikenessOf(node.text, NameOf(each), version_ ? TextOf(each, *version_) : std::string(NameOf(each)));
        if (likeness == 0) continue;
        if (likeness == 1) Note(Lenience::kEnumerationSpelling, node);
        value = each;
        return;
      }
    }
    std::string names;
    for (const std::string& name : AllNames<Value>()) names += (names.empty() ? "" : ", ") + name;
    Fail(node, "one of " + names);
  }
  template <typename Value>
  void ReadValue(const JsonNode& node, std::vector<Value>& list, const NumberRange& range) {
    if (!node.is_array()) return Fail(node, "an array");
    list.clear();
    list.reserve(node.items.size());
    for (std::size_t i = 0; i < node.items.size(); ++i) {
      if (faults_.size() >= kMaxMessageFaults) return;
      const std::size_t length = Enter(std::to_string(i));
      ReadValue(node.items[i], list.emplace_back(), range);
      pointer_.resize(length);
    }
  }
  template <typename Row>
  requires std::is_class_v<Row>
  void ReadValue(const JsonNode& node, Row& row, const NumberRange& /*range*/) { Read(node, row); }

  // The number of a node, or of a string; nothing, which is a fault, if it is none.
  std::optional<double> NumberOf(const JsonNode& node, std::string_view expected);
  // 2: the text is a value's in this version. 1: but for case and underscores, or in another version. 0: it is not.
  static int LikenessOf(std::string_view text, std::string_view name, std::string_view expected);

  std::optional<Version> version_;
  std::vector<MessageFault>& faults_;
  std::vector<LenientPlace>& lenient_;
  const JsonNode* object_ = nullptr;
  std::string pointer_;
  bool may_miss_ = false;
};

}  // namespace troupe::fleet
