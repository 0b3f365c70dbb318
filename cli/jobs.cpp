#include "jobs.h"

#include <fmt/format.h>

#include <map>
#include <set>
#include <system_error>

#include "commands.h"
#include "num/error.h"
#include "scene/frames.h"

namespace brume::cli {
namespace fs = std::filesystem;

namespace {

bool is_there(const fs::path& p) {
  std::error_code none;
  return fs::exists(p, none);
}

std::vector<int> frames_from(const std::string& text) {
  try {
    return parse_frames(text);
  } catch (const Error& e) {
    throw UsageError(e.what());
  }
}

// Frames between the first and the last that are not there.
std::vector<int> gaps(const std::vector<int>& frames) {
  std::vector<int> out;
  for (std::size_t i = 1; i < frames.size() && out.size() < 10000; ++i)
    for (int f = frames[i - 1] + 1; f < frames[i] && out.size() < 10000; ++f)
      out.push_back(f);
  return out;
}

void add_sequence(const FramePattern& pattern, const std::string& frames,
                  bool skip_missing, const Terminal& terminal, std::vector<Job>& jobs) {
  std::vector<int> list;
  if (frames.empty()) {
    list = pattern.existing();
    if (list.empty()) throw Error(pattern.text(), "no frame of it exists");
    if (const std::vector<int> missing = gaps(list); !missing.empty())
      terminal.warning(
          fmt::format("{}: no frames {}", pattern.text(), frames_text(missing)));
  } else {
    std::vector<int> missing;
    for (const int f : frames_from(frames))
      (is_there(pattern.path(f)) ? list : missing).push_back(f);
    if (!missing.empty() && (!skip_missing || list.empty()))
      throw Error(pattern.text(), fmt::format("no frames {}", frames_text(missing)),
                  list.empty() ? "" : "--on-missing skip makes the others");
    if (!missing.empty())
      terminal.warning(
          fmt::format("{}: skipped frames {}", pattern.text(), frames_text(missing)));
  }
  for (const int f : list) jobs.push_back({double(f), pattern.path(f), {}});
}

void add_file(const fs::path& file, const std::string& frames, std::vector<Job>& jobs) {
  double frame = frame_in_name(file).value_or(0);
  if (!frames.empty()) {
    const std::vector<int> list = frames_from(frames);
    if (list.size() != 1)
      throw UsageError(
          fmt::format("{}: one file, but --frames lists {} frames; write its "
                      "frame number as ####",
                      file.string(), list.size()));
    frame = list.front();
  }
  if (!is_there(file)) throw Error(file.string(), "no such file");
  jobs.push_back({frame, file, {}});
}

}  // namespace

std::vector<Job> find_inputs(const std::vector<std::string>& in,
                             const std::string& frames, bool skip_missing,
                             const Terminal& terminal) {
  std::vector<Job> jobs;
  for (const std::string& text : in) {
    const FramePattern pattern(text);
    if (pattern.has_frame() && !is_there(text))
      add_sequence(pattern, frames, skip_missing, terminal, jobs);
    else
      add_file(text, frames, jobs);
  }
  return jobs;
}

void name_outputs(std::vector<Job>& jobs, const std::string& out) {
  std::error_code none;
  if (out.empty()) throw UsageError("-o: names no file");
  if (!out.ends_with('/') && fs::is_directory(out, none))
    throw Error(out, "is a directory",
                "write " + out + "/ to keep the names of the input");
  const FramePattern pattern(out);
  if (!out.ends_with('/') && !pattern.has_frame() && jobs.size() > 1)
    throw UsageError(
        fmt::format("-o {}: {} frames into one file; write a frame number as "
                    "####, or a folder ending in /",
                    out, jobs.size()));
  std::set<fs::path> inputs;
  for (const Job& job : jobs) inputs.insert(fs::weakly_canonical(job.in, none));
  std::map<fs::path, fs::path> makers;
  for (Job& job : jobs) {
    job.out = out.ends_with('/')    ? fs::path(out) / job.in.filename()
              : pattern.has_frame() ? pattern.path(int(job.frame))
                                    : fs::path(out);
    const fs::path real = fs::weakly_canonical(job.out, none);
    if (inputs.contains(real))
      throw UsageError("-o " + job.out.string() + ": is an input; write somewhere else");
    const auto [other, first] = makers.try_emplace(real, job.in);
    if (!first)
      throw UsageError(fmt::format("-o {}: {} and {} would both be written to {}", out,
                                   other->second.string(), job.in.string(),
                                   job.out.string()));
  }
}

}  // namespace brume::cli
