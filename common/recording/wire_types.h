// The types of the channels of a recording (idl/), made known to common/wire. Private to this folder.
#pragma once

#include "common/dds/convert/topic_types.h"
#include "idl/recorded_edit.h"
#include "idl/recorded_run.h"
#include "idl/recorded_tick.h"

TROUPE_DDS_TYPE(troupe_wire_RecordedEdit);
TROUPE_DDS_TYPE(troupe_wire_RecordedRun);
TROUPE_DDS_TYPE(troupe_wire_RecordedTick);
