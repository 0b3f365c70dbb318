// Tables on disk: the same bits as were solved, whatever happens to the files.

#include <gtest/gtest.h>
#include <unistd.h>

#include <atomic>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <thread>
#include <vector>

#include "models_test.h"
#include "store.h"

namespace {

using namespace brume;
using namespace brume::sky;

class Store : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = testing::TempDir() + "brume_sky_" + std::to_string(getpid());
    setenv("BRUME_CACHE", folder_.c_str(), 1);
  }
  void TearDown() override {
    std::filesystem::remove_all(folder_);
    setenv("BRUME_CACHE", "off", 1);
  }
  std::vector<std::filesystem::path> files() const {
    std::vector<std::filesystem::path> out;
    if (std::filesystem::exists(folder_))
      for (const auto& f : std::filesystem::directory_iterator(folder_))
        out.push_back(f.path());
    return out;
  }
  // What a small model sees, bit for bit.
  static std::vector<double> look(const Atmosphere& a = preset("earth", kThree)) {
    Quality q = Quality::fast();
    q.resolution.altitudes = 6, q.resolution.suns = 12;
    const Model m(a, q);
    std::vector<double> out;
    for (double view : {10., 88., 95.})
      for (double sun : {20., 80., 93.}) {
        double L[3], T[3];
        m.see(ray_at(500, view, sun, 30), L, T);
        out.insert(out.end(), L, L + 3), out.insert(out.end(), T, T + 3);
      }
    return out;
  }
  std::string folder_;
};

TEST_F(Store, GivesTheBitsThatWereSolved) {
  const auto solved = look();
  ASSERT_EQ(files().size(), 1u);
  const auto written = std::filesystem::last_write_time(files()[0]);
  EXPECT_EQ(look(), solved);
  EXPECT_EQ(std::filesystem::last_write_time(files()[0]), written);
  setenv("BRUME_CACHE", "off", 1);
  EXPECT_EQ(look(), solved);
}

TEST_F(Store, KnowsEveryInput) {
  const auto solved = look();
  Atmosphere a = preset("earth", kThree);
  a.ground_albedo[2] += 1e-12;
  look(a);
  EXPECT_EQ(files().size(), 2u);
  EXPECT_NE(key_of(a, Quality{}), key_of(preset("earth", kThree), Quality{}));
  Quality q;
  ++q.resolution.next.panels;
  EXPECT_NE(key_of(a, q), key_of(a, Quality{}));
}

TEST_F(Store, BuildsAgainWhatIsBroken) {
  const auto solved = look();
  ASSERT_EQ(files().size(), 1u);
  const auto file = files()[0];
  const auto size = std::filesystem::file_size(file);
  std::ifstream in(file, std::ios::binary);
  const std::string whole{std::istreambuf_iterator<char>(in), {}};
  for (int harm = 0; harm < 6; ++harm) {
    std::string bytes = whole;
    if (harm == 0) bytes.clear();
    if (harm == 1) bytes.resize(size / 2);
    if (harm == 2) bytes[size / 2] ^= 1;        // a bit of a number
    if (harm == 3) bytes[40] ^= 1;              // of the key
    if (harm == 4) bytes += "more";             // longer than it says
    if (harm == 5) bytes.assign(size, '\xff');  // NaN throughout
    std::ofstream(file, std::ios::binary) << bytes;
    EXPECT_EQ(look(), solved) << harm;
    EXPECT_EQ(std::filesystem::file_size(file), size) << harm;
  }
}

TEST_F(Store, WritersAtOnceLeaveAWholeFile) {
  setenv("BRUME_CACHE", "off", 1);
  const auto solved = look();
  setenv("BRUME_CACHE", folder_.c_str(), 1);
  std::vector<std::thread> threads;
  std::atomic<int> wrong = 0;
  for (int i = 0; i < 8; ++i)
    threads.emplace_back([&] {
      if (look() != solved) ++wrong;
    });
  for (auto& t : threads) t.join();
  EXPECT_EQ(wrong, 0);
  EXPECT_EQ(files().size(), 1u);  // none left beside
  EXPECT_EQ(look(), solved);
}

TEST_F(Store, DoesWithoutAFolder) {
  setenv("BRUME_CACHE", "/proc/no such folder", 1);
  const auto solved = look();
  setenv("BRUME_CACHE", "off", 1);
  EXPECT_EQ(look(), solved);
  EXPECT_EQ(store_folder(), "");
}

}  // namespace
