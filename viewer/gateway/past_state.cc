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

EventNames NamesIn(const WorldDescription& world, const Event& event) {
  const auto name_of = [&](const std::optional<ModelId>& model) {
    return model && model->index() < world.models.size() ? world.model(*model).name : std::string();
  };
  const bool has_robot = event.robot && event.robot->index() < world.robots.size();
  return {has_robot ? world.robot(*event.robot).name : std::string(), name_of(event.other), name_of(event.object)};
}

std::size_t SizeOf(const PastState& past) {
  return sizeof past + MemoryOf(*past.state);
}

}  // namespace troupe
