#pragma once
// The OpenGL backend: OpenGL 4.5 core, through geometry shaders, transform feedback and compute.
//
//     auto device = skybark::opengl::device::create({[](const char* name, void*) {
//         return glfwGetProcAddress(name); }});
//
// It works in the context that is current and restores every state that it touches. To have a
// context made, include headless.hpp beside this.

#include <skybark/opengl/device.hpp>
#include <skybark/opengl/programs/bark.hpp>
#include <skybark/opengl/programs/billboard_depth.hpp>
#include <skybark/opengl/programs/branch_cap.hpp>
#include <skybark/opengl/programs/branch_detail.hpp>
#include <skybark/opengl/programs/branch_join.hpp>
#include <skybark/opengl/programs/branch_tip.hpp>
#include <skybark/opengl/programs/bundle_corner.hpp>
#include <skybark/opengl/programs/bundle_count.hpp>
#include <skybark/opengl/programs/bundle_crowds.hpp>
#include <skybark/opengl/programs/bundle_hits.hpp>
#include <skybark/opengl/programs/bundle_key.hpp>
#include <skybark/opengl/programs/bundle_more.hpp>
#include <skybark/opengl/programs/bundle_order.hpp>
#include <skybark/opengl/programs/cast_leaf_shadow.hpp>
#include <skybark/opengl/programs/cast_shadow.hpp>
#include <skybark/opengl/programs/clear_sky.hpp>
#include <skybark/opengl/programs/clouded_ground.hpp>
#include <skybark/opengl/programs/detailed_branch.hpp>
#include <skybark/opengl/programs/develop.hpp>
#include <skybark/opengl/programs/directional_light.hpp>
#include <skybark/opengl/programs/gather_light.hpp>
#include <skybark/opengl/programs/gather_sun.hpp>
#include <skybark/opengl/programs/gathered_irradiance.hpp>
#include <skybark/opengl/programs/grid_impulse.hpp>
#include <skybark/opengl/programs/grid_wind.hpp>
#include <skybark/opengl/programs/harris_order.hpp>
#include <skybark/opengl/programs/harris_read.hpp>
#include <skybark/opengl/programs/harris_splat.hpp>
#include <skybark/opengl/programs/hermite_branch.hpp>
#include <skybark/opengl/programs/layer_hits.hpp>
#include <skybark/opengl/programs/leaf_blade.hpp>
#include <skybark/opengl/programs/light_at_points.hpp>
#include <skybark/opengl/programs/lit_bark.hpp>
#include <skybark/opengl/programs/lit_branch.hpp>
#include <skybark/opengl/programs/lit_grid.hpp>
#include <skybark/opengl/programs/lit_leaf.hpp>
#include <skybark/opengl/programs/lit_puff.hpp>
#include <skybark/opengl/programs/meadow_ground.hpp>
#include <skybark/opengl/programs/merge_chains.hpp>
#include <skybark/opengl/programs/merge_ends.hpp>
#include <skybark/opengl/programs/particle_impulse.hpp>
#include <skybark/opengl/programs/patch_samples.hpp>
#include <skybark/opengl/programs/pose_ends.hpp>
#include <skybark/opengl/programs/probe_image.hpp>
#include <skybark/opengl/programs/probe_level.hpp>
#include <skybark/opengl/programs/probe_map.hpp>
#include <skybark/opengl/programs/probe_peel.hpp>
#include <skybark/opengl/programs/probe_rings.hpp>
#include <skybark/opengl/programs/probe_slabs.hpp>
#include <skybark/opengl/programs/probe_strips.hpp>
#include <skybark/opengl/programs/probe_surface.hpp>
#include <skybark/opengl/programs/probe_volume.hpp>
#include <skybark/opengl/programs/probe_volume_draw.hpp>
#include <skybark/opengl/programs/probe_voxels.hpp>
#include <skybark/opengl/programs/ring_indices.hpp>
#include <skybark/opengl/programs/scatter_average.hpp>
#include <skybark/opengl/programs/scatter_coarsen.hpp>
#include <skybark/opengl/programs/scatter_limit.hpp>
#include <skybark/opengl/programs/scatter_medium.hpp>
#include <skybark/opengl/programs/scatter_prolong.hpp>
#include <skybark/opengl/programs/scatter_relax.hpp>
#include <skybark/opengl/programs/scatter_restrict.hpp>
#include <skybark/opengl/programs/scatter_source.hpp>
#include <skybark/opengl/programs/seen_surface.hpp>
#include <skybark/opengl/programs/segment_rings.hpp>
#include <skybark/opengl/programs/shadow_polygon.hpp>
#include <skybark/opengl/programs/shadow_slab.hpp>
#include <skybark/opengl/programs/surface_light.hpp>
#include <skybark/opengl/programs/surface_triangles.hpp>
#include <skybark/opengl/programs/sway_bends.hpp>
#include <skybark/opengl/programs/sway_energies.hpp>
#include <skybark/opengl/programs/sway_forces.hpp>
#include <skybark/opengl/programs/sway_inertia.hpp>
#include <skybark/opengl/programs/sway_moments.hpp>
#include <skybark/opengl/programs/sway_motion.hpp>
#include <skybark/opengl/programs/wave_wind.hpp>
#include <skybark/opengl/programs/wind_load.hpp>
