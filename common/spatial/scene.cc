#include "common/spatial/scene.h"
