#include "world-service/core/step.h"
