// The types of the channels of a recording (idl/), made known to transport/wire. Private to this folder.
#pragma once

#include "idl/recorded_edit.h"
#include "idl/recorded_run.h"
#include "idl/recorded_tick.h"
#include "transport/dds/convert/topic_types.h"

TROUPE_DDS_TYPE(troupe_wire_RecordedEdit);
TROUPE_DDS_TYPE(troupe_wire_RecordedRun);
TROUPE_DDS_TYPE(troupe_wire_RecordedTick);
