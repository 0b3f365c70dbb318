#include <cstdlib>
#include <fstream>
#include <sstream>

#include "study/page.h"

namespace brume::study {
namespace fs = std::filesystem;

namespace {

std::string text_of(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  return in ? text.str() : std::string();
}

}  // namespace

Uplot find_uplot() {
  std::error_code none;
  const fs::path program = fs::read_symlink("/proc/self/exe", none).parent_path();
  std::vector<fs::path> folders = {program / "share/brume/uplot",
                                   program / "../share/brume/uplot"};
  if (const char* given = std::getenv("BRUME_UPLOT")) folders = {given};
  for (const fs::path& f : folders) {
    Uplot u{text_of(f / "uPlot.iife.min.js"), text_of(f / "uPlot.min.css"),
            text_of(f / "LICENSE")};
    if (!u.script.empty() && !u.style.empty()) return u;
  }
  return {};
}

}  // namespace brume::study
