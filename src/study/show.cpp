#include "study/show.h"

#include <array>

#include "pipeline/proxy.h"

namespace brume::study {

namespace {

constexpr int kWidth = 960;

Picture picture_of(const PreparedFrame& frame, const FrameFiles& files, int proxy,
                   const std::array<std::string, 3>& channels) {
  ApplyOptions o;
  o.proxy = proxy;
  FrameReport ignored;
  const Image image = render_part(frame, files, o, ignored);
  const Window& w = image.header.data_window;
  Picture p(w.width, w.height);
  for (std::size_t c = 0; c < 3; ++c) {
    const int k = image.header.find(channels[c]);
    if (k < 0) continue;
    const auto plane = image.plane(k);
    for (std::size_t i = 0; i < plane.size(); ++i)
      p.rgb[3 * i + c] = tone(plane[i], Curve::filmic);
  }
  return p;
}

}  // namespace

void show(const SceneFile& scene, Registry& registry, const FrameFiles& files,
          const Prepared& given, Study& study) {
  const PreparedFrame::Impl& f = given.impl();
  if (f.color[0] < 0) return;
  std::array<std::string, 3> channels;
  for (std::size_t c = 0; c < 3; ++c)
    channels[c] = f.inputs[std::size_t(f.color[c])].channel;
  ApplyOptions o;
  o.proxy = std::max(1, (study.width + kWidth - 1) / kWidth);
  const FrameSource source = files.source(o);
  SceneFile nothing = scene;
  nothing.stages.clear();
  study.before =
      picture_of(Session(nothing, registry).prepare(source), files, o.proxy, channels);
  study.after = picture_of(given.session->prepare(source), files, o.proxy, channels);
}

}  // namespace brume::study
