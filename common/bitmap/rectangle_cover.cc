#include "common/bitmap/rectangle_cover.h"
