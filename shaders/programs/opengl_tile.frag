#version 450
// A layer of a volume from its tile of a large image.
layout(location = 0) uniform ivec4 corner; // x, y: where the tile begins
layout(binding = 5, rg32f) readonly uniform image2D tiles;
layout(location = 0) out vec2 sum;

void main() { sum = imageLoad(tiles, ivec2(gl_FragCoord.xy) + corner.xy).xy; }
