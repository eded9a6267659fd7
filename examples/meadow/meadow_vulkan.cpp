#include <meadow/make_meadow.hpp>
#include <skybark/vulkan/vulkan.hpp>

template class skybark::meadow::meadow<skybark::vulkan::device>;
