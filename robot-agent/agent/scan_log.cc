#include "robot-agent/agent/scan_log.h"
