#include "common/spatial/sweep.h"
