#include <skybark/kernels/ring_indices.hpp>

#include <gtest/gtest.h>
#include <vector>

using namespace skybark;

TEST(ring_indices, pattern_is_repeated_for_each_element) {
    const std::vector<std::uint32_t> pattern{0, 2, 1, 1, 2, 3};
    const kernels::ring_indices kernel{6, 5, 100};
    std::vector<std::uint32_t> indices(6 * 7);
    for (std::uint32_t i = 0; i < indices.size(); ++i) {
        kernel.map(i, pattern, indices);
    }
    for (std::uint32_t element = 0; element < 7; ++element) {
        for (std::uint32_t k = 0; k < 6; ++k) {
            EXPECT_EQ(indices[element * 6 + k], 100 + element * 5 + pattern[k]);
        }
    }
}
