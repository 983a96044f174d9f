#include "common/spatial/overlap.h"
