#include "robot-agent/drive/odometry.h"
