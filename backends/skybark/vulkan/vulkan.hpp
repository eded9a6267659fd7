#pragma once
// The Vulkan backend in one include, with the programs of the kernels that we ship. A VkDevice to
// run it on is yours, or headless.hpp's.

#include <skybark/vulkan/transfers.hpp>

#include <skybark/vulkan/programs/bark.hpp>
#include <skybark/vulkan/programs/branch_cap.hpp>
#include <skybark/vulkan/programs/branch_detail.hpp>
#include <skybark/vulkan/programs/branch_join.hpp>
#include <skybark/vulkan/programs/branch_tip.hpp>
#include <skybark/vulkan/programs/cast_leaf_shadow.hpp>
#include <skybark/vulkan/programs/cast_shadow.hpp>
#include <skybark/vulkan/programs/clear_sky.hpp>
#include <skybark/vulkan/programs/detailed_branch.hpp>
#include <skybark/vulkan/programs/develop.hpp>
#include <skybark/vulkan/programs/grid_wind.hpp>
#include <skybark/vulkan/programs/hermite_branch.hpp>
#include <skybark/vulkan/programs/leaf_blade.hpp>
#include <skybark/vulkan/programs/lit_bark.hpp>
#include <skybark/vulkan/programs/lit_branch.hpp>
#include <skybark/vulkan/programs/lit_leaf.hpp>
#include <skybark/vulkan/programs/meadow_ground.hpp>
#include <skybark/vulkan/programs/merge_chains.hpp>
#include <skybark/vulkan/programs/merge_ends.hpp>
#include <skybark/vulkan/programs/pose_ends.hpp>
#include <skybark/vulkan/programs/probe_image.hpp>
#include <skybark/vulkan/programs/probe_level.hpp>
#include <skybark/vulkan/programs/probe_map.hpp>
#include <skybark/vulkan/programs/probe_rings.hpp>
#include <skybark/vulkan/programs/probe_slabs.hpp>
#include <skybark/vulkan/programs/probe_strips.hpp>
#include <skybark/vulkan/programs/probe_surface.hpp>
#include <skybark/vulkan/programs/probe_volume.hpp>
#include <skybark/vulkan/programs/probe_volume_draw.hpp>
#include <skybark/vulkan/programs/probe_voxels.hpp>
#include <skybark/vulkan/programs/ring_indices.hpp>
#include <skybark/vulkan/programs/segment_rings.hpp>
#include <skybark/vulkan/programs/sway_bends.hpp>
#include <skybark/vulkan/programs/sway_energies.hpp>
#include <skybark/vulkan/programs/sway_forces.hpp>
#include <skybark/vulkan/programs/sway_inertia.hpp>
#include <skybark/vulkan/programs/sway_moments.hpp>
#include <skybark/vulkan/programs/sway_motion.hpp>
#include <skybark/vulkan/programs/wave_wind.hpp>
#include <skybark/vulkan/programs/wind_load.hpp>
