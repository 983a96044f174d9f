#include "common/protocol/memory_transport.h"
