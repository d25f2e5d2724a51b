// Braids and monofilaments, whose pattern is fixed to the rod.
#include "little_scene.h"
#include "organs.h"
#include "pictures.h"

#include "filasofia/geometry/shapes.h"

namespace thread_test {

using namespace filasofia;
using namespace filasofia::visual;

namespace {

constexpr double kRadius = 10e-3, kPitch = 0.06; // [m]

/// A rod along x.
geometry::TriangleMesh rod(double y)
{
    std::vector<Vec3> line;
    for (int i = -25; i <= 25; ++i) line.push_back({4e-3 * i, y, 0});
    return *geometry::shapes::tube(line, kRadius, 24);
}

/// Where the rod's vertices are in the pattern, with the rod moved along itself and turned about itself.
std::vector<Vec3> patternOf(const geometry::TriangleMesh& rod, double y, double moved, double turned)
{
    std::vector<Vec3> pattern;
    for (const Vec3& vertex : rod.vertices)
        pattern.push_back(rotate(axisAngle({1, 0, 0}, turned), vertex - Vec3{0, y, 0}) + Vec3{moved, 0, 0});
    return pattern;
}

struct Threads {
    Threads() { scene.server.remove(scene.body); }
    VisualBody& add(const ThreadMaterial& material, double y)
    {
        VisualBody& body = scene.server.add(VisualBodyDef{.name = "thread", .mesh = rod(y), .material = material});
        body.setMesh(rod(y), patternOf(rod(y), y, 0.0, 0.0));
        return body;
    }
    LittleScene scene;
};

} // namespace

TEST_CASE("a braid has as many strands to each side as it is told, each of its pitch")
{
    Threads threads;
    const ThreadMaterial braid{.strands = 5, .pitch = kPitch};
    VisualBody& body = threads.add(braid, 0.0);
    const Image whole = threads.scene.server.capture();
    const double turn = 2.0 * M_PI;
    const auto after = [&](double moved, double turned) {
        body.setMesh(rod(0.0), patternOf(rod(0.0), 0.0, moved, turned));
        return difference(whole, threads.scene.server.capture());
    };
    CHECK(after(0.0, turn / 5) <= 20); // facets and fibres differ
    CHECK(after(kPitch / 5, 0.0) <= 20);
    CHECK(after(kPitch / 5, turn / 5) <= 20);  // along a strand, two crossings on
    CHECK(after(kPitch / 10, turn / 10) > 40); // the next crossing has the other one on top
    CHECK(after(0.0, turn / 10) > 40);
    CHECK(after(kPitch / 10, 0.0) > 40);
    CHECK(after(0.0, turn / 20) > 40);
}

TEST_CASE("a relief of 0 leaves the colours of the strands, and a monofilament has none")
{
    Threads threads;
    VisualBody& body = threads.add(ThreadMaterial{.pitch = kPitch}, 0.0);
    const Image braid = threads.scene.server.capture();
    body.setMaterial(ThreadMaterial{.pitch = kPitch, .relief = 0.0});
    const Image flat = threads.scene.server.capture();
    body.setMaterial(ThreadMaterial{.strands = 0, .pitch = kPitch});
    const Image smooth = threads.scene.server.capture();
    CHECK(difference(braid, flat) > 10);
    CHECK(difference(flat, smooth) > 10);
    body.setMaterial(ThreadMaterial{.strands = 0, .pitch = 0.5 * kPitch, .relief = 2.0});
    CHECK(difference(threads.scene.server.capture(), smooth) == 0);
}

TEST_CASE("picture: a braid, a finer one and a monofilament")
{
    Threads threads;
    threads.add(ThreadMaterial{.pitch = kPitch}, 0.03);
    threads.add(ThreadMaterial{.baseColor = {0.55, 0.50, 0.42}, .strands = 12, .pitch = kPitch}, 0.0);
    threads.add(ThreadMaterial{.baseColor = {0.03, 0.10, 0.45}, .roughness = 0.2, .strands = 0}, -0.03);
    checkPicture(threads.scene.server.capture(), "thread");
}

} // namespace thread_test
