// The messages to the page: their bytes, the fields of rows, the rows of a state that changed, and the world.
//
// Binary and little-endian, because a world of ten thousand robots at 60 updates a second is too much for JSON. The
// fields of rows and their readers in TypeScript come from the field lists of the row types, so both sides cannot
// disagree; the layout has a version (kPageProtocol), and a page of another version is asked to reload.
//
// Numbers of poses are doubles as in the state, twists are floats: the page shows them and calculates nothing with
// them.
#pragma once

#include <array>
#include <concepts>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <vector>

#include "common/base/bytes.h"
#include "transport/protocol/messages.h"
#include "troupe/ids.h"
#include "troupe/pose.h"
#include "troupe/world_state.h"

namespace troupe {

// PageWriter: appends to the bytes of a message for the page.
class PageWriter : public ByteWriter<std::string> {
 public:
  using ByteWriter::ByteWriter;

  void WriteFlag(bool value) { Write(static_cast<std::uint8_t>(value ? 1 : 0)); }
  void WriteCount(std::size_t count) { Write(static_cast<std::uint32_t>(count)); }
  void WriteFloat(double value) { Write(static_cast<float>(value)); }
  // The index of an id, -1 for none.
  template <typename OptionalId>
  void WriteId(const OptionalId& id) {
    Write(id ? static_cast<std::int32_t>(id->index()) : std::int32_t{-1});
  }
  void WritePose(const Pose& pose) {
    for (const double number : {pose.x, pose.y, pose.z, pose.heading}) Write(number);
  }

  // A count whose value is known later. REQUIRES of FillCount: `place` is from ReserveCount.
  std::size_t ReserveCount() {
    WriteCount(0);
    return size() - sizeof(std::uint32_t);
  }
  void FillCount(std::size_t place, std::size_t count) { Replace(place, static_cast<std::uint32_t>(count)); }
};

// The fields of rows (troupe/fields.h) on the page: how each type of value is written, and the types and readers of the
// page (viewer/web/src/protocol.ts) for it. viewer/web/write_rows.cc makes the page's rows from them.

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
  static void Write(PageWriter& writer, Value value) { writer.Write(static_cast<std::uint8_t>(value)); }
};
template <>
struct PageValue<double> {
  static constexpr PageType kType = {"number", "r.f64()"};
  static void Write(PageWriter& writer, double value) { writer.Write(value); }
};
template <>
struct PageValue<std::uint32_t> {
  static constexpr PageType kType = {"number", "r.u32()"};
  static void Write(PageWriter& writer, std::uint32_t value) { writer.Write(value); }
};
template <>
struct PageValue<bool> {
  static constexpr PageType kType = {"boolean", "r.flag()"};
  static void Write(PageWriter& writer, bool value) { writer.WriteFlag(value); }
};
template <typename Tag>
struct PageValue<std::optional<Id<Tag>>> {
  static constexpr PageType kType = {"number", "r.i32()"};  // -1: none
  static void Write(PageWriter& writer, const std::optional<Id<Tag>>& id) { writer.WriteId(id); }
};
template <>
struct PageValue<Pose> {
  static constexpr PageType kType = {"Pose", "r.pose()"};
  static void Write(PageWriter& writer, const Pose& pose) { writer.WritePose(pose); }
};
template <>
struct PageValue<Twist> {
  static constexpr PageType kType = {"Twist", "r.twist()"};
  static void Write(PageWriter& writer, const Twist& twist) {
    writer.WriteFloat(twist.vx);
    writer.WriteFloat(twist.vy);
    writer.WriteFloat(twist.wz);
  }
};

// StateRows: the newest state of a world, row by row, with the number of the update that changed each row last. So the
// difference from any earlier update is known without keeping that state, for viewers that skip updates. Costs one
// comparison of each row per update, whatever the number of viewers.
class StateRows {
 public:
  // `number` grows with each call. `fresh`: another world; all rows have changed.
  void Assign(std::shared_ptr<const WorldState> state, std::uint64_t number, bool fresh);

  // Writes the rows that are on the page (kIsOnPage) and have changed after update `since`; 0: all.
  void Write(PageWriter& writer, std::uint64_t since) const;

 private:
  std::shared_ptr<const WorldState> state_ = std::make_shared<const WorldState>();
  // The update of the last change, by row; in the order of the fields of WorldState.
  std::array<std::vector<std::uint64_t>, std::tuple_size_v<decltype(kFields<WorldState>)>> changed_;
};

// The world message: the description of a world for the page, once for each edition.

// The first byte of each binary message to the page.
enum class PageMessage : std::uint8_t { kWorld = 1, kUpdate = 2 };

// Version of the layout of messages; the page refuses another one.
inline constexpr std::uint32_t kPageProtocol = 7;

// A dense bitmap is sent with at most this many pixels along each side; beyond that a pixel of the page stands for
// several, and is occupied if one of them is.
inline constexpr int kMaxArea = 2048;

// The bytes of the message. `number`: of the world, counted by the gateway; the updates of the world repeat it.
std::string EncodeWorld(const SessionMessage& session, std::uint32_t number);

}  // namespace troupe
