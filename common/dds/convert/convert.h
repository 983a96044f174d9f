// All converters between messages (common/protocol/messages.h) and the types on the wire (idl/).
#pragma once

#include "common/dds/convert/convert_admission.h"
#include "common/dds/convert/convert_control.h"
#include "common/dds/convert/convert_frame.h"
#include "common/dds/convert/convert_frame_request.h"
#include "common/dds/convert/convert_history.h"
#include "common/dds/convert/convert_join.h"
#include "common/dds/convert/convert_proposal.h"
#include "common/dds/convert/convert_robot_command.h"
#include "common/dds/convert/convert_session.h"
#include "common/dds/convert/convert_status.h"
