#include "common/model/world_description.h"
