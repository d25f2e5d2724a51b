// Shared by living surfaces: noise on the rest position, relief without texture coordinates, blood and burns.

// Value noise on a grid, with its analytic gradient: (value in [-1, 1], gradient). After Quilez, "Value noise
// derivatives". An integer hash gives the same bits on every card.
uint hash(uvec3 c) {
    uint h = c.x * 1664525u + c.y * 22695477u + c.z * 2891336453u;
    h = (h ^ (h >> 15u)) * 2246822519u;
    h = (h ^ (h >> 13u)) * 3266489917u;
    return h ^ (h >> 16u);
}
float corner(uvec3 c) { return float(hash(c) >> 8u) * (2.0 / 16777215.0) - 1.0; }

vec4 noise(highp vec3 p) {
    highp vec3 cell = floor(p);
    vec3 f = p - cell;
    uvec3 c = uvec3(ivec3(cell));
    vec3 u = f * f * f * (f * (f * 6.0 - 15.0) + 10.0);
    vec3 du = 30.0 * f * f * (f * (f - 2.0) + 1.0);
    float a = corner(c);
    float b = corner(c + uvec3(1u, 0u, 0u));
    float d = corner(c + uvec3(0u, 1u, 0u));
    float e = corner(c + uvec3(1u, 1u, 0u));
    float g = corner(c + uvec3(0u, 0u, 1u));
    float h = corner(c + uvec3(1u, 0u, 1u));
    float i = corner(c + uvec3(0u, 1u, 1u));
    float j = corner(c + uvec3(1u, 1u, 1u));
    float k1 = b - a, k2 = d - a, k3 = g - a;
    float k4 = a - b - d + e, k5 = a - d - g + i, k6 = a - b - g + h;
    float k7 = -a + b + d - e + g - h - i + j;
    float value = a + k1 * u.x + k2 * u.y + k3 * u.z + k4 * u.x * u.y + k5 * u.y * u.z + k6 * u.z * u.x
                + k7 * u.x * u.y * u.z;
    vec3 gradient = du * vec3(k1 + k4 * u.y + k6 * u.z + k7 * u.y * u.z,
                              k2 + k5 * u.z + k4 * u.x + k7 * u.z * u.x,
                              k3 + k6 * u.x + k5 * u.y + k7 * u.x * u.y);
    return vec4(value, gradient);
}

// A cell's point, by its hash: around the middle of the cell, within a range of `spread` cells.
vec3 scattered(uint h, float spread) {
    return vec3(h & 1023u, (h >> 10u) & 1023u, (h >> 20u) & 1023u) * (spread / 1023.0) + 0.5 * (1.0 - spread);
}

// Distance in cells to the nearest of points scattered one per cell, and the place of that point (Worley, "A cellular
// texture basis function", 1996). Only the eight nearest cells are searched: a farther point is found too late, which
// is not visible.
vec4 nearestPoint(highp vec3 p) {
    highp vec3 first = floor(p - 0.5);
    vec4 nearest = vec4(8.0);
    for (int k = 0; k < 8; k++) {
        highp vec3 cell = first + vec3(k & 1, (k >> 1) & 1, k >> 2);
        uint h = hash(uvec3(ivec3(cell)));
        vec3 point = scattered(h, 0.7);
        vec3 away = p - cell - point;
        float squared = dot(away, away);
        if (squared < nearest.x) nearest = vec4(squared, away);
    }
    return vec4(sqrt(nearest.x), nearest.yzw);
}

// A net of vessels: the borders between cells of scattered points (Worley's, as above). They fork where three cells
// meet; each border has its own width, and some are left out, so that the net has ends. `width` in cells, measured
// along the surface, whose normal is `n`: otherwise a border parallel to the surface would be a blot.
float vesselNet(highp vec3 p, vec3 n, float width, float footprint) {
    highp vec3 first = floor(p - 0.5);
    vec4 nearest = vec4(8.0), second = vec4(8.0);
    uint one = 0u, two = 0u;
    for (int k = 0; k < 8; k++) {
        highp vec3 cell = first + vec3(k & 1, (k >> 1) & 1, k >> 2);
        uint h = hash(uvec3(ivec3(cell)));
        vec3 point = scattered(h, 0.9);
        vec3 away = p - cell - point;
        float squared = dot(away, away);
        if (squared < nearest.x) { second = nearest; two = one; nearest = vec4(squared, away); one = h; }
        else if (squared < second.x) { second = vec4(squared, away); two = h; }
    }
    vec3 across = second.yzw - nearest.yzw;
    float apart = max(length(across), 1e-3), away = 0.5 * (second.x - nearest.x) / apart;
    float chance = float(((one ^ two) * 2654435761u) >> 8u) * (1.0 / 16777216.0);
    float wide = width * mix(-0.5, 1.7, chance) * length(cross(across, n)) / apart;
    if (wide <= 1e-4) return 0.0;
    float soft = max(wide, footprint);
    return (1.0 - smoothstep(wide, wide + soft, away)) * 1.5 * wide / (wide + 0.5 * soft);
}

// The noise lies on a grid, so each octave is rotated and no direction shows.
const mat3 turn = mat3(0.36, 0.48, -0.8, -0.8, 0.6, 0.0, 0.48, 0.64, 0.6);

// How much of a pattern of this frequency (cells per cell of the coarsest) a pixel still resolves: unresolved patterns
// must fade, or they would flicker.
float resolved(float footprint, float frequency) { return 1.0 - smoothstep(0.25, 0.7, footprint * frequency); }

