// What the stages that draw slabs share. The target holds some layers of a volume one after the
// other, each in a tile of one image or, where no tiles are in a row, in a layer of its own.
layout(location = 0) uniform ivec4 skybark_layers; // x, y: a layer's sides, z: the first, w: how many
layout(location = 1) uniform ivec4 skybark_tiles;  // x: tiles in a row, z, w: the target's sides

// Where the target's n-th layer begins, in pixels.
ivec2 skybark_origin(int n) {
    return skybark_tiles.x == 0
               ? ivec2(0)
               : ivec2(n % skybark_tiles.x, n / skybark_tiles.x) * skybark_layers.xy;
}

bool skybark_empty(voxel_slab slab) { return any(greaterThanEqual(slab.low, slab.high)); }

// Nothing, in the target's first layer.
voxel_slab skybark_nothing() { return voxel_slab(ivec2(0), ivec2(0), skybark_layers.z); }

// As much of an element's s-th slab as lies in the target's layers.
voxel_slab skybark_visible(uint i, uint s) {
    voxel_slab slab = kernel_slab(i, s);
    slab.low = max(slab.low, ivec2(0));
    slab.high = min(slab.high, skybark_layers.xy);
    bool inside =
        slab.slice >= skybark_layers.z && slab.slice - skybark_layers.z < skybark_layers.w;
    if (!inside || skybark_empty(slab)) {
        return skybark_nothing();
    }
    return slab;
}

// A corner in clip space: 0 and 3 are opposite. The edges of voxels are those of pixels.
vec4 skybark_corner(voxel_slab slab, uint corner) {
    ivec2 at = ivec2((corner & 1u) != 0u ? slab.high.x : slab.low.x,
                     (corner & 2u) != 0u ? slab.high.y : slab.low.y);
    at += skybark_origin(slab.slice - skybark_layers.z);
    return vec4(vec2(2 * at - skybark_tiles.zw) / vec2(skybark_tiles.zw), 0.0, 1.0);
}
