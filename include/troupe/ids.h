// Ids: indices into the arrays of a world description, one type for each kind so that they cannot be mixed up.
// "None" is std::optional, never a special value.
//
// Ids are dense. An edit that removes a model leaves it in its table, marked as removed, so that the ids in commands,
// controllers and states keep their meaning. The order of ids is the order of the world file and decides wherever
// results could depend on an order. An id says nothing about existence; a peer's ids are checked before use
// (FieldCheck).
#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <optional>

namespace troupe {

template <typename Tag>
class Id {
 public:
  // An id that is still to be set: its index is beyond every array.
  constexpr Id() = default;
  // An index of 2^32 - 1 or more, which no array has, gives such an id, and never that of something else.
  constexpr explicit Id(std::size_t index) : index_(index < kUnset ? static_cast<std::uint32_t>(index) : kUnset) {}
  constexpr std::size_t index() const { return index_; }
  constexpr auto operator<=>(const Id&) const = default;

 private:
  static constexpr std::uint32_t kUnset = 0xffffffff;

  std::uint32_t index_ = kUnset;
};

template <typename Value>
inline constexpr bool kIsId = false;
template <typename Tag>
inline constexpr bool kIsId<Id<Tag>> = true;
template <typename Value>
inline constexpr bool kIsOptionalId = false;
template <typename Tag>
inline constexpr bool kIsOptionalId<std::optional<Id<Tag>>> = true;

using ModelId = Id<struct ModelTag>;      // in WorldDescription::models
using RobotId = Id<struct RobotTag>;      // in WorldDescription::robots and WorldState::robots
using ShapeId = Id<struct ShapeTag>;      // in WorldDescription::shapes
using JointId = Id<struct JointTag>;      // in WorldDescription::joints and WorldState::joints
using GripperId = Id<struct GripperTag>;  // in WorldDescription::grippers and WorldState::grippers
using BodyId = Id<struct BodyTag>;        // moving bodies: robots, then objects, then people (common/spatial/scene.h)
using ObjectId = Id<struct ObjectTag>;    // in WorldDescription::objects and WorldState::objects
using PersonId = Id<struct PersonTag>;    // in WorldDescription::people and WorldState::people

// Tick n is simulated time n * interval. Tick 0 is the world as loaded.
using Tick = std::uint64_t;

}  // namespace troupe
