#pragma once
// What holds whatever the bytes are; where it does not, the fuzzer has found something.

#include <cstdlib>
#include <string_view>

#include "num/error.h"

inline void expect(bool good) {
  if (!good) std::abort();
}

/// What a user is told is one line, of a length that can be read.
inline void one_line(const brume::Error& e) {
  const std::string_view said = e.what();
  expect(said.find_first_of(std::string_view("\n\r\0", 3)) == said.npos);
  expect(said.size() < 1000);
}
