// PastState: a committed state of a run, with the world that it belongs to.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "common/spatial/scene.h"
#include "transport/protocol/messages.h"

namespace troupe {

// The world of an edition, prepared for viewers.
struct ViewedWorld {
  std::uint32_t number = 0;  // counts the worlds of a feed or a recording from 1
  RunId run = 0;
  Edition edition = 0;                         // world_edition of its frames
  std::shared_ptr<const std::string> message;  // EncodeWorld
  std::shared_ptr<const Scene> scene;
};

// Makes the message and the scene.
std::shared_ptr<const ViewedWorld> MakeViewedWorld(const SessionMessage& session, std::uint32_t number);

struct PastState {
  std::uint64_t position = 0;  // past_states.h
  std::shared_ptr<const ViewedWorld> world;
  std::shared_ptr<const WorldState> state;
  std::uint64_t state_hash = 0;
  Edition edition = 0;
};

// The names of what an event is about. Empty: nothing.
struct EventNames {
  std::string robot;
  std::string other;
  std::string object;
};
EventNames NamesIn(const WorldDescription& world, const Event& event);

struct NumberedEvent {
  std::uint64_t number = 0;    // counts the events of a run or a recording from 1
  std::uint64_t position = 0;  // of its state
  Event event;
  EventNames names;  // in the world of the event: its ids may be those of others after an edit
};
inline constexpr std::size_t kEventsKept = 500;  // for viewers

// About as many bytes as it takes, without its world.
std::size_t SizeOf(const PastState& state);

}  // namespace troupe
