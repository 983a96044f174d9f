#include "transport/dds/binding/exception.h"

namespace troupe::dds {

Exception::Exception(dds_return_t code, const std::string& doing)
    : std::runtime_error("DDS: " + std::string(dds_strretcode(code)) + " while " + doing), code_(code) {}

}  // namespace troupe::dds
