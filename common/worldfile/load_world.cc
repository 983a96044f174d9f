#include "common/worldfile/load_world.h"
