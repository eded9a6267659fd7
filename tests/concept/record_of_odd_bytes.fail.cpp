// expect: sizeof ?\((T|odd)\) % 4 == 0
#include <skybark/core/kernel.hpp>

struct odd {
    char bytes[5];
};

using slot = skybark::readonly<odd>;
