// The two documents of DDS Security 1.1, before they are signed: the rules of the simulation domain, which are the same
// for all participants, and the permissions of one participant.
#pragma once

#include <string>

#include "transport/security/role.h"
#include "transport/security/validity.h"

namespace troupe {

std::string GovernanceDocument();

// `subject`: that of the participant's certificate, as "CN=name". All that is not allowed is denied.
std::string PermissionsDocument(const Role& role, const std::string& subject, const Validity& validity);

}  // namespace troupe
