#include "launcher/commands/check_controllers.h"

#include "robot-agent/controller/create_controller.h"
#include "worldfile/scenario/scenario.h"

namespace troupe {

Status CheckControllers(const std::string& file, const std::optional<std::string>& controller) {
  if (controller) {
    if (const Status status = CheckController(*controller, "{}"); !status.ok()) {
      return Error{{}, "option --controller: " + status.error().message};
    }
  }
  LoadOverrides overrides;
  overrides.check_controller = CheckController;
  return file.ends_with(".json") ? CheckScenario(file, overrides) : Status();
}

}  // namespace troupe
