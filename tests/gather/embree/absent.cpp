// In place of hits.cpp where there is no Embree.

#include <gtest/gtest.h>

TEST(gather_hits, are_those_of_embree) {
    GTEST_SKIP() << "Embree (libembree-dev) was not found when this was built.";
}
