// What the registry finds, and what it says when it does not.

#include "stage/registry.h"

#include <gtest/gtest.h>

#include "num/error.h"
#include "stage/instance.h"

namespace {

using namespace brume;

TEST(Registry, FindsHeightFogInTheBuildTree) {
  Registry r;
  const StageType& t = r.find("height_fog");
  EXPECT_EQ(t.name, "height_fog");
  StageCache cache;
  Settings s = Settings::defaults(t.specs);
  StageInstance i(t, "fog", s.at(1), cache);
  World w;
  EXPECT_TRUE(i.needs({}).idle.empty());
  i.publish({}, 0, w);
  ASSERT_EQ(w.media.size(), 1u);
  EXPECT_EQ(w.media[0].what.extinction[1], 0.002);
}

}  // namespace
