#pragma once
// What the command line was asked to do, one struct and one function per command. Each
// returns the exit code; a user's mistake leaves them as brume::Error.

#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "image/image.h"
#include "terminal.h"

namespace brume::cli {

/// A command line that makes no sense: printed on one line, exit code 2.
struct UsageError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Exit codes.
enum Exit : int {
  kOk = 0,
  kFailed = 1,
  kUsage = 2,
  kSomeFramesFailed = 3,
  kTryAgain = 75,  ///< the machine had no memory, files or threads left
  kInterrupted = 130
};

/// What every command that reads a scene takes.
struct SceneArguments {
  std::string scene;                 ///< TOML file
  std::vector<std::string> set;      ///< "name.param=value"
  std::vector<std::string> plugins;  ///< modules to load
  std::optional<std::string> aovs;   ///< "T,L"; replaces the scene's
  std::string compression;           ///< likewise, where not empty
};

struct ApplyArguments {
  SceneArguments scene;
  std::vector<std::string> in;
  std::string out;
  std::string frames;
  bool skip_missing = false, overwrite = false, skip_existing = false;
  std::optional<Window> region;
  int proxy = 1, threads = 0;
  std::string report;
  bool truth = false;  ///< render by the slow, converged way
  int check = 0;       ///< compare so many pixels with it instead of writing
};
int apply(const ApplyArguments&, const Terminal&);
/// `apply --check N`: exit 1 when the promised error is not kept.
int check(const ApplyArguments&, const Terminal&);

struct PlanArguments {
  SceneArguments scene;
  std::vector<std::string> in;
  std::string frames;
  bool json = false;
};
int plan(const PlanArguments&, const Terminal&);

struct InfoArguments {
  std::vector<std::string> in;
  bool json = false;
};
int info(const InfoArguments&, const Terminal&);

struct StagesArguments {
  std::string name;
  std::vector<std::string> plugins;
  bool json = false, schema = false, names = false;
};
int stages(const StagesArguments&, const Terminal&);

struct ProbeArguments {
  SceneArguments scene;
  std::string rays;
  std::optional<double> frame;
  bool truth = false;  ///< by the slow, converged way, with its error
};
int probe(const ProbeArguments&, const Terminal&);

struct ViewArguments {
  std::vector<std::string> in;  ///< "file" or "file:layer"
  std::string out;
  std::string layer, curve, range, background;
  std::vector<std::string> labels;
  double exposure = 0;
  int columns = 0, width = 0;
  bool overwrite = false;
};
int view(const ViewArguments&, const Terminal&);

struct DiffArguments {
  std::string a, b;
  std::string frames, metric, picture, out;
  std::vector<std::string> fail, warn;  ///< "0.1" or "CHANNEL=0.1"
  double fail_percent = 0, warn_percent = 0, peak = 1;
  std::optional<double> hard_fail, relative;
  std::vector<std::string> ignore_channels, ignore_attributes;  ///< lists with commas
  bool nan_equal = false, json = false, overwrite = false;
};
/// Exit codes of its own: 0 same, 1 warn, 2 differ, 3 sizes or channels, 4 files.
int diff(const DiffArguments&, const Terminal&);

struct StressArguments {  // stages: of every role; none: all
  std::vector<std::string> stages, plugins;
  double cases = 1e6, seed = 1, seconds = 60;
  std::optional<double> only;  ///< this case alone
  std::string json;
};
int stress(const StressArguments&, const Terminal&);

struct StudyArguments {
  SceneArguments scene;
  std::string in, out, chart, table;
  std::string budget;  ///< "0.5s"
  std::optional<double> error, frame;
  double seconds = 40;
  int repeats = 9;
  bool overwrite = false;
  std::string command;  ///< as it was typed
};
int study(const StudyArguments&, const Terminal&);

}  // namespace brume::cli
