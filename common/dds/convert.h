// All converters between messages (common/protocol/messages.h) and what travels (idl/).
#pragma once

#include "common/dds/convert_admission.h"
#include "common/dds/convert_control.h"
#include "common/dds/convert_frame.h"
#include "common/dds/convert_join.h"
#include "common/dds/convert_proposal.h"
#include "common/dds/convert_session.h"
#include "common/dds/convert_status.h"
