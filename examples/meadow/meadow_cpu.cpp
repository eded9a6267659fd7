#include <meadow/make_meadow.hpp>
#include <skybark/cpu/cpu.hpp>

template class skybark::meadow::meadow<skybark::cpu::device>;
