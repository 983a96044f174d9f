#include "robot-agent/agent/robot.h"
