#include "common/spatial/robot_index.h"
