// Quoting of words and command lines for a shell.
#pragma once

#include <map>
#include <string>
#include <vector>

namespace troupe {

// A word as a shell reads it.
std::string ShellQuoted(const std::string& word);

// A command line for a shell.
std::string ShellQuoted(const std::vector<std::string>& words);

// `text` with each "{name}" of `values` replaced by its value; other braces stay.
std::string FillIn(const std::string& text, const std::map<std::string, std::string>& values);

}  // namespace troupe
