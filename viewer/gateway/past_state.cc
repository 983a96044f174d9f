#include "viewer/gateway/past_state.h"

#include "viewer/gateway/world_message.h"

namespace troupe {

std::shared_ptr<const ViewedWorld> MakeViewedWorld(const SessionMessage& session, std::uint32_t number) {
  auto world = std::make_shared<ViewedWorld>();
  world->number = number;
  world->run = session.run;
  world->edition = session.world_edition;
  world->message = std::make_shared<const std::string>(EncodeWorld(session, number));
  world->scene = std::make_shared<const Scene>(session.world);
  return world;
}

std::size_t SizeOf(const PastState& past) {
  return sizeof past - sizeof past.state + MemoryOf(past.state);
}

}  // namespace troupe
