// Any bytes as a frame list and as a pattern. A list prints to a text that gives the list
// again; a pattern finds every frame in the path that it wrote.

#include <cstdint>
#include <cstring>
#include <string_view>

#include "expect.h"
#include "scene/frames.h"

using namespace brume;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 4) return 0;
  std::int32_t bits;
  std::memcpy(&bits, data, 4);
  const int frame = bits % (kLargestFrame + 1);
  const std::string_view text(reinterpret_cast<const char*>(data) + 4, size - 4);
  try {
    const std::vector<int> frames = parse_frames(text);
    // Long lists are equal to their text again, only slower.
    if (frames.size() < 10000) expect(parse_frames(frames_text(frames)) == frames);
  } catch (const Error& e) {
    one_line(e);
  }
  try {
    const FramePattern pattern(text);
    const auto path = pattern.path(frame, "left");
    const auto found = pattern.frame_of(path, "left");
    expect(found.has_value() == pattern.has_frame());
    if (found) expect(pattern.path(*found, "left") == path);
    (void)frame_in_name(path);
    check_output(pattern, FramePattern("out.%V.####.exr"), 2, 2);
  } catch (const Error& e) {
    one_line(e);
  }
  return 0;
}
