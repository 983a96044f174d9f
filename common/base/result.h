// Result<T>: a value, or one Error that says where in the user's input it was found. For everything a user can get
// wrong; broken contracts inside the program are TROUPE_CHECK.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <variant>

#include "common/base/check.h"

namespace troupe {

// A place in a user's file. Lines and columns count from 1; 0 means unknown.
struct SourceLocation {
  std::string file;
  int line = 0;
  int column = 0;
};

struct Error {
  SourceLocation where;
  std::string message;  // what was found, and what was expected

  // "file:line:column: error: message"; unknown parts of the place are left out.
  std::string ToString() const;
};

// Something the user should know that does not stop the run.
struct Warning {
  SourceLocation where;
  std::string message;

  std::string ToString() const;
};

template <typename T>
class [[nodiscard]] Result {
 public:
  Result(T value) : content_(std::move(value)) {}      // NOLINT(google-explicit-constructor)
  Result(Error error) : content_(std::move(error)) {}  // NOLINT(google-explicit-constructor)

  bool ok() const { return std::holds_alternative<T>(content_); }

  // REQUIRES: ok()
  T& value() & {
    TROUPE_CHECK(ok());
    return *std::get_if<T>(&content_);
  }
  const T& value() const& {
    TROUPE_CHECK(ok());
    return *std::get_if<T>(&content_);
  }
  T&& value() && {
    TROUPE_CHECK(ok());
    return std::move(*std::get_if<T>(&content_));
  }

  // REQUIRES: !ok()
  const Error& error() const {
    TROUPE_CHECK(!ok());
    return *std::get_if<Error>(&content_);
  }

 private:
  std::variant<T, Error> content_;
};

// The outcome of something that yields no value: nothing, or an error.
using Status = std::optional<Error>;

}  // namespace troupe
