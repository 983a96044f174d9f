#include "robot-agent/drive/drive.h"
