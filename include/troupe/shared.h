// Shared: a value that its copies share, so that a copy costs nothing. It never changes; Change() gives its owner a
// copy of its own first.
//
// For large constant parts of rows that are copied often: geometry of scans, lists of rays. Equality compares the
// pointers first, then the values, so that sharing never changes a result. A default value is one shared empty object:
// no allocation.
#pragma once

#include <initializer_list>
#include <memory>
#include <utility>

namespace troupe {

template <typename T>
class Shared {
 public:
  Shared() : value_(Empty()) {}
  Shared(T value) : value_(std::make_shared<const T>(std::move(value))) {}  // NOLINT(google-explicit-constructor)
  // The elements of a list.
  template <typename List = T>
  Shared(std::initializer_list<typename List::value_type> elements) : Shared(T(elements)) {}
  // REQUIRES: value != nullptr
  Shared(std::shared_ptr<const T> value) : value_(std::move(value)) {}  // NOLINT(google-explicit-constructor)

  const T& operator*() const { return *value_; }
  const T* operator->() const { return value_.get(); }
  operator const T&() const { return *value_; }  // NOLINT(google-explicit-constructor)

  // Valid until the next Change, copy or assignment of this.
  T& Change() {
    const auto own = std::make_shared<T>(*value_);
    value_ = own;
    return *own;
  }

  friend bool operator==(const Shared& a, const Shared& b) { return a.value_ == b.value_ || *a.value_ == *b.value_; }
  friend bool operator==(const Shared& a, const T& b) { return *a.value_ == b; }

 private:
  static const std::shared_ptr<const T>& Empty() {
    static const auto empty = std::make_shared<const T>();
    return empty;
  }

  std::shared_ptr<const T> value_;  // never null
};

}  // namespace troupe
