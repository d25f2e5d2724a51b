#include "filasofia/testing/fuzz_body.h"

#include "filasofia/engine/rupture/tet_shape.h"

#include <algorithm>
#include <cmath>

namespace filasofia::testing {
using namespace engine;
namespace {

constexpr double kTurn = 6.283185307179586;

/// A plane to cut along, with two directions in it: along the blade and ahead, in which the blade moves.
struct CutPlane {
    Vec3 origin, normal, along, ahead;
};

/// A random plane: through a face, an edge or three nodes, normal to an axis, or anywhere; then shifted by 0, 1e-14,
/// 1e-12 or 1e-9 m.
CutPlane anyPlane(const EditableMesh& mesh, FuzzRandom& random)
{
    const MeshTopology& data = mesh.data();
    const auto anyNode = [&] { return data.rest[random.below(mesh.nodes())]; };
    const auto corners = solidCorners(data.tetrahedra[random.below(mesh.tetrahedra())], data.rest);
    CutPlane plane{anyNode(), random.direction(), {}, {}};
    switch (random.below(6)) {
    case 0:
        plane = {corners[0], cross(corners[1] - corners[0], corners[2] - corners[0]), {}, {}};
        break;
    case 1:
        plane = {corners[0], cross(corners[1] - corners[0], random.direction()), {}, {}};
        break;
    case 2:
        plane.normal = cross(anyNode() - plane.origin, anyNode() - plane.origin);
        break;
    case 3: {
        const int axis = random.below(3);
        plane.normal = {axis == 0 ? 1.0 : 0.0, axis == 1 ? 1.0 : 0.0, axis == 2 ? 1.0 : 0.0};
        break;
    }
    default:
        plane.origin += random.uniform(-0.5, 0.5) * mesh.meanEdge() * random.direction();
    }
    plane.normal = normalized(plane.normal, random.direction());
    constexpr double kOff[] = {0.0, 1e-14, 1e-12, 1e-9};
    plane.origin += (random.chance(0.5) ? 1.0 : -1.0) * kOff[random.below(4)] * plane.normal;
    const Vec3 u = normalized(cross(plane.normal, std::abs(plane.normal.x) < 0.9 ? Vec3{1, 0, 0} : Vec3{0, 1, 0}));
    const double turn = random.uniform(0.0, kTurn);
    plane.ahead = std::cos(turn) * u + std::sin(turn) * cross(plane.normal, u);
    plane.along = cross(plane.normal, plane.ahead);
    return plane;
}

/// A straight blade that moves by translation.
struct Blade {
    Vec3 from, to;

