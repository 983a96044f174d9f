// Result<T>: a value, or one Error with its place in the user's input. For everything a user can get
// wrong; broken contracts inside the program are TROUPE_CHECK.
#pragma once

#include <cstdint>
#include <exception>
#include <optional>
#include <string>
#include <utility>
#include <variant>

#include "troupe/check.h"

namespace troupe {

// A place in a user's file. Lines and columns count from 1; 0 means unknown.
struct SourceLocation {
  std::string file;
  int line = 0;
  int column = 0;
};

// The exit status of a program follows from it: 2 for bad input, 3 for a failure.
enum class ErrorCode : std::uint8_t {
  kBadInput,      // the user's input is wrong: a file, an option, a request
  kMalformed,     // bad input: a file that a request names has an error at a place in its text
  kFailure,       // the input is good, but the work cannot be done: no memory, a lost service
  kNoRoom,        // a failure: the place that the input names is taken
  kOutputFailed,  // a failure, of writing an output file: a full disk
};

struct Error {
  SourceLocation where;
  std::string message;  // the text found, and the text expected
  ErrorCode code = ErrorCode::kBadInput;

  // "file:line:column: error: message", as one line without control characters; unknown parts of the place are left
  // out.
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

  // REQUIRES: !ok(). Of a temporary by value, so that no reference outlives it.
  const Error& error() const& {
    TROUPE_CHECK(!ok());
    return *std::get_if<Error>(&content_);
  }
  Error error() && {
    TROUPE_CHECK(!ok());
    return std::move(*std::get_if<Error>(&content_));
  }

 private:
  std::variant<T, Error> content_;
};

// The outcome of an operation that yields no value: success, or an error.
class [[nodiscard]] Status {
 public:
  Status() = default;                                // success
  Status(Error error) : error_(std::move(error)) {}  // NOLINT(google-explicit-constructor)

  bool ok() const { return !error_.has_value(); }

  // REQUIRES: !ok(). Of a temporary by value, so that no reference outlives it.
  const Error& error() const& {
    TROUPE_CHECK(!ok());
    return *error_;
  }
  Error error() && {
    TROUPE_CHECK(!ok());
    return std::move(*error_);
  }

 private:
  std::optional<Error> error_;
};

// What a user or a peer has asked for is wrong, at no place of a text.
inline Error BadInput(std::string message) {
  return {{}, std::move(message), ErrorCode::kBadInput};
}

// The code of the error is kFailure.
inline Error Failure(std::string message) {
  return {{}, std::move(message), ErrorCode::kFailure};
}

// The failure that an exception reports. Failed allocation says so in words.
Error FailureOf(const std::exception& exception);

}  // namespace troupe
