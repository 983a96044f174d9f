// What a launcher and `troupe host` on another machine say to each other: a JSON object a line.
//
// To the host, on its standard input; its end means that the launcher is gone, and with it goes all that was started:
//   {"start": id, "program": name, "arguments": [..], "reports": bool}    {"signal": id, "number": n}    {"read": path}
// From the host, on its standard output:
//   {"host": version, "folder": path, "programs": path}         first; the folder is for output, and ends with the host
//   {"started": id, "pid": n}    {"failed": id, "message": text}
//   {"output": line}    {"report": line}
//   {"ended": id, "exit_code": n, "signal": n, "peak_memory_mib": x}      after all that it said
//   {"file": path, "data": hexadecimal}    {"file": path, "end": true}    {"file": path, "error": text}
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace troupe {

using FarMessage = nlohmann::json;

// A line, ended. Bytes that are no UTF-8 are replaced.
std::string ToLine(const FarMessage& message);

// Not an object: it is none.
FarMessage ParseFarMessage(const std::string& line);

std::string ToHexadecimal(const char* data, std::size_t size);
std::string FromHexadecimal(const std::string& text);

// All of it, waiting if need be. False: nobody reads there any more.
bool WriteAll(int descriptor, const std::string& text);

}  // namespace troupe
