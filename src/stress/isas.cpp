#include "stress/isas.h"

#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string>

#include "num/error.h"
#include "stress/stress.h"

namespace brume::stress {
namespace {
namespace fs = std::filesystem;

// Groups that are made so that a module chooses: where all were idle it chooses later, as
// the others do.
constexpr std::uint64_t kTried = 4;

/// BRUME_ISA for as long as this lives.
class Forced {
 public:
  explicit Forced(Isa isa) {
    if (const char* before = std::getenv("BRUME_ISA")) before_ = before;
    ::setenv("BRUME_ISA", name(isa), 1);
  }
  ~Forced() {
    if (before_)
      ::setenv("BRUME_ISA", before_->c_str(), 1);
    else
      ::unsetenv("BRUME_ISA");
  }
  Forced(const Forced&) = delete;
  Forced& operator=(const Forced&) = delete;

 private:
  std::optional<std::string> before_;
};

/// A file of this name in a folder of its own, for as long as this lives.
class Copy {
 public:
  explicit Copy(const fs::path& file) {
    std::string folder = (fs::temp_directory_path() / "brume-XXXXXX").string();
    if (!::mkdtemp(folder.data())) throw Error(folder, "cannot be made");
    folder_ = folder;
    fs::copy_file(file, path = folder_ / file.filename());
  }
  ~Copy() {
    std::error_code gone;
    fs::remove_all(folder_, gone);
  }
  Copy(const Copy&) = delete;
  Copy& operator=(const Copy&) = delete;
  fs::path path;

 private:
  fs::path folder_;
};

}  // namespace

LowerIsas::LowerIsas(const StageType& type) {
  const Isa own = isa();  // this program has chosen
  if (type.role == BRUME_AIR || !fs::is_regular_file(type.from)) return;
  for (const Isa lower : {Isa::v2, Isa::v3}) {
    if (lower >= own) break;
    const Forced forced(lower);
    const Copy copy(type.from);
    One one{lower, nullptr, nullptr, std::make_unique<StageCache>()};
    one.registry = std::make_unique<Registry>(
        Registry::Options{{copy.path}, false, false, false, {}});
    one.type = &one.registry->find(type.name);
    const Maker maker = maker_of(*one.type, *one.cache);
    for (std::uint64_t n = 0; n < kTried; ++n) describe(maker, {}, n * kGroup);
    all_.push_back(std::move(one));
  }
}

}  // namespace brume::stress
