// A texture in place of a colour. `textured`: 0 none; 1 an image file, decoded by the card; 2 the picture of a view,
// whose first row is at the bottom and whose colours are encoded.
vec3 decoded(vec3 c) { return mix(c / 12.92, pow((c + 0.055) / 1.055, vec3(2.4)), step(0.04045, c)); }

vec3 baseColorOf(vec3 color, int textured, sampler2D picture, highp vec2 uv) {
    vec3 texel = texture(picture, textured == 2 ? vec2(uv.x, 1.0 - uv.y) : uv).rgb;
    return textured == 0 ? color : textured == 1 ? texel : decoded(texel);
}

// The maps beside the colour, whose texels are plain numbers. `maps` tells which there are: 1 normals, 2 roughness,
// 4 occlusion.
const int kNormalMap = 1, kRoughnessMap = 2, kOcclusionMap = 4;

// The normal in the frame of the uv, x along growing u and y along growing v, of any length. 128 is level.
vec3 mappedNormal(int maps, sampler2D map, highp vec2 uv, float strength) {
    if ((maps & kNormalMap) == 0) return vec3(0.0, 0.0, 1.0);
    vec3 n = texture(map, uv).xyz * (255.0 / 127.0) - 128.0 / 127.0;
    return vec3(strength * n.xy, max(n.z, 0.05));
}

// A fine relief upon a mapped normal: the slopes of both, each in full where the other is level ("whiteout": Barre-Brisebois
// and Hill, "Blending in Detail", 2012).
vec3 withRelief(vec3 mapped, vec3 relief) {
    return normalize(vec3(mapped.xy + relief.xy, mapped.z * relief.z));
}

float mappedRoughness(int maps, sampler2D map, highp vec2 uv, float roughness) {
    return (maps & kRoughnessMap) == 0 ? roughness : clamp(texture(map, uv).g, 0.05, 1.0);
}

float mappedOcclusion(int maps, sampler2D map, highp vec2 uv, float strength) {
    return (maps & kOcclusionMap) == 0 ? 1.0 : mix(1.0, texture(map, uv).r, strength);
}

// The colour that lamps light in a crevice. Filament dims only the surroundings' light, of which an endoscope has little:
// half of the occlusion (chosen by eye: the lamp sits beside the lens and reaches much of what is seen) dims the lamps'
// light too. It reddens tissue, because light that leaves a crevice has met its walls several times (the fit of Jimenez
// et al., "Practical realtime strategies for accurate indirect occlusion", 2016).
vec3 occludedColor(vec3 color, float open) {
    float seen = mix(1.0, open, 0.5);
    vec3 a = 2.0404 * color - 0.3324, b = -4.7951 * color + 0.6417, c = 2.7552 * color + 0.6903;
    return color * max(vec3(seen), ((seen * a + b) * seen + c) * seen);
}
