// The names of Unix sockets that leave no file behind.
#pragma once

#include <string>

#include "troupe/result.h"

namespace troupe::ros {

// Sockets with close-on-exec that do not wait. `name`: without a leading zero; at most 107 characters. The errors are
// for people.
Result<int> Bind(const std::string& name);  // no connection succeeds before listen()
Result<int> Connect(const std::string& name);
// Of a listening socket; -1: none is waiting, or it belongs to another user.
int Accept(int listening);

}  // namespace troupe::ros
