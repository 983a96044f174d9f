// A type with a key, made known to the binding.
#pragma once

#include "common/dds/binding/topic.h"
#include "tests/unit/dds/keyed_status.h"

TROUPE_DDS_TYPE(troupe_test_KeyedStatus);
