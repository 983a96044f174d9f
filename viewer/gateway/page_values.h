// The fields of rows (troupe/fields.h) on the page: how each type of value is written, and the types and readers of the
// page (viewer/web/src/protocol.ts) for it. viewer/web/write_rows.cc makes the page's rows from them.
#pragma once

#include <optional>
#include <type_traits>

#include "troupe/ids.h"
#include "troupe/pose.h"
#include "troupe/world_state.h"
#include "viewer/gateway/byte_writer.h"

namespace troupe {

// The rows that the page shows. Of the others, transmissions are no rows by id, and former velocities explain nothing.
template <typename Row>
inline constexpr bool kIsOnPage = !std::is_same_v<Row, ImuState> && !std::is_same_v<Row, RadioTransmission>;

struct PageType {
  const char* type;
  const char* read;  // a call of its Reader
};

template <typename Value>
struct PageValue {
  static_assert(std::is_enum_v<Value>, "the page has no type for a field");
  static constexpr PageType kType = {"number", "r.u8()"};
  static void Write(ByteWriter& writer, Value value) { writer.Write(static_cast<std::uint8_t>(value)); }
};
template <>
struct PageValue<double> {
  static constexpr PageType kType = {"number", "r.f64()"};
  static void Write(ByteWriter& writer, double value) { writer.Write(value); }
};
template <>
struct PageValue<bool> {
  static constexpr PageType kType = {"boolean", "r.flag()"};
  static void Write(ByteWriter& writer, bool value) { writer.WriteByte(value); }
};
template <typename Tag>
struct PageValue<std::optional<Id<Tag>>> {
  static constexpr PageType kType = {"number", "r.i32()"};  // -1: none
  static void Write(ByteWriter& writer, const std::optional<Id<Tag>>& id) { writer.WriteId(id); }
};
template <>
struct PageValue<Pose> {
  static constexpr PageType kType = {"Pose", "r.pose()"};
  static void Write(ByteWriter& writer, const Pose& pose) { writer.WritePose(pose); }
};
template <>
struct PageValue<Twist> {
  static constexpr PageType kType = {"Twist", "r.twist()"};
  static void Write(ByteWriter& writer, const Twist& twist) {
    writer.WriteFloat(twist.vx);
    writer.WriteFloat(twist.vy);
    writer.WriteFloat(twist.wz);
  }
};

}  // namespace troupe
