// A scene file of SOFA as the physics of a simulator, with our pictures: jelly falls on a tilted plate.
#include <filasofia/filasofia.h>
#include <filasofia/sofa/load.h>

using namespace filasofia;

int main(int argc, char** argv)
try {
    Simulation sim({.physics = {.rate = 200}, .window = {.title = "A scene of SOFA"}}); // its dt is 5 ms
    const sofaengine::LoadedScene scene = sofaengine::load(sim.physics(), {.file = asset("scenes/jelly.scn")});
    for (const sofaengine::LoadedBody& body : scene.bodies) {
        std::printf("%s %s\n", body.picture ? "shown:    " : "simulated:", body.name.c_str());
        if (body.picture) sim.show(body.id);
    }
    if (const int problem = sim.run(argc, argv)) return problem;
    const auto frame = sim.physics().latest();
    if (!frame) return 0; // --help
    const auto lowest = std::ranges::min(frame->softBody(scene.body("JellyPicture"))->positions, {}, &Vec3::y);
    std::printf("after %.3f s the lowest point is at %.1f mm\n", frame->time, lowest.y * 1e3);
    return frame->time < 0.5 || std::abs(lowest.y) < 12e-3 ? 0 : 1; // it lies on the plate
} catch (const Error& error) {
    return report(error);
}
