#include "pipeline/sources.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "num/error.h"
#include "pipeline/report.h"
#include "scene/frames.h"

namespace brume {
namespace {

int part_of_view(const std::filesystem::path& in, const std::string& view) {
  const auto headers = read_headers(in);
  std::string has;
  for (std::size_t p = 0; p < headers.size(); ++p) {
    if (headers[p].view == view) return int(p);
    has += (has.empty() ? "" : ", ") + headers[p].view;
  }
  throw Error(in.string(), "no view " + view, "its views are " + has);
}

}  // namespace

FrameFiles::FrameFiles(const SceneFile& scene, double frame,
                       const std::filesystem::path& in)
    : scene_(scene), frame_(frame) {
  const auto input = SceneFile::section<InputSection>(scene.input, frame);
  main_ = open_image(in, input.view.empty() ? input.part : part_of_view(in, input.view));
}

const ImageReader& FrameFiles::other(const std::string& file) const {
  const std::lock_guard lock(mutex_);
  auto& reader = others_[file];
  if (!reader) {
    // Names in a scene are relative to the scene.
    std::filesystem::path path = FramePattern(file).path(int(std::lround(frame_)));
    if (path.is_relative() && !scene_.path.empty() && !std::filesystem::exists(path))
      path = scene_.path.parent_path() / path;
    reader = open_image(path);
  }
  return *reader;
}

FrameSource FrameFiles::source(const ApplyOptions& options) const {
  FrameSource s;
  s.frame = frame_;
  s.header = main_->header();
  s.name = main_->path().string();
  s.scale_x = s.scale_y = 1.0 / std::max(1, options.proxy);
  s.other_header = [this](const std::string& file) { return &other(file).header(); };
  return s;
}

FrameFiles::Rows FrameFiles::read(const InputChannel& in, int y, bool is_depth) const {
  const Window& own = main_->header().data_window;
  Rows out;
  if (in.file.empty()) {
    const int channel[] = {main_->header().find(in.channel)};
    const int band = std::max(1, main_->band_rows());
    out.y = own.y + (y - own.y) / band * band;
    if (!main_->streams()) out.y = y;
    out.rows = main_->streams() ? std::min(band, own.bottom() - out.y) : 1;
    out.values.resize(std::size_t(out.rows) * std::size_t(own.width));
    float* const plane[] = {out.values.data()};
    main_->read(out.y, out.rows, channel, plane);
    return out;
  }
  const ImageReader& file = other(in.file);
  const Window &theirs = file.header().data_window, &a = main_->header().display_window,
               &b = file.header().display_window;
  const int dx = b.x - a.x, dy = b.y - a.y;  // from our coordinates to theirs
  const float nothing = is_depth ? std::numeric_limits<float>::infinity() : 0.f;
  const int band = file.streams() ? std::max(1, file.band_rows()) : 1;
  const int first = y + dy < theirs.y || y + dy >= theirs.bottom()
                        ? y + dy
                        : theirs.y + (y + dy - theirs.y) / band * band;
  const int last = first == y + dy && (first < theirs.y || first >= theirs.bottom())
                       ? first + 1
                       : std::min(first + band, theirs.bottom());
  out.y = std::max(first - dy, own.y);
  out.rows = std::min(last - dy, own.bottom()) - out.y;
  out.values.assign(std::size_t(out.rows) * std::size_t(own.width), nothing);
  if (first < theirs.y || first >= theirs.bottom()) return out;
  const int channel[] = {file.header().find(in.channel)};
  std::vector<float> rows(std::size_t(out.rows) * std::size_t(theirs.width));
  float* const plane[] = {rows.data()};
  file.read(out.y + dy, out.rows, channel, plane);
  const int x0 = std::max(own.x, theirs.x - dx),
            x1 = std::min(own.right(), theirs.right() - dx);
  for (int r = 0; r < out.rows && x0 < x1; ++r)
    std::copy_n(rows.data() + std::ptrdiff_t(r) * theirs.width + (x0 + dx - theirs.x),
                x1 - x0,
                out.values.data() + std::ptrdiff_t(r) * own.width + (x0 - own.x));
  return out;
}

std::vector<float> FrameFiles::read_all(const InputChannel& in, const Window& w,
                                        bool is_depth) const {
  const Window& own = main_->header().data_window;
  std::vector<float> plane(std::size_t(w.pixels()));
  for (int y = w.y; y < w.bottom();) {
    const Rows got = read(in, y, is_depth);
    for (; y < std::min(got.y + got.rows, w.bottom()); ++y)
      std::copy_n(
          got.values.data() + std::ptrdiff_t(y - got.y) * own.width + (w.x - own.x),
          w.width, plane.data() + std::ptrdiff_t(y - w.y) * w.width);
  }
  return plane;
}

Edit edit_of(const PreparedFrame& frame, const SceneFile& scene,
             const ApplyOptions& options) {
  Edit edit;
  for (const OutputChannel& out : frame.outputs()) edit.channels.push_back(out.channel);
  const auto output = SceneFile::section<OutputSection>(scene.output, frame.plan().frame);
  if (!output.compression.empty())
    edit.compression = compression_from(output.compression);
  if (output.dwa_level > 0) edit.dwa_level = float(output.dwa_level);
  if (options.provenance_scene.empty()) return edit;
  edit.attributes["brume/version"] = Attribute::from_text(version());
  edit.attributes["brume/scene"] = Attribute::from_text(options.provenance_scene);
  edit.attributes["brume/report"] = Attribute::from_text(plan_json(frame.plan()));
  return edit;
}

}  // namespace brume
