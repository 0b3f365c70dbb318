// brume diff: are two images, or two sequences, the same?

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <set>

#include "commands.h"
#include "diff_picture.h"
#include "image/io.h"
#include "json.h"
#include "num/error.h"
#include "scene/frames.h"
#include "truth/difference.h"

namespace brume::cli {
namespace fs = std::filesystem;

namespace {

// What stands before the exit codes of other commands: 4 for files, 3 for sizes.
constexpr int kTrouble = int(Verdict::trouble);

double number_from(std::string_view text, const std::string& whole) {
  double v = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), v);
  if (error != std::errc() || end != text.data() + text.size() || std::isnan(v))
    throw UsageError("diff: " + whole + ": write a number, or CHANNEL=NUMBER");
  return v;
}

// "0.1", "Z=5", "T.*=1e-3".
std::vector<Limit> limits_from(const std::vector<std::string>& texts, bool picture) {
  std::vector<Limit> limits;
  for (const std::string& t : texts) {
    const auto equals = t.rfind('=');
    if (equals == std::string::npos) {
      limits.push_back({picture ? "" : "*", number_from(t, t)});
    } else if (picture) {
      throw UsageError("diff: " + t + ": FLIP is of the picture, not of a channel");
    } else {
      limits.push_back(
          {t.substr(0, equals), number_from(std::string_view(t).substr(equals + 1), t)});
    }
  }
  return limits;
}

std::vector<std::string> names_from(const std::vector<std::string>& lists) {
  std::vector<std::string> names;
  for (const std::string& list : lists)
    for (std::size_t at = 0; at <= list.size();) {
      const auto end = std::min(list.find(',', at), list.size());
      if (end > at) names.push_back(list.substr(at, end - at));
      at = end + 1;
    }
  return names;
}

DifferenceOptions options_from(const DiffArguments& a) {
  DifferenceOptions o;
  o.metric = a.metric == "rms"    ? Metric::rms
             : a.metric == "psnr" ? Metric::psnr
             : a.metric == "ssim" ? Metric::ssim
             : a.metric == "flip" ? Metric::flip
                                  : Metric::max;
  o.fail = limits_from(a.fail, o.metric == Metric::flip);
  o.warn = limits_from(a.warn, o.metric == Metric::flip);
  o.fail_percent = a.fail_percent;
  o.warn_percent = a.warn_percent;
  o.hard_fail = a.hard_fail;
  o.relative = a.relative;
  o.nan_equal = a.nan_equal;
  o.peak = a.peak;
  o.ignore_channels = names_from(a.ignore_channels);
  o.ignore_attributes = names_from(a.ignore_attributes);
  if (o.metric != Metric::max &&
      (a.fail_percent > 0 || a.warn_percent > 0 || a.hard_fail || a.relative))
    throw UsageError(
        "diff: --fail-percent, --warn-percent, --hard-fail and --relative go with "
        "--metric max");
  return o;
}

struct Pair {
  std::optional<int> frame;
  fs::path a, b;
};

// Frames that either side has, so that a frame one lacks is found.
std::vector<Pair> pairs_from(const DiffArguments& a) {
  const FramePattern pa(a.a), pb(a.b);
  if (!pa.has_frame() && !pb.has_frame()) {
    if (!a.frames.empty()) throw UsageError("diff: --frames goes with sequences");
    return {{std::nullopt, a.a, a.b}};
  }
  if (pa.has_frame() != pb.has_frame())
    throw UsageError("diff: one is a sequence, the other a single file");
  std::vector<int> frames;
  if (!a.frames.empty()) {
    frames = parse_frames(a.frames);
  } else {
    std::set<int> either;
    for (const FramePattern* p : {&pa, &pb})
      for (const int f : p->existing()) either.insert(f);
    frames.assign(either.begin(), either.end());
  }
  if (frames.empty()) throw Error(a.a, "no frame of it exists");
  std::vector<Pair> pairs;
  for (const int f : frames) pairs.push_back({f, pa.path(f), pb.path(f)});
  return pairs;
}

std::string line_of(const ChannelDifference& c, const DifferenceOptions& o) {
  std::string s = fmt::format("{}: ", c.name);
  if (c.different == 0) {
    s += fmt::format("{} samples, all equal", c.samples);
  } else {
    s += fmt::format(
        "{} of {} samples differ, by at most {:.6g} at {},{} (A {:.9g}, B {:.9g})",
        c.different, c.samples, c.max, c.x, c.y, c.a, c.b);
    if (c.numbers() == 0)
      s += "; all are NaN or infinite";
    else if (c.broken > 0)
      s += fmt::format("; {} are NaN or infinite, the others: rms {:.3g}, mean {:.3g}",
                       c.broken, c.rms, c.mean);
    else
      s += fmt::format("; rms {:.3g}, mean {:.3g}, p99 {:.3g}, {:.1f} dB", c.rms, c.mean,
                       c.p99, c.psnr);
    if (o.metric == Metric::max && c.above_fail > 0)
      s += fmt::format("; {} ({:.3g} %) above the limit", c.above_fail,
                       100. * double(c.above_fail) / double(c.samples));
  }
  if (c.ssim) s += fmt::format("; SSIM {:.6f}", *c.ssim);
  if (c.verdict != Verdict::same) s += fmt::format(": {}", name(c.verdict));
  return s;
}

