#pragma once
// Columns of text.

#include <algorithm>
#include <string>
#include <vector>

namespace brume::cli {

/// Rows in columns as wide as their widest cell, two spaces between, indented.
inline std::string table(const std::vector<std::vector<std::string>>& rows,
                         int indent = 2) {
  std::vector<std::size_t> widths;
  for (const auto& row : rows)
    for (std::size_t i = 0; i < row.size(); ++i) {
      if (i == widths.size()) widths.push_back(0);
      widths[i] = std::max(widths[i], row[i].size());
    }
  std::string out;
  for (const auto& row : rows) {
    std::string line(std::size_t(indent), ' ');
    for (std::size_t i = 0; i < row.size(); ++i) {
      line += row[i];
      if (i + 1 < row.size()) line += std::string(widths[i] - row[i].size() + 2, ' ');
    }
    line.erase(line.find_last_not_of(' ') + 1);
    out += line + '\n';
  }
  return out;
}

}  // namespace brume::cli