    void go(FuzzBody& body, BladeStroke& stroke, Vec3 way)
    {
        const BladeSegment segment{from + way, to + way, from, to};
        body.step(stroke, {&segment, 1});
        from = segment.from;
        to = segment.to;
    }
};

Blade bladeBefore(const CutPlane& plane, double behind, double width)
{
    const Vec3 middle = plane.origin - behind * plane.ahead;
    return {middle - 0.5 * width * plane.along, middle + 0.5 * width * plane.along};
}

std::optional<bool> cutPlane(FuzzBody& body, FuzzRandom& random, bool progressive)
{
    const CutPlane plane = anyPlane(body.mesh, random);
    const double d = body.mesh.diagonal(), length = 2.4 * d;
    const int steps = progressive
                          ? std::max(10, static_cast<int>(length / (random.uniform(0.05, 1.0) * body.mesh.meanEdge())))
                          : 3 + random.below(4);
    Blade blade = bladeBefore(plane, 0.5 * length, length);
    BladeStroke stroke(body.mesh.newSheet());
    for (int i = 0; i < steps; ++i) blade.go(body, stroke, (length / steps) * plane.ahead);
    body.finish(stroke);
    return body.bridged([&](Vec3 p) { return dot(plane.normal, p - plane.origin); });
}

/// Cuts along an arc through the whole body. `resumed`: with pauses, after which the cut goes on in the same surface.
std::optional<bool> cutArc(FuzzBody& body, FuzzRandom& random, bool curled, bool resumed)
{
    const CutPlane plane = anyPlane(body.mesh, random);
    const double h = body.mesh.meanEdge(), d = body.mesh.diagonal(), length = 2.4 * d;
    const int steps = std::max(10, static_cast<int>(length / (random.uniform(0.05, 1.0) * h)));
    const double curl = curled ? random.uniform(-1.5, 1.5) : 0.0, turn = curl / steps;
    // The arc passes through the plane's origin at half its length.
    Vec3 ahead = std::cos(-0.5 * curl) * plane.ahead + std::sin(-0.5 * curl) * plane.normal;
    Blade blade = bladeBefore(plane, 0.5 * length, length);
    if (std::abs(curl) > 1e-3) {
        const double radius = length / curl;
        const Vec3 start = plane.origin - radius * std::sin(0.5 * curl) * plane.ahead +
                           radius * (1.0 - std::cos(0.5 * curl)) * plane.normal;
        blade = {start - 0.5 * length * plane.along, start + 0.5 * length * plane.along};
    }
    std::vector<Vec3> path{0.5 * (blade.from + blade.to)};
    BladeStroke stroke(body.mesh.newSheet());
    for (int i = 0; i < steps; ++i) {
        const Vec3 up = normalized(cross(ahead, plane.along));
        ahead = normalized(std::cos(turn) * ahead + std::sin(turn) * -up);
        if (resumed && i > 0 && random.chance(0.12)) {
            body.finish(stroke);
            stroke = BladeStroke(stroke.sheet());
            if (random.chance(0.3)) { // the blade comes back a little behind its last place
                const Vec3 back = random.uniform(0.0, 1.0) * h * ahead;
                blade = {blade.from - back, blade.to - back};
                blade.go(body, stroke, back);
            }
        }
        blade.go(body, stroke, (length / steps) * ahead);
        path.push_back(0.5 * (blade.from + blade.to));
    }
    body.finish(stroke);
    return body.bridged([&](Vec3 p) {
        double nearest = 1e300, height = 0.0;
        for (std::size_t i = 0; i + 1 < path.size(); ++i) {
            const Vec3 e = path[i + 1] - path[i];
            Vec3 v = p - path[i];
            v -= dot(v, plane.along) * plane.along;
            v -= std::clamp(dot(v, e) / dot(e, e), 0.0, 1.0) * e;
            if (lengthSquared(v) >= nearest) continue;
            nearest = lengthSquared(v);
            height = std::copysign(std::sqrt(nearest), dot(v, cross(plane.along, e)));
        }
        return height;
    });
}

/// Cuts a strip somewhere, in one to three passes in the same surface or in others; with much curl it crosses itself.
std::optional<bool> cutStrip(FuzzBody& body, FuzzRandom& random, double maxCurl)
{
    CutPlane plane = anyPlane(body.mesh, random);
    const double d = body.mesh.diagonal(), length = random.uniform(0.1, 1.2) * d;
    const int steps = 1 + random.below(40);
    const double turn = random.uniform(-maxCurl, maxCurl) / steps;
    Blade blade = bladeBefore(plane, random.uniform(0.0, 0.7) * length, random.uniform(0.05, 1.0) * d);
    const Vec3 along = plane.along;
    BladeStroke stroke(body.mesh.newSheet());
    const Blade start = blade;
    const Vec3 first = plane.ahead;
    for (int pass = random.below(3); pass >= 0; --pass) {
        for (int i = 0; i < steps; ++i) {
            const Vec3 up = normalized(cross(plane.ahead, along));
            plane.ahead = normalized(std::cos(turn) * plane.ahead - std::sin(turn) * up);
            blade.go(body, stroke, (length / steps) * plane.ahead);
        }
        if (pass == 0) break;
        body.finish(stroke);
        stroke = BladeStroke(random.chance(0.5) ? stroke.sheet() : body.mesh.newSheet());
        if (random.chance(0.7)) { // once more along the same path
            blade = start;
            plane.ahead = first;
        }
    }
    body.finish(stroke);
    return std::nullopt;
}

/// Saws to and fro through the middle of moving tissue.
std::optional<bool> saw(FuzzBody& body, FuzzRandom& random, bool fresh)
{
    const double d = body.mesh.diagonal(), stroke = random.uniform(0.2, 0.6) * body.mesh.meanEdge();
    CutPlane plane = anyPlane(body.mesh, random);
    plane.origin = body.waves.centre + 0.1 * d * random.direction();
    // The volume that the plane would cut off if the tissue did not move; slices that are thinner than the snapping
    // distance are not cut off.
    double below = 0.0;
    for (int t = 0; t < body.mesh.tetrahedra(); ++t) {
        const Vec3 middle = middleOf(body.mesh.data().tetrahedra[t], body.mesh.data().current);
        if (dot(plane.normal, middle - plane.origin) < 0.0)
            below += restVolume(body.mesh.data(), t) / body.mesh.startVolume();
    }
    const double less = std::min(below, 1.0 - below);
    Blade blade = bladeBefore(plane, 0.95 * d, 2.0 * d);
    BladeStroke cut(body.mesh.newSheet());
    const bool backAndForth = random.chance(0.5);
    for (double way = 0.0; way < 1.9 * d;) {
        const int forth = backAndForth ? 3 : 1, back = backAndForth ? 2 : 0;
        for (int i = 0; i < forth + back; ++i) blade.go(body, cut, (i < forth ? stroke : -stroke) * plane.ahead);
        way += (forth - back) * stroke;
    }
    body.finish(cut);
    return fresh && less > 0.35 ? std::optional(body.secondPart() < 0.02) : std::nullopt;
}

/// Cuts with two jaws that rotate about one point and close.
std::optional<bool> snip(FuzzBody& body, FuzzRandom& random)
{
    const CutPlane plane = anyPlane(body.mesh, random);
    const double d = body.mesh.diagonal();
    const bool whole = random.chance(0.3);
    const double jaw = whole ? 2.2 * d : random.uniform(0.2, 0.8) * d;
    const Vec3 pivot = plane.origin - (whole ? 1.1 : random.uniform(0.1, 0.4)) * d * plane.ahead;
    const int steps = (whole ? 40 : 5) + random.below(40);
    const double open = whole ? 1.3 : random.uniform(0.2, 0.8);
    const auto tip = [&](int step, double sign) { // the jaws close by 5 % more than fully: they shear past each other
        const double angle = sign * open * (1.0 - 1.05 * step / steps);
        return pivot + jaw * (std::cos(angle) * plane.ahead + std::sin(angle) * plane.along);
    };
    BladeStroke stroke(body.mesh.newSheet());
    for (int i = 0; i < steps; ++i) {
        std::array<BladeSegment, 2> jaws;
        for (int k = 0; k < 2; ++k) {
            const double sign = k == 0 ? 1.0 : -1.0;
            jaws[k] = {pivot, tip(i + 1, sign), pivot, tip(i, sign)};
        }
        body.step(stroke, jaws);
    }
    body.finish(stroke);
    if (!whole || body.waves.amplitude > 0.0) return std::nullopt;
    return body.bridged([&](Vec3 p) { return dot(plane.normal, p - plane.origin); });
}

/// Tears at up to 15 nodes, most of which continue the last tear.
std::optional<bool> tears(FuzzBody& body, FuzzRandom& random)
{
    const Vec3 a = random.direction(), b = random.direction();
    int last = -1;
    for (int left = 1 + random.below(15); left > 0; --left) {
        int node = random.below(body.mesh.nodes());
        if (last >= 0 && random.chance(0.7)) { // continue from the last node
            const std::vector<int>& around = body.mesh.data().around[last];
            const int beside = around[random.below(static_cast<int>(around.size()))];
            node = body.mesh.data().tetrahedra[beside][random.below(body.mesh.isSheet() ? 3 : 4)];
        }
        last = node;
        const Vec3 p = body.mesh.data().rest[node];
        body.tear(node, normalized(a + std::sin(40.0 * p.x) * b + 0.3 * random.direction()));
    }
    return std::nullopt;
}

} // namespace

const char* name(FuzzKind kind)
{
    constexpr const char* kNames[] = {"plane",  "progressive", "curled",        "resumed", "strip",
                                      "sawing", "scissors",    "self-crossing", "tears"};
    return kNames[static_cast<int>(kind)];
}

std::optional<bool> fuzzCut(FuzzBody& body, FuzzKind kind, FuzzRandom& random, bool fresh)
{
    const bool judgedAtRest = kind <= FuzzKind::Resumed;
    const double d = body.mesh.diagonal();
    const bool moving = !judgedAtRest && random.chance(kind == FuzzKind::Sawing ? 0.8 : 0.5);
    Vec3 centre;
    for (Vec3 p : body.mesh.data().rest) centre += p / static_cast<double>(body.mesh.nodes());
    body.waves = {centre,
                  random.direction(),
                  random.direction(),
                  (kTurn / d) * random.direction(),
                  (9.0 / d) * random.direction(),
                  moving ? random.uniform(0.005, 0.04) * d : 0.0,
                  random.uniform(2.0, 12.0)};
    body.begin();
    switch (kind) {
    case FuzzKind::Plane:
        return cutPlane(body, random, false);
    case FuzzKind::Progressive:
        return cutPlane(body, random, true);
    case FuzzKind::Curled:
        return cutArc(body, random, true, false);
    case FuzzKind::Resumed:
        return cutArc(body, random, false, true);
    case FuzzKind::Strip:
        return cutStrip(body, random, random.chance(0.5) ? 1.0 : 0.0);
    case FuzzKind::Sawing:
        return saw(body, random, fresh);
    case FuzzKind::Scissors:
        return snip(body, random);
    case FuzzKind::Crossing:
        return cutStrip(body, random, 10.0);
    default:
        return tears(body, random);
    }
}

} // namespace filasofia::testing
