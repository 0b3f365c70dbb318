#include "reference.h"

#include <cmath>
#include <fstream>
#include <sstream>

namespace brume::sky {

std::vector<ReferenceRow> reference(const std::string& name) {
  std::ifstream in(std::string(BRUME_SOURCE_DIR) + "/data/reference/sky/" + name +
                   ".csv");
  std::vector<ReferenceRow> out;
  for (std::string line; std::getline(in, line);) {
    if (line.empty() || line[0] == '#' || line[0] == 'h') continue;
    std::istringstream cells(line);
    std::vector<double> v;
    for (std::string cell; std::getline(cells, cell, ',');) v.push_back(std::stod(cell));
    ReferenceRow row{v[0], v[1], v[2], v[3], {}, {}, {}, {}, {}};
    const double vz = v[2] * M_PI / 180, az = v[3] * M_PI / 180, sz = v[1] * M_PI / 180;
    row.ray = {v[0], std::cos(vz), std::cos(sz),
               std::cos(vz) * std::cos(sz) + std::sin(vz) * std::sin(sz) * std::cos(az)};
    std::size_t at = 4;
    if (name == "aerial") row.ray.distance = v[at++];
    for (double* to : {row.T, row.single, row.L, row.error})
      for (int c = 0; c < 3; ++c) to[c] = v[at++];
    out.push_back(row);
  }
  return out;
}

}  // namespace brume::sky
