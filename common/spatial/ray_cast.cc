#include "common/spatial/ray_cast.h"
