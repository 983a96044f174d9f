// A type with a key, made known to the binding.
#pragma once

#include "tests/unit/transport/dds/binding/keyed_status.h"
#include "transport/dds/binding/domain_participant.h"

TROUPE_DDS_TYPE(troupe_test_KeyedStatus);