// The normal of a relief whose slope with respect to p = noiseScale * rest is given. Height differences along the
// screen are converted into a slope of the present surface (Mikkelsen, "Bump mapping unparametrized surfaces on the
// GPU", 2010), so it needs no texture coordinates and follows the deformation.
vec3 reliefNormal(vec3 slope, highp vec3 px, highp vec3 py, float noiseScale) {
    highp vec3 wx = dFdx(getWorldPosition()), wy = dFdy(getWorldPosition());
    vec3 n = normalize(getWorldGeometricNormalVector());
    float scale = 1.0 / noiseScale;
    float hx = dot(slope, px) * scale, hy = dot(slope, py) * scale;
    highp vec3 r1 = cross(wy, n), r2 = cross(n, wx);
    highp float area = dot(wx, r1);
    vec3 surface = sign(area) * (hx * r1 + hy * r2);
    vec3 bumped = normalize(abs(area) * n - surface + 1e-20 * n);
    return normalize(transpose(getWorldTangentFrame()) * bumped);
}

// Blood, burn and wetness are given at the vertices, which are far apart: noise decides where a film ends between two
// vertices.
struct Marks {
    float blood; // coverage by blood, in [0, 1]
    float bloodDepth; // its depth, in [0, 1]
    float bloodClear; // exp(-depth / 0.25 mm)
    vec3 bloodSlope; // slope of its surface, with respect to p
    float pale;       // coagulated by heat
    float brown;      // scorched
    float black;      // charred
};

// 0 stays 0 and 1 stays 1, whatever the noise; between them it moves the edge.
float broken(float amount, float value, float by) { return amount * (1.0 + by) - by * (0.5 + 0.5 * clamp(value, -1.0, 1.0)); }

// How burnt it looks where heat has gone this far: 0 where tissue begins to be damaged, 9/7 where it boils, 16/7 where it
// is dry. Levels are linear in the temperature, so what they say between two vertices is sensible.
float burnOf(float level) {
    float dry = clamp(level - 9.0 / 7.0, 0.0, 1.0);
    return 0.28 * clamp(2.0 * level + 0.5, 0.0, 1.0) + 0.8 * dry * dry;
}

// `heatShare`: the level of the heat as a share of its range from -1 to 3.
Marks marksOf(vec3 state, float heatShare, highp vec3 p, float footprint) {
    Marks marks = Marks(0.0, 0.0, 1.0, vec3(0.0), 0.0, 0.0, 0.0);
    float level = 4.0 * heatShare - 1.0;
    if (state.x + state.y <= 0.0 && level <= -0.4) return marks;
    float w = resolved(footprint, 3.7);
    vec4 coarse = noise(p * 0.85 + 71.3), fine = w * noise(turn * p * 2.4 + 17.9);
    vec3 gradient = 0.7 * 0.85 * coarse.yzw + 0.4 * 2.4 * (fine.yzw * turn);
    float value = 1.25 * (0.7 * coarse.x + 0.4 * fine.x);

    const float kByBlood = 0.9;
    float film = broken(state.x, value, kByBlood);
    float edge = 0.07 + 0.25 * footprint;
    marks.blood = smoothstep(0.0, edge, film);
    marks.bloodClear = 1.0 - clamp(film, 0.0, 1.0);
    marks.bloodDepth = smoothstep(0.0, 0.75, film);
    // A drop rises at its edge and is level inside: steep only where it is shallow.
    float rise = film > 0.0 ? exp(-9.0 * film) * min(film / edge, 1.0) : 0.0;
    marks.bloodSlope = -1.1 * kByBlood * 0.5 * 1.25 * gradient * rise * w;

    float heat = max(broken(state.y, 0.8 * value, 0.45), burnOf(level - 0.25 * value));
    marks.pale = smoothstep(0.0, 0.25, heat);
    marks.brown = smoothstep(0.22, 0.5, heat);
    marks.black = smoothstep(0.5, 0.72, heat);
    return marks;
}

// The seam of a cut, in [0, 1]. `rim` is 1 at the vertices on the rim, 0 at the others and linear between, so the distance
// to the rim is what is missing to 1 over the slope. A line of 0.4 mm, or three pixels if that is more; the tissue beside it
// is reddened a little. A triangle with all its vertices on the rim has no slope: the seam is drawn by those beside it.
float seamOf(float rim, highp vec3 px, highp vec3 py, float footprint, float noiseScale) {
    if (rim < 0.01) return 0.0;
    float rx = dFdx(rim), ry = dFdy(rim);
    highp float xx = dot(px, px), xy = dot(px, py), yy = dot(py, py), area = xx * yy - xy * xy;
    highp float slope = sqrt(max(rx * rx * yy - 2.0 * rx * ry * xy + ry * ry * xx, 0.0) / max(area, 1e-20));
    if (slope * footprint < 1e-4) return 0.0;
    highp float away = (1.0 - rim) / slope, half_ = max(0.0002 * noiseScale, 1.5 * footprint);
    return 0.8 * (1.0 - smoothstep(0.4 * half_, half_, away)) + 0.2 * (1.0 - smoothstep(half_, 5.0 * half_, away));
}

// The colour under blood and burns. Blood is lit by what comes back through it, by the law of Beer and Lambert: red light
// passes a film of a quarter of a millimetre, green and blue light a tenth of it. A deep film is nearly black.
vec3 markedColor(vec3 color, Marks marks, float grain) {
    vec3 dark = mix(vec3(0.10, 0.042, 0.018), vec3(0.011, 0.009, 0.008) * (1.0 + 0.8 * grain), marks.black);
    vec3 scalded = vec3(0.56, 0.42, 0.32) * (0.9 + 0.25 * grain);
    color = mix(mix(color, scalded, 0.85 * marks.pale), dark, marks.brown);
    vec3 film = mix(vec3(0.145, 0.0026, 0.0020), color, pow(vec3(marks.bloodClear), vec3(1.2, 8.0, 9.0)));
    return mix(color, film, marks.blood);
}
