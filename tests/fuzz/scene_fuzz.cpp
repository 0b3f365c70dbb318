// Any bytes as a scene file and, behind a NUL, as --set assignments. They are refused by
// an Error on one line, or read; what is read prints, and the print reads back to itself.

#include <cstdint>
#include <string>
#include <string_view>

#include "expect.h"
#include "scene/scene_file.h"
#include "zoo.h"

namespace {

using namespace brume;

std::vector<ParamSpec> specs_for(const std::string& type, const Location& where) {
  if (type != "zoo" && type != "height_fog") throw Error(where.text(), "no such stage");
  return specs_of<Zoo>();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view all(reinterpret_cast<const char*>(data), size);
  const std::size_t nul = std::min(all.find('\0'), all.size());
  SceneFile scene;
  try {
    scene = parse_scene(all.substr(0, nul), "fuzz.toml", specs_for);
  } catch (const Error& e) {
    one_line(e);
    // NUL is garbage to the parser too.
    try {
      parse_scene(all, "fuzz.toml", specs_for);
      expect(nul == all.size());
    } catch (const Error& whole) {
      one_line(whole);
    }
    return 0;
  }
  std::string_view sets = all.substr(std::min(nul + 1, all.size()));
  while (!sets.empty()) {
    const std::size_t end = std::min(sets.find('\0'), sets.size());
    try {
      set(scene, sets.substr(0, end), specs_for);
    } catch (const Error& e) {
      one_line(e);
    }
    sets.remove_prefix(std::min(end + 1, sets.size()));
  }
  const std::string text = print(scene);
  expect(print(parse_scene(text, "printed.toml", specs_for)) == text);
  // Every value can be taken at any frame.
  for (const double frame : {-1e300, -1.0, 0.0, 1001.5, 1e300})
    for (const StageEntry& stage : scene.stages) {
      Zoo zoo;
      assign(zoo, std::span<const Value>(stage.params.at(frame)));
      expect(zoo.density >= 0 && zoo.density <= 10);
    }
  return 0;
}
