#include "apps/filasofia/bench/visual_frame.h"

#include "apps/filasofia/bench/load.h"
#include "filasofia/geometry/shapes.h"
#include "filasofia/mapping/map.h"
#include "filasofia/visual/endoscope_look.h"

#include <time.h>

#include <cmath>
#include <numbers>
#include <numeric>

namespace filasofia::app {
namespace {

constexpr double kRing = 0.04, kTube = 0.015; ///< [m] radii of the surface, a torus

double threadSeconds() { return secondsOf(CLOCK_THREAD_CPUTIME_ID); }
double processSeconds() { return secondsOf(CLOCK_PROCESS_CPUTIME_ID); }

/// A closed surface; each level of subdivision has exactly four times the vertices.
geometry::TriangleMesh torus(int around)
{
    geometry::TriangleMesh mesh;
    const auto angle = [&](int i) { return 2.0 * std::numbers::pi * i / around; };
    const auto vertex = [&](int i, int j) { return (i % around) * around + j % around; };
    for (int i = 0; i < around; ++i)
        for (int j = 0; j < around; ++j) {
            const double out = kRing + kTube * std::cos(angle(j));
            mesh.vertices.push_back({out * std::cos(angle(i)), kTube * std::sin(angle(j)), out * std::sin(angle(i))});
            mesh.triangles.push_back({vertex(i, j), vertex(i, j + 1), vertex(i + 1, j + 1)});
            mesh.triangles.push_back({vertex(i, j), vertex(i + 1, j + 1), vertex(i + 1, j)});
        }
    return mesh;
}

/// The surface and the nodes that carry it.
struct Body {
    mapping::MappedSurface mapped;
    std::vector<Vec3> rest;
    frame::SoftBodyFrame now;

    explicit Body(const FrameScene& scene)
    {
        const int control = scene.vertices >> (2 * scene.level);
        geometry::TriangleMesh surface = torus(static_cast<int>(std::lround(std::sqrt(control))));
        if (scene.map == MapKind::Identity) {
            rest = surface.vertices;
            mapping::IdentityMap map{std::vector<int>(rest.size())};
            std::iota(map.nodes.begin(), map.nodes.end(), 0);
            mapped = {std::move(surface), std::move(map)};
        } else {
            const auto block = geometry::shapes::block({0.12, 0.04, 0.12}, {18, 6, 18});
            rest = block->nodes;
            mapped = mapping::mapSurface(*block, std::move(surface));
        }
        now.positions = rest;
    }
    /// Sends a wave through the nodes, so that every vertex moves in every frame.
    void move(int frame)
    {
        for (std::size_t i = 0; i < rest.size(); ++i)
            now.positions[i] = rest[i] + Vec3{0, 0.004 * std::sin(60.0 * rest[i].x + 0.3 * frame), 0};
    }
};

/// The surface in a picture.
struct Picture {
    visual::VisualServer server;
    visual::VisualBody& body;

    Picture(const FrameScene& scene, const geometry::TriangleMesh& surface, const PictureScene& drawn = {})
        : server({.backend = scene.backend, .width = drawn.width, .height = drawn.height}),
          body(server.add(visual::VisualBodyDef{.name = "torus", .mesh = surface, .subdivision = scene.level}))
    {
        visual::View& view =
            *visual::addEndoscopeLook(server, visual::boundsOf(surface), drawn.quality, {0.2, 1.0, 0.6}).view;
        if (drawn.optics) {
            visual::ViewDef seen = view.def();
            seen.effects = visual::effectsOf(drawn.quality, seen.occlusionRadius);
            seen.effects->endoscope.emplace();
            view.set(seen);
        }
        server.timeStages(threadSeconds);
    }
};

visual::VisualStages difference(const visual::VisualStages& a, const visual::VisualStages& b)
{
    return {a.subdivision - b.subdivision, a.normals - b.normals, a.upload - b.upload, a.submit - b.submit};
}

} // namespace

std::vector<FrameTimes> timeFrames(const FrameScene& scene, int frames)
{
    Body body(scene);
    Picture picture(scene, body.mapped.surface);
    std::vector<Vec3> vertices(body.mapped.surface.vertices.size());
    std::vector<FrameTimes> times;
    const int warm = 5; // the first frames compile shaders and allocate memory
    for (int i = -warm; i < frames; ++i) {
        body.move(i);
        const visual::VisualStages before = picture.server.statistics().stages;
        const double whole = processSeconds(), start = threadSeconds();
        mapping::apply(body.mapped.map, body.now, vertices);
        const double mapped = threadSeconds();
        picture.body.setVertices(vertices);
        picture.server.render();
        if (i < 0) continue;
        times.push_back({.mapping = mapped - start,
                         .stages = difference(picture.server.statistics().stages, before),
                         .whole = processSeconds() - whole});
    }
    return times;
}

PictureTimes timePictures(const PictureScene& scene, int frames)
{
    const FrameScene surface{50176, 1, MapKind::Barycentric, visual::Backend::Headless};
    Body body(surface);
    Picture picture(surface, body.mapped.surface, scene);
    std::vector<Vec3> vertices(body.mapped.surface.vertices.size());
    int next = 0;
    const auto timed = [&](auto&& take) {
        const double start = secondsOf(CLOCK_MONOTONIC);
        body.move(next++);
        mapping::apply(body.mapped.map, body.now, vertices);
        picture.body.setVertices(vertices);
        take();
        return secondsOf(CLOCK_MONOTONIC) - start;
    };
    const auto capture = [&] { picture.server.capture(); };
    const auto depth = [&] { picture.server.captureDepth(); };
    PictureTimes times;
    for (int i = 0; i < 5; ++i) timed(capture), timed(depth); // shaders are compiled, memory is allocated
    for (int i = 0; i < frames; ++i) times.captures.push_back(timed(capture));
    for (int i = 0; i < frames; ++i) times.depths.push_back(timed(depth));
    for (int i = 0; i < frames; ++i) times.drawn += timed([&] { picture.server.render(); }) / frames;
    times.drawn += timed(capture) / frames; // the card may still be drawing; a capture waits for it
    return times;
}

std::vector<TopologyTimes> timeTopology(const FrameScene& scene, int repeats)
{
    const Body body(scene);
    const geometry::TriangleMesh& surface = body.mapped.surface;
    Picture picture(scene, surface);
    std::vector<TopologyTimes> times;
    for (int i = 0; i < repeats; ++i) {
        const double start = threadSeconds();
        visual::PreparedMesh prepared(surface, scene.level, "torus");
        const double ready = threadSeconds();
        picture.body.adopt(std::move(prepared), surface.vertices);
        times.push_back({.prepare = ready - start, .adopt = threadSeconds() - ready});
        picture.server.render();
    }
    return times;
}

} // namespace filasofia::app
