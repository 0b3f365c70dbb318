#pragma once
// Reading structs and text that another compiler, version or author wrote.

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <string>

#include "plugin.h"

namespace brume::abi {

/// The size a struct had when ABI 1 was first published: no plugin knows a smaller one.
/// A field added later goes to the end of its struct and leaves this number alone.
template <class T>
inline constexpr std::size_t kFirstSize = sizeof(T);
template <>
inline constexpr std::size_t kFirstSize<brume_stage> = offsetof(brume_stage,
                                                                baseline_name);
template <>
inline constexpr std::size_t kFirstSize<brume_param> = offsetof(brume_param, curve);
template <>
inline constexpr std::size_t kFirstSize<brume_medium> = offsetof(brume_medium, tint);

/// A copy of a struct whose writer may know fewer or more fields than we do: fields that
/// it does not know are zero. The caller has checked that `from->size >= kFirstSize<T>`.
template <class T>
T copy(const T* from) {
  T to{};
  std::memcpy(&to, from, std::min(from->size, sizeof(T)));
  to.size = sizeof(T);
  return to;
}

/// An enum's value as the plugin wrote it, which may be none of the enum's.
template <class E>
int raw(const E& e) {
  static_assert(sizeof(E) == sizeof(int));
  int i;
  std::memcpy(&i, &e, sizeof i);
  return i;
}
template <class E>
bool within(const E& e, E last) {
  return raw(e) >= 0 && raw(e) <= int(last);
}

/// Text of a plugin for a message or a name: one line, at most `longest` bytes (what is
/// cut ends in "..."), broken UTF-8 and control characters as '?'; null is "". Reads no
/// further than `longest`.
std::string text(const char*, std::size_t longest = 400);

/// The size a reader should expect, for messages: "brume_stage of 24 bytes; at least
/// 112".
std::string too_small(const char* type, std::size_t found, std::size_t expected);

}  // namespace brume::abi
