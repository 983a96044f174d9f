#include "common/protocol/faulty_transport.h"
