// A texture in place of a colour. `textured`: 0 none; 1 an image file, decoded by the card; 2 the picture of a view,
// whose first row is at the bottom and whose colours are encoded.
vec3 decoded(vec3 c) { return mix(c / 12.92, pow((c + 0.055) / 1.055, vec3(2.4)), step(0.04045, c)); }

vec3 baseColorOf(vec3 color, int textured, sampler2D picture, highp vec2 uv) {
    vec3 texel = texture(picture, textured == 2 ? vec2(uv.x, 1.0 - uv.y) : uv).rgb;
    return textured == 0 ? color : textured == 1 ? texel : decoded(texel);
}
