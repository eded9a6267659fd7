#pragma once
// Skybark: GPU algorithms for natural scenes. The contract and the algorithms; add a backend:
// <skybark/cpu/cpu.hpp>, <skybark/opengl/opengl.hpp> or <skybark/vulkan/vulkan.hpp>.

#include <skybark/core/backend.hpp>
#include <skybark/core/validated.hpp>
#include <skybark/trees/bark_mesh.hpp>
#include <skybark/trees/branch_mesh.hpp>
#include <skybark/trees/build_skeleton.hpp>
#include <skybark/trees/closed_mesh.hpp>
#include <skybark/trees/species.hpp>
#include <skybark/trees/wind.hpp>
