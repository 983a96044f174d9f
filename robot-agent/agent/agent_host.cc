#include "robot-agent/agent/agent_host.h"
