#include "world-service/core/validate_proposal.h"
