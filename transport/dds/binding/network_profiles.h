// Cyclone's configurations (configs/cyclone, compiled in), with words between at signs for ToXml to fill in.
#pragma once

namespace troupe::dds {

extern const char* const kOneHostProfile;
extern const char* const kLanProfile;
extern const char* const kUnicastProfile;

}  // namespace troupe::dds
