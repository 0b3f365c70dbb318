// One binary, three instruction sets: the choice, the separation of their symbols, and
// that a Batch is its lanes.

#include "num/isa.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <vector>

#include "batch_check.h"
#include "num/error.h"
#include "num/random.h"

namespace brume::test {
namespace {

TEST(Isa, UnknownNameIsAnErrorThatNamesTheVariable) {
  for (const char* text : {"", "v1", "v5", "V3", "avx2", "v3 "}) {
    try {
      isa_from(text);
      ADD_FAILURE() << "accepted '" << text << "'";
    } catch (const Error& e) {
      EXPECT_EQ(e.where, "BRUME_ISA");
      EXPECT_NE(std::string(e.what()).find("v2, v3, v4"), std::string::npos) << e.what();
    }
  }
}

TEST(Isa, ForcedInstructionSetIsWhatTheProcessorHasAndNoMore) {
  for (const Isa wanted : {Isa::v2, Isa::v3, Isa::v4}) {
    if (wanted <= best_isa())
      EXPECT_EQ(isa_from(name(wanted)), wanted);
    else
      EXPECT_THROW(isa_from(name(wanted)), Error);
  }
}

TEST(Isa, EnvironmentVariableIsObeyed) {
  // In a process of its own, since the choice is made once.
  EXPECT_EXIT(
      {
        setenv("BRUME_ISA", "v2", 1);
        std::exit(isa() == Isa::v2 ? 7 : 8);
      },
      testing::ExitedWithCode(7), "");
}

TEST(Isa, TablesAreTheirOwn) {
  EXPECT_EQ(isa_v2::batch_check.width, 4);
  EXPECT_EQ(isa_v3::batch_check.width, 8);
  EXPECT_EQ(isa_v4::batch_check.width, 16);
  const int width = BRUME_ISA_SELECT(batch_check).width;
  EXPECT_EQ(width, isa() == Isa::v4 ? 16 : isa() == Isa::v3 ? 8 : 4);
}

TEST(Batch, EveryLaneIsWhatFloatGives) {
  std::vector<const BatchCheck*> checks = {&isa_host::batch_check, &isa_v2::batch_check};
  if (best_isa() >= Isa::v3) checks.push_back(&isa_v3::batch_check);
  if (best_isa() >= Isa::v4) checks.push_back(&isa_v4::batch_check);
  // All pairs of numbers at which comparisons and roundings differ, then random ones.
  constexpr float inf = std::numeric_limits<float>::infinity();
  const float special[] = {
      0.0f,     -0.0f, 1e-45f, -1e-45f, 0.5f,  1.5f,
      2.5f,     -0.5f, -1.5f,  1e9f,    -1e9f, 3.4e38f,
      -3.4e38f, inf,   -inf,   1.0f,    -1.0f, std::numeric_limits<float>::quiet_NaN()};
  std::vector<float> a(1), b(1);  // from an odd place on: no alignment is needed
  for (const float x : special)
    for (const float y : special) a.push_back(x), b.push_back(y);
  Random random(1);
  while (a.size() < 4097) {
    a.push_back(static_cast<float>(random.uniform(-100, 100)));
    b.push_back(static_cast<float>(random.uniform(-100, 100)));
  }
  for (const BatchCheck* check : checks) {
    const char* wrong =
        check->disagreement(a.data() + 1, b.data() + 1, static_cast<int>(a.size()) - 1);
    EXPECT_EQ(wrong, nullptr) << wrong << " at width " << check->width;
  }
}

// A weak symbol outside its isa_ namespace would exist in three versions, of which the
// linker keeps any one: an illegal instruction on somebody's older processor.
TEST(Isa, KernelObjectsLeakNoWeakSymbol) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "sanitizers bring weak symbols of their own";
#endif
  if (std::system("nm --version > /dev/null 2>&1") != 0) GTEST_SKIP() << "no nm";
  int objects = 0;
  for (const auto& entry :
       std::filesystem::recursive_directory_iterator(BRUME_BUILD_DIR)) {
    const std::string path = entry.path().string();
    if (entry.path().extension() != ".o") continue;
    // Of other people's templates the object that is linked is the sealed one.
    bool kernel = false;
    for (const std::string isa : {"v2", "v3", "v4"})
      kernel = kernel || path.ends_with("_sealed_" + isa + ".o") ||
               (path.find("_" + isa + ".dir/") != path.npos &&
                path.find("_sealed_" + isa + ".dir/") == path.npos);
    if (!kernel) continue;
    ++objects;
    FILE* nm = popen(("nm -C --defined-only '" + path + "'").c_str(), "r");
    ASSERT_NE(nm, nullptr);
    for (char line[4096]; std::fgets(line, sizeof line, nm);) {
      const std::string text = line;
      const bool weak = text.find(" W ") != text.npos || text.find(" V ") != text.npos ||
                        text.find(" u ") != text.npos;
      const bool ours = text.find("isa_v") != text.npos;
      const bool compilers = text.find("DW.ref.") != text.npos;  // data, the same in all
      EXPECT_FALSE(weak && !ours && !compilers) << path << ": " << text;
    }
    pclose(nm);
  }
  EXPECT_GE(objects, 3);
}

}  // namespace
}  // namespace brume::test
