#include "world-service/service/run_service.h"
