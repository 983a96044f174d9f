#include "launcher/check_controllers.h"

#include "common/worldfile/scenario.h"
#include "robot-agent/controller/create_controller.h"

namespace troupe {

Status CheckControllers(const std::string& file, const std::string& controller) {
  if (!controller.empty()) {
    if (std::string fault = CheckController(controller, "{}"); !fault.empty()) {
      return Error{{}, "option --controller: " + fault};
    }
  }
  if (!file.ends_with(".json")) return std::nullopt;
  LoadOverrides overrides;
  overrides.check_controller = CheckController;
  return CheckScenario(file, overrides);
}

}  // namespace troupe
