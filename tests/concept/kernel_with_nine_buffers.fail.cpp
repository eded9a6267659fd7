// expect: a kernel names at most eight buffers
#include <skybark/core/kernel.hpp>

using r = skybark::readonly<std::uint32_t>;

struct nine {
    using buffers = skybark::buffer_list<r, r, r, r, r, r, r, r, r>;
};

std::size_t size = nine::buffers::size;
