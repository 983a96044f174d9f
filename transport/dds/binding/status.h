// Communication statuses, named as in the C++ PSM.
#pragma once

#include <dds/dds.h>

namespace troupe::dds {

using PublicationMatchedStatus = dds_publication_matched_status_t;
using SubscriptionMatchedStatus = dds_subscription_matched_status_t;
using LivelinessChangedStatus = dds_liveliness_changed_status_t;
using OfferedIncompatibleQosStatus = dds_offered_incompatible_qos_status_t;
using RequestedIncompatibleQosStatus = dds_requested_incompatible_qos_status_t;

}  // namespace troupe::dds
