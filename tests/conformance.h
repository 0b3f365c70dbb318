#pragma once
// What tests of every stage share: the modules beside the program, and those named in
// BRUME_CONFORMANCE_PLUGINS (files, colons between them); their examples.

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <sstream>

#include "pipeline/frames.h"

namespace brume::test {

namespace fs = std::filesystem;

inline Registry::Options options() {
  Registry::Options o;
  if (const char* files = std::getenv("BRUME_CONFORMANCE_PLUGINS")) {
    std::istringstream list(files);
    for (std::string file; std::getline(list, file, ':');) o.files.emplace_back(file);
  }
  return o;
}

inline Registry& registry() {
  static Registry all(options());
  return all;
}

// A stage's example: the file of its folder that names it.
inline std::string example_of(const std::string& stage) {
  for (const auto& folder : fs::directory_iterator(BRUME_SOURCE_DIR "/plugins")) {
    std::ifstream in(folder.path() / "example.toml");
    const std::string text{std::istreambuf_iterator<char>(in), {}};
    if (text.find("type = \"" + stage + "\"") != text.npos) return text;
  }
  return {};
}

// The example before a small frame, with camera and sun unless it brings its own.
inline std::string scene_before(std::string text) {
  std::string more;
  if (text.find("[camera]") == text.npos) more += kCamera;
  if (text.find("[sun]") == text.npos) more += "[sun]\nelevation = 20\nazimuth = 40\n";
  const auto at = text.find("[[stage]]");
  return text.insert(at == text.npos ? text.size() : at, more + "\n");
}

class Conformance : public testing::TestWithParam<std::string> {
 protected:
  const StageType& type() { return registry().find(GetParam()); }
  const Window display{0, 0, 61, 37};
  const Pixels pixels = make_pixels(61, 37);

  // What the stage's example makes of the frame; false where there is none to go by.
  bool prepare(const std::string& scene) {
    session_ = std::make_unique<Session>(scene_of(registry(), scene), registry());
    frame_ =
        std::make_unique<PreparedFrame>(session_->prepare(source_of(pixels, display)));
    return true;
  }
  bool from_frame() const {
    for (const InputChannel& c : frame_->inputs())
      if (!c.file.empty() || c.channel.size() != 1) return false;
    return true;
  }
  std::unique_ptr<Session> session_;
  std::unique_ptr<PreparedFrame> frame_;
};

inline std::vector<std::string> stages() {
  std::vector<std::string> names, broken;
  for (const StageType* type : registry().all(&broken)) names.push_back(type->name);
  for (const std::string& why : broken) ADD_FAILURE() << why;
  return names;
}

#define BRUME_EVERY_STAGE(suite)                                       \
  INSTANTIATE_TEST_SUITE_P(Stages, suite, testing::ValuesIn(stages()), \
                           [](const auto& of) { return of.param; })

}  // namespace brume::test
