#pragma once
// Two image files compared, in bands, on all cores: what `brume diff` says.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "image/image.h"

namespace brume {

/// In order of gravity; the numbers are exit codes.
enum class Verdict { same = 0, warn = 1, differ = 2, mismatch = 3, trouble = 4 };
const char* name(Verdict);

/// max: differences of samples; the others: one number per channel (rms, psnr, ssim) or
/// for the picture's colour (flip).
enum class Metric { max, rms, psnr, ssim, flip };

/// A number, or a number for the channels of this name ("*" stands for anything).
struct Limit {
  std::string channel;
  double value;
};

struct DifferenceOptions {
  Metric metric = Metric::max;
  /// The last that fits a channel holds. Differences above `fail` fail, above `warn`
  /// warn; for psnr and ssim values below. Where no `fail` fits: anything but equality
  /// fails.
  std::vector<Limit> fail, warn;
  /// So many samples of a channel, in percent, may be above the limit; metric max only.
  double fail_percent = 0, warn_percent = 0;
  /// But none may be above this one.
  std::optional<double> hard_fail;
  /// Differences are taken relative to the larger magnitude of the two, or to this where
  /// that is more.
  std::optional<double> relative;
  bool nan_equal = false;  ///< NaN and NaN are the same
  double peak = 1;         ///< brightest value, for psnr and ssim
  std::vector<std::string> ignore_channels, ignore_attributes;  ///< "*" as above
};

/// Whether a name fits a pattern: "*" stands for any text, the empty one too.
bool fits(std::string_view pattern, std::string_view name);

struct ChannelDifference {
  std::string name;
  std::uint64_t samples = 0;
  std::uint64_t different = 0;  ///< not equal (NaN and NaN: as nan_equal says)
  std::uint64_t above_warn = 0, above_fail = 0;
  std::uint64_t broken = 0;  ///< one is NaN or infinite and the other is not the same
  double max = 0, p99 = 0;   ///< of all; infinite for a broken one. p99: to 1 %
  /// Of the others, `numbers()` of them, and NaN where there are none. bias: mean of b -
  /// a.
  double mean = 0, rms = 0, bias = 0, psnr = 0;
  std::optional<double> ssim;
  int x = 0, y = 0;    ///< the largest difference, image coordinates
  float a = 0, b = 0;  ///< the values there
  Verdict verdict = Verdict::same;

  std::uint64_t numbers() const { return samples - broken; }
};

struct PartDifference {
  std::string name;
  std::vector<std::string> mismatches;  ///< windows, channels
  std::vector<std::string> attributes;  ///< what differs, one line each
  std::vector<std::string> notes;       ///< worth knowing, no verdict (types)
  std::vector<ChannelDifference> channels;
  std::optional<double> flip;
  Verdict verdict = Verdict::same;
};

struct Difference {
  std::vector<PartDifference> parts;
  std::vector<std::string> mismatches;  ///< of the files: number of parts
  Verdict verdict = Verdict::same;
};

/// All parts of two files. Throws Error for what cannot be read. Channels that lie in a
/// file as 32-bit integers are compared as the nearest floats. A NaN or infinity against
/// anything else fails whatever the percentages say.
Difference compare_files(const std::filesystem::path& a, const std::filesystem::path& b,
                         const DifferenceOptions&);

/// A picture of the difference of the first parts, whose windows and channels agree.
enum class DifferencePicture { absolute, difference, flip };
/// absolute, difference: every common channel's |b - a| or b - a. flip: R G B, the FLIP
/// error of the colour in false colour.
Image difference_picture(const std::filesystem::path& a, const std::filesystem::path& b,
                         DifferencePicture, const DifferenceOptions&);

}  // namespace brume
