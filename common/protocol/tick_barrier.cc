#include "common/protocol/tick_barrier.h"
