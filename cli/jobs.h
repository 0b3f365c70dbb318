#pragma once
// Which files a command works on: sequences and single files made into a list.

#include <filesystem>
#include <string>
#include <vector>

#include "terminal.h"

namespace brume::cli {

struct Job {
  double frame = 0;
  std::filesystem::path in, out;
};

/// The inputs named by `in` (files and sequences), in order. `frames` is the text of
/// --frames. A frame of that list that does not exist stops with Error, or is left out
/// with `skip_missing`; without a list, all frames that exist are taken, and gaps are
/// warned of. Throws UsageError for a list that cannot be read.
std::vector<Job> find_inputs(const std::vector<std::string>& in,
                             const std::string& frames, bool skip_missing,
                             const Terminal&);

/// Gives each job its output. `out` is a file (one job only), a pattern with a frame
/// token, or a folder ending in "/". Throws UsageError when two jobs would write one file
/// or one would write over an input, Error for a folder without its "/".
void name_outputs(std::vector<Job>&, const std::string& out);

}  // namespace brume::cli
