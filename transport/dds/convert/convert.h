// All converters between messages (transport/protocol/messages.h) and the types on the wire (idl/).
#pragma once

#include "transport/dds/convert/convert_admission.h"
#include "transport/dds/convert/convert_control.h"
#include "transport/dds/convert/convert_frame.h"
#include "transport/dds/convert/convert_frame_request.h"
#include "transport/dds/convert/convert_history.h"
#include "transport/dds/convert/convert_join.h"
#include "transport/dds/convert/convert_proposal.h"
#include "transport/dds/convert/convert_robot_command.h"
#include "transport/dds/convert/convert_session.h"
#include "transport/dds/convert/convert_status.h"
