#include "robot-agent/controller/create_controller.h"
