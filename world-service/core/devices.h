// The devices of robots that a step switches and turns: lights and cameras; and the texts that robots say. Private to
// this folder.
#pragma once

#include <span>

#include "common/model/proposal.h"
#include "world-service/core/step_workspace.h"

namespace troupe {

// Executes these parts of the proposals, and adds an event for each text. `by_robot`: the proposals by robot, null
// where there is none. REQUIRES: they are valid.
void OperateDevices(std::span<const Proposal* const> by_robot, StepWorkspace& workspace);

}  // namespace troupe
