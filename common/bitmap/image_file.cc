#include "common/bitmap/image_file.h"
