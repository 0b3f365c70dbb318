// brume probe: a table of rays in, the same table with T and L out.

#include "pipeline/probe.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <iostream>
#include <iterator>
#include <sstream>

#include "commands.h"
#include "num/error.h"
#include "scene.h"
#include "truth/probe.h"

namespace brume::cli {

namespace {

const char* const kColumns[] = {"ox", "oy",       "oz", "dx", "dy",
                                "dz", "distance", "r",  "g",  "b"};

std::string_view trimmed(std::string_view s) {
  const auto from = s.find_first_not_of(" \t\r");
  if (from == std::string_view::npos) return {};
  return s.substr(from, s.find_last_not_of(" \t\r") - from + 1);
}

std::vector<std::string_view> cells(std::string_view line) {
  std::vector<std::string_view> out;
  for (;;) {
    const auto comma = line.find(',');
    out.push_back(trimmed(line.substr(0, comma)));
    if (comma == std::string_view::npos) return out;
    line.remove_prefix(comma + 1);
  }
}

std::string read_all(const std::string& file) {
  if (file == "-")
    return {std::istreambuf_iterator<char>(std::cin), std::istreambuf_iterator<char>()};
  std::ifstream in(file, std::ios::binary);
  std::ostringstream text;
  if (!in || (in.peek() != EOF && !(text << in.rdbuf())) || in.bad())
    throw Error(file, std::strerror(errno));
  return text.str();
}

struct Table {
  std::string header;
  std::vector<std::string> rows;  ///< as they were written, without line ends
  std::vector<ProbeRay> rays;
};

class TableReader {
 public:
  explicit TableReader(std::string source) : source_(std::move(source)) {}

  Table read(std::string_view text) {
    Table table;
    while (!text.empty()) {
      const auto end = std::min(text.find('\n'), text.size());
      const std::string_view row = trimmed(text.substr(0, end));
      text.remove_prefix(std::min(end + 1, text.size()));
      ++line_;
      if (row.empty()) continue;
      if (count_ == 0) {
        read_header(row);
        table.header = row;
        continue;
      }
      table.rays.push_back(read_ray(row));
      table.rows.emplace_back(row);
    }
    if (count_ == 0) fail("is empty", "its first line is " + expected(7));
    return table;
  }

 private:
  [[noreturn]] void fail(const std::string& what, const std::string& hint = {}) const {
    throw Error(line_ > 0 ? fmt::format("{}:{}", source_, line_) : source_, what, hint);
  }

  static std::string expected(std::size_t n) {
    std::string out;
    for (std::size_t i = 0; i < n; ++i) out += (i ? "," : "") + std::string(kColumns[i]);
    return out;
  }

  void read_header(std::string_view row) {
    const auto names = cells(row);
    count_ = names.size();
    const bool known = (count_ == 7 || count_ == 10) &&
                       std::equal(names.begin(), names.end(), std::begin(kColumns));
    if (!known)
      fail("the header is not a table of rays",
           "write " + expected(7) + " or " + expected(10));
  }

  ProbeRay read_ray(std::string_view row) const {
    const auto values = cells(row);
    if (values.size() != count_)
      fail(fmt::format("{} values", values.size()),
           fmt::format("the header names {}", count_));
    std::array<double, 10> v{};
    for (std::size_t i = 0; i < count_; ++i) {
      const std::string_view text =
          values[i].starts_with('+') ? values[i].substr(1) : values[i];
      const auto [end, error] =
          std::from_chars(text.data(), text.data() + text.size(), v[i]);
      if (error != std::errc() || end != text.data() + text.size())
        fail(fmt::format("{} = \"{}\" is no number", kColumns[i], values[i]));
      const bool finite = std::isfinite(v[i]) || (i == 6 && v[i] > 0);
      if (!finite && i < 7) fail(fmt::format("{} = {}", kColumns[i], values[i]));
    }
    const ProbeRay ray{{v[0], v[1], v[2]}, {v[3], v[4], v[5]}, v[6]};
    if (ray.direction == glm::dvec3(0)) fail("the direction is zero");
    if (ray.distance < 0) fail(fmt::format("distance = {}", values[6]), "0 to inf");
    return ray;
  }

  std::string source_;
  std::size_t count_ = 0;
  int line_ = 0;
};

int print_truth(const ProbeArguments& a, const LoadedScene& loaded, const Table& table) {
  const auto answers =
      truth::probe(loaded.scene, *loaded.registry, a.frame.value_or(0), table.rays);
  fmt::print("{},T_r,T_g,T_b,L_r,L_g,L_b,T_error,L_error\n", table.header);
  for (std::size_t i = 0; i < answers.size(); ++i) {
    const truth::Answer& p = answers[i];
    const auto worst = [](const truth::Rgb& e) { return std::max({e[0], e[1], e[2]}); };
    fmt::print("{},{:.17g},{:.17g},{:.17g},{:.17g},{:.17g},{:.17g},{:.3g},{:.3g}\n",
               table.rows[i], p.T[0], p.T[1], p.T[2], p.L[0], p.L[1], p.L[2],
               worst(p.T_error), worst(p.L_error));
  }
  return kOk;
}

}  // namespace

int probe(const ProbeArguments& a, const Terminal&) {
  const LoadedScene loaded = load_scene(a.scene);
  const Table table =
      TableReader(a.rays == "-" ? "standard input" : a.rays).read(read_all(a.rays));
  if (a.truth) return print_truth(a, loaded, table);
  const std::vector<ProbeAnswer> answers =
      probe_rays(loaded.scene, *loaded.registry, a.frame.value_or(0), table.rays);
  fmt::print("{},T_r,T_g,T_b,L_r,L_g,L_b\n", table.header);
  for (std::size_t i = 0; i < answers.size(); ++i) {
    const ProbeAnswer& p = answers[i];
    fmt::print("{},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g}\n", table.rows[i], p.T[0],
               p.T[1], p.T[2], p.L[0], p.L[1], p.L[2]);
  }
  return kOk;
}

}  // namespace brume::cli
