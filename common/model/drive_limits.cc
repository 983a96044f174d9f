#include "common/model/drive_limits.h"
