#include <filasofia/filasofia.h>
#include <filasofia/scene/scene_file.h>

using namespace filasofia;

int main(int argc, char** argv)
try {
    const scene::SceneDef anatomy = scene::loadScene(asset("scenes/gallbladder.json"));
    const auto is = [](const scene::SceneBody& each) {
        return std::get_if<SoftBodyDef>(&each.def) && !each.ducts.empty();
    };
    const auto tube = std::ranges::find_if(anatomy.bodies, is); // the first with a duct is the cystic duct
    Simulation sim(
        {.window = {"Cholecystectomy", 640, 480},
         .look = {.around = Box{{-35_mm, -32_mm, -10_mm}, {50_mm, 30_mm, 25_mm}}, .direction = {0.15, -0.4, 1}}});
    const BodyId duct = scene::addScene(sim, anatomy).bodies[static_cast<std::size_t>(tube - anatomy.bodies.begin())];
    const std::vector<Vec3> path = tube->ducts.front().path;
    const Vec3 port = {115_mm, 70_mm, 150_mm};
    // A pose that brings a point of the tool, `reach` in front of its pivot, to a part of the duct, across which it
    // opens.
    const auto on = [&](double part, double reach) {
        const auto i = static_cast<std::size_t>(part * static_cast<double>(path.size() - 1));
        const Vec3 to = normalized(port - path[i]), along = normalized(path[i + 1] - path[i]);
        return lookAt(path[i] + reach * to, path[i], cross(to, along));
    };
    ArticulatedInstrument applier(
        sim,
        {.name = "applier", .kind = InstrumentKind::ClipApplier, .pose = on(0.8, 70_mm), .groups = {}, .opening = 1.0});
    const ClipApplier clips(sim, applier, {.clip = {.gap = 0.7_mm}, .clips = 3, .targets = {duct}});
    ArticulatedInstrument scissors(
        sim,
        {.name = "scissors", .kind = InstrumentKind::LaparoscopicScissors, .pose = on(0.5, 90_mm), .opening = 0.6});

    sim.everyStep([&](double time) { // two clips and one, a second each; then the scissors between them
        constexpr double kParts[] = {0.8, 0.7, 0.4};
        const double second = std::floor(time), part = time - second;
        const double back = 15_mm * std::clamp(std::max(1.0 - part / 0.3, (part - 0.75) / 0.25), 0.0, 1.0);
        if (time < 3.0) {
            applier.move(on(kParts[static_cast<int>(second)], 9_mm + back));
            part > 0.3 && part < 0.75 ? applier.close() : applier.open();
        } else {
            applier.move(on(0.8, 9_mm + 60_mm * std::min(1.0, time - 3.0)));
            scissors.move(on(0.55, 12_mm + 60_mm * std::clamp(std::max(3.6 - time, (time - 4.5) / 0.6), 0.0, 1.0)));
            time > 3.7 && time < 4.4 ? scissors.close() : scissors.open(0.6);
        }
    });
    if (const int problem = sim.run(argc, argv)) return problem; // --headless --steps 5000: see --help
    const auto frame = sim.physics().latest();
    if (!frame) return 0; // --help
    const DuctBalance now = sim.duct(duct);
    for (const auto& clip : frame->clips) std::printf("a clip presses with %.2f N\n", clip.force);
    std::printf("%d clips and %d, leak %.3f ml/s\n", now.clipsBefore, now.clipsAfter, now.leak * 1e6);
    return frame->time < 4.9 || (now.state == DuctState::Cut && clips.applied() == 3) ? 0 : 1;
} catch (const Error& error) {
    return report(error);
}
