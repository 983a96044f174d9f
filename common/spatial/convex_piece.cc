#include "common/spatial/convex_piece.h"
