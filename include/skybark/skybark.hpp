#pragma once
// Skybark: GPU algorithms for natural scenes. The contract and the algorithms; add a backend:
// <skybark/cpu/cpu.hpp>, <skybark/opengl/opengl.hpp> or <skybark/vulkan/vulkan.hpp>.
// The reference path tracer, <skybark/clouds/path_tracer.hpp>, is for those who check.

#include <skybark/clouds/attenuation_volume.hpp>
#include <skybark/clouds/cloud_billboards.hpp>
#include <skybark/clouds/cloud_density.hpp>
#include <skybark/clouds/cumulus.hpp>
#include <skybark/clouds/drift.hpp>
#include <skybark/clouds/harris.hpp>
#include <skybark/clouds/light_box.hpp>
#include <skybark/clouds/multiple_scattering.hpp>
#include <skybark/clouds/phase.hpp>
#include <skybark/clouds/torn_billboards.hpp>
#include <skybark/core/backend.hpp>
#include <skybark/core/validated.hpp>
#include <skybark/gather/bounces.hpp>
#include <skybark/gather/bundle.hpp>
#include <skybark/gather/bundle_peeler.hpp>
#include <skybark/gather/bundle_resolver.hpp>
#include <skybark/gather/directions.hpp>
#include <skybark/gather/final_gather.hpp>
#include <skybark/gather/gathered_state.hpp>
#include <skybark/gather/irradiance_volume.hpp>
#include <skybark/gather/lightmap.hpp>
#include <skybark/gather/scene.hpp>
#include <skybark/trees/bark_mesh.hpp>
#include <skybark/trees/bark_texture.hpp>
#include <skybark/trees/branch_layout.hpp>
#include <skybark/trees/branch_mesh.hpp>
#include <skybark/trees/build_skeleton.hpp>
#include <skybark/trees/closed_mesh.hpp>
#include <skybark/trees/detail.hpp>
#include <skybark/trees/gusts.hpp>
#include <skybark/trees/leaf_layout.hpp>
#include <skybark/trees/leaf_mesh.hpp>
#include <skybark/trees/leaf_texture.hpp>
#include <skybark/trees/skeleton.hpp>
#include <skybark/trees/species.hpp>
#include <skybark/trees/sway.hpp>
#include <skybark/trees/swaying_tree.hpp>
#include <skybark/trees/view_detail.hpp>
#include <skybark/trees/weber_penn.hpp>
#include <skybark/trees/wind.hpp>
#include <skybark/trees/wood.hpp>