void print(const Pair& pair, const Difference& d, const DifferenceOptions& o,
           bool everything) {
  const auto line = [&](const std::string& s) {
    fmt::print("{}{}\n", pair.frame ? fmt::format("{} ", *pair.frame) : "", s);
  };
  for (const std::string& m : d.mismatches) line(m);
  for (const PartDifference& p : d.parts) {
    for (const std::string& m : p.mismatches) line(m);
    for (const std::string& m : p.attributes) line("attribute " + m);
    if (everything)
      for (const std::string& m : p.notes) line(m);
    for (const ChannelDifference& c : p.channels)
      if (everything || c.different > 0) line(line_of(c, o));
    if (p.flip) line(fmt::format("FLIP {:.6f}", *p.flip));
  }
}

void write_json(Json& j, const Pair& pair, const Difference& d,
                const std::string& trouble) {
  j.object();
  if (pair.frame) j.key("frame").value(*pair.frame);
  j.key("a").value(pair.a.string()).key("b").value(pair.b.string());
  j.key("verdict").value(name(d.verdict)).key("exit").value(int(d.verdict));
  if (!trouble.empty()) j.key("error").value(trouble);
  j.key("mismatches").values(d.mismatches);
  j.key("parts").array();
  for (const PartDifference& p : d.parts) {
    j.object().key("name").value(p.name).key("verdict").value(name(p.verdict));
    j.key("mismatches").values(p.mismatches).key("attributes").values(p.attributes);
    j.key("notes").values(p.notes);
    if (p.flip) j.key("flip").value(*p.flip);
    j.key("channels").array();
    for (const ChannelDifference& c : p.channels) {
      j.object().key("name").value(c.name).key("verdict").value(name(c.verdict));
      j.key("samples")
          .value(double(c.samples))
          .key("different")
          .value(double(c.different));
      j.key("above_warn").value(double(c.above_warn));
      j.key("above_fail").value(double(c.above_fail));
      j.key("broken").value(double(c.broken));
      j.key("max").value(c.max).key("p99").value(c.p99);
      j.key("numbers").value(double(c.numbers()));
      j.key("mean").value(c.mean).key("rms").value(c.rms);
      j.key("bias").value(c.bias).key("psnr").value(c.psnr);
      if (c.ssim) j.key("ssim").value(*c.ssim);
      if (c.different > 0) {
        j.key("x").value(c.x).key("y").value(c.y);
        j.key("value_a").value(double(c.a)).key("value_b").value(double(c.b));
      }
      j.end();
    }
    j.end().end();
  }
  j.end().end();
}

void draw(const DiffArguments& a, const Pair& pair, const DifferenceOptions& o) {
  const FramePattern out(a.out);
  if (pair.frame && !out.has_frame())
    throw UsageError("diff: -o " + a.out + ": several pictures; write OUT.####.exr");
  const fs::path to = pair.frame ? out.path(*pair.frame) : fs::path(a.out);
  std::error_code none;
  if (!a.overwrite && fs::exists(to, none))
    throw Error(to.string(), "exists", "--overwrite replaces it");
  if (to.has_parent_path()) fs::create_directories(to.parent_path(), none);
  const auto kind = a.picture == "signed" ? DifferencePicture::difference
                    : a.picture == "flip" ? DifferencePicture::flip
                                          : DifferencePicture::absolute;
  Image picture = difference_picture(pair.a, pair.b, kind, o);
  if (!keeps_numbers(to)) draw_for_eyes(picture, kind == DifferencePicture::difference);
  write_image(picture, to);
}

}  // namespace

int diff(const DiffArguments& a, const Terminal& terminal) {
  const DifferenceOptions options = options_from(a);
  std::vector<Pair> pairs;
  try {
    pairs = pairs_from(a);
  } catch (const Error& e) {
    terminal.error(e.what());
    return kTrouble;
  }
  int worst = 0;
  Json json;
  if (a.json) json.array();
  for (const Pair& pair : pairs) {
    Difference d;
    std::string trouble;
    try {
      d = compare_files(pair.a, pair.b, options);
      if (!a.out.empty() && d.verdict != Verdict::mismatch) draw(a, pair, options);
    } catch (const Error& e) {
      trouble = e.what();
      terminal.error(trouble);
      d.verdict = Verdict::trouble;
    }
    worst = std::max(worst, int(d.verdict));
    if (a.json)
      write_json(json, pair, d, trouble);
    else if (terminal.loudness != Loudness::quiet)
      print(pair, d, options, terminal.loudness == Loudness::verbose);
  }
  if (a.json) std::fputs(json.end().text().c_str(), stdout);
  if (pairs.size() > 1 && !a.json)
    terminal.say(fmt::format("{} frames: {}", pairs.size(), name(Verdict(worst))));
  return worst;
}

}  // namespace brume::cli
