#include "common/geometry/polygon.h"
