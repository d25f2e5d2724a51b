#pragma once

#include "filasofia/visual/endoscope_look.h"

#include <cmath>
#include <numbers>

namespace filasofia::visual {

/// An octahedron split `level` times and projected onto a sphere: closed, oriented, 8 * 4^level triangles.
inline geometry::TriangleMesh sphere(double radius, int level)
{
    geometry::TriangleMesh mesh;
    mesh.vertices = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
    mesh.triangles = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
    const auto middle = [&](int a, int b) {
        const Vec3 m = normalized(mesh.vertices[std::size_t(a)] + mesh.vertices[std::size_t(b)]);
        for (std::size_t i = 0; i < mesh.vertices.size(); ++i)
            if (distance(mesh.vertices[i], m) < 1e-9) return static_cast<int>(i);
        mesh.vertices.push_back(m);
        return static_cast<int>(mesh.vertices.size()) - 1;
    };
    for (int i = 0; i < level; ++i) {
        std::vector<geometry::Triangle> finer;
        for (auto [a, b, c] : std::vector(mesh.triangles)) {
            const int ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
            for (geometry::Triangle t : {geometry::Triangle{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}})
                finer.push_back(t);
        }
        mesh.triangles = finer;
    }
    for (Vec3& v : mesh.vertices) v *= radius;
    return mesh;
}

inline VisualBodyDef sphereDef(double radius = 0.05, int level = 2)
{
    VisualBodyDef def;
    def.name = "ball";
    def.mesh = sphere(radius, level);
    return def;
}

/// A small picture of a sphere under the endoscope's light, cheap enough for a software renderer.
struct LittleScene {
    explicit LittleScene(Backend backend = Backend::Headless, Quality quality = Quality::Low)
        : server({.backend = backend, .width = 320, .height = 240}), body(server.add(sphereDef())),
          look(addEndoscopeLook(server, boundsOf(sphereDef().mesh), quality))
    {
    }

    VisualServer server;
    VisualBody& body;
    EndoscopeLook look;
};

/// Puts the camera at (0, 0, 0.3), looking along -Z, under a wide light, for tests that know where things are in the
/// picture.
inline void lookFromFront(LittleScene& scene)
{
    scene.look.rig->setPose(lookAt({0, 0, 0.3}, {0, 0, 0}));
    CameraDef camera = scene.look.camera->def();
    camera.verticalFieldOfView = std::numbers::pi / 3;
    scene.look.camera->set(camera);
    LightDef light = scene.look.light->def();
    light.kind = SpotLight{.intensity = 300, .innerAngle = 0.3, .outerAngle = 0.8};
    scene.look.light->set(light);
}

/// Mean of the three colours over the pixels, in 255ths.
inline double brightness(const Image& image)
{
    double sum = 0.0;
    for (std::size_t i = 0; i < image.rgba.size(); i += 4) sum += image.rgba[i] + image.rgba[i + 1] + image.rgba[i + 2];
    return sum / (3.0 * image.width * image.height);
}

inline int brightnessAt(const Image& image, int x, int y)
{
    const auto p = image.pixel(x, y);
    return (p[0] + p[1] + p[2]) / 3;
}

/// The largest difference of any byte, in 255ths.
inline int difference(const Image& a, const Image& b)
{
    int largest = a.rgba.size() == b.rgba.size() ? 0 : 255;
    for (std::size_t i = 0; i < a.rgba.size() && largest < 255; ++i)
        largest = std::max(largest, std::abs(int(a.rgba[i]) - int(b.rgba[i])));
    return largest;
}

} // namespace filasofia::visual
