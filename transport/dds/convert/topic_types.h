// The types of our topics (idl/), made known to the binding.
#pragma once

#include "idl/admission.h"
#include "idl/control.h"
#include "idl/frame.h"
#include "idl/frame_request.h"
#include "idl/history.h"
#include "idl/join.h"
#include "idl/proposal.h"
#include "idl/session.h"
#include "idl/status.h"
#include "transport/dds/binding/topic.h"

TROUPE_DDS_TYPE(troupe_wire_Admissions);
TROUPE_DDS_TYPE(troupe_wire_Control);
TROUPE_DDS_TYPE(troupe_wire_ControlReply);
TROUPE_DDS_TYPE(troupe_wire_Frame);
TROUPE_DDS_TYPE(troupe_wire_FrameRequest);
TROUPE_DDS_TYPE(troupe_wire_History);
TROUPE_DDS_TYPE(troupe_wire_Join);
TROUPE_DDS_TYPE(troupe_wire_Proposal);
TROUPE_DDS_TYPE(troupe_wire_Session);
TROUPE_DDS_TYPE(troupe_wire_Status);
