#pragma once
// Documentation that a program writes: a test fails when a file is stale, and rewrites it
// when BRUME_UPDATE_GENERATED is 1.

#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>
#include <string_view>

#include "params/document.h"

namespace brume::test {

inline std::string read_file(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

/// The part NAME of `file` (below the source folder) is `text`.
inline void expect_generated(const std::string& file, std::string_view name,
                             std::string_view text) {
  const std::string path = std::string(BRUME_SOURCE_DIR) + "/" + file;
  const std::string now = read_file(path), fresh = replace_generated(now, name, text);
  if (now == fresh) return;
  const char* update = std::getenv("BRUME_UPDATE_GENERATED");
  if (update && std::string_view(update) == "1")
    std::ofstream(path, std::ios::binary) << fresh;
  else
    ADD_FAILURE() << file << ": \"" << name
                  << "\" is stale; write it anew with BRUME_UPDATE_GENERATED=1";
}

}  // namespace brume::test
