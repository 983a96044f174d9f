#include "common/dds/dds_transport.h"
