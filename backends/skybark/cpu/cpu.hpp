#pragma once
// The CPU backend in one include.

#include <skybark/cpu/bark.hpp>
#include <skybark/cpu/device.hpp>
#include <skybark/cpu/gather_light.hpp>
#include <skybark/cpu/harris_splat.hpp>
#include <skybark/cpu/hermite_branch.hpp>
#include <skybark/cpu/leaf_blade.hpp>
#include <skybark/cpu/particle_layers.hpp>
#include <skybark/cpu/scatter.hpp>
#include <skybark/cpu/sway.hpp>
#include <skybark/cpu/wave_wind.hpp>
