// The messages between a launcher and `troupe host` on another host: one JSON object a line.
//
// To the host, on its standard input; the end of the input terminates all processes that were started:
//   {"start": id, "program": name, "arguments": [..], "reports": bool}    {"signal": id, "number": n}    {"read": path}
//   {"run": name}    first: a host of that name whose connection was cut, and which has not noticed, is to end
//   {"key": path, "data": hexadecimal}    a file below the host's folder of keys
// From the host, on its standard output:
//   {"host": version, "folder": path, "programs": path}         first; the folder is for output, and is deleted at the
//   end
//   {"started": id, "pid": n}    {"failed": id, "message": text}
//   {"output": line}    {"report": line}
//   {"ended": id, "exit_code": n, "signal": n, "peak_memory_mib": x}      after all of its lines
//   {"file": path, "data": hexadecimal}    {"file": path, "end": true}    {"file": path, "error": text}
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace troupe {

// The folder of keys in the host's folder.
inline constexpr const char* kKeysFolderOfHost = "keys";

using HostMessage = nlohmann::json;

// One line with its end. Bytes that are not UTF-8 are replaced.
std::string ToLine(const HostMessage& message);

// The result is not an object if the line is not a message.
HostMessage ParseHostMessage(const std::string& line);

}  // namespace troupe
