#include "common/geometry/convex_partition.h"
