#include "common/spatial/static_index.h"
