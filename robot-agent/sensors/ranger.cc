#include "robot-agent/sensors/ranger.h"
