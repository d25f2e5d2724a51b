#include <filasofia/filasofia.h>

using namespace filasofia;

// The motion: the driver holds the needle at an angle of the circle about which it turns, its shaft along the axis.
constexpr double kRadius = 9_mm;
const Vec3 kMiddle{0, 5_mm, 0};
Pose holding(double angle, Vec3 moved)
{
    const Vec3 out{std::cos(angle), std::sin(angle), 0};
    return {kMiddle + kRadius * out + Vec3{0, 0, 9_mm} + moved, axisAngle({0, 0, 1}, angle + 90_deg)};
}
Pose motion(double time)
{
    const auto part = [&](double from, double to) { return std::clamp((time - from) / (to - from), 0.0, 1.0); };
    const double angle = 20_deg + part(0.3, 2.3) * 175_deg + part(3.0, 3.6) * 160_deg + part(4.4, 6.4) * 150_deg;
    const Vec3 aside{0, 0, 25_mm * (part(2.6, 3.0) - part(3.6, 4.0))}; // open, from the needle's tail to its tip
    const Vec3 drawn = part(6.4, 7.0) * Vec3{0, 16_mm, 0} + part(7.0, 8.0) * Vec3{45_mm, 0, 0} +
                       part(9.05, 9.6) * Vec3{60_mm, 80_mm, 0};
    return holding(angle, aside + drawn);
}

// The scissors come from the right, the blades on both sides of the strands, and go again.
Pose cutting(double since)
{
    const double near = std::clamp(since / 0.8 - 0.1, 0.0, 1.0) - std::clamp((since - 1.2) / 0.5, 0.0, 1.0);
    return {{9_mm + 60_mm * (1.0 - near), 9_mm, 0}, axisAngle({0, 1, 0}, 90_deg) * axisAngle({0, 0, 1}, 90_deg)};
}

/// Draws the outer faces of the edges apart, with 1 N each.
void load(Simulation& sim, const BodyId (&edges)[2])
{
    const auto frame = sim.physics().latest();
    for (const int side : {-1, 1}) {
        std::vector<NodalForce> forces;
        const auto& nodes = frame->softBody(edges[side > 0])->positions;
        for (int i = 0; i < std::ssize(nodes); ++i)
            if (side * nodes[static_cast<std::size_t>(i)].x > 20.5_mm) forces.push_back({i, {}});
        for (NodalForce& each : forces) each.force.x = side * 1.0 / static_cast<double>(forces.size());
        sim.physics().setForces(edges[side > 0], forces);
    }
}

int main(int argc, char** argv)
try {
    Simulation sim(
        {.window = {"Suture", 960, 720},
         .look = {.around = Box{{-11_mm, -7_mm, -8_mm}, {11_mm, 8_mm, 8_mm}}, .direction = {0.35, 0.8, 0.75}}});
    BodyId edges[2];
    for (const int side : {-1, 1}) {
        SoftBodyDef skin{.name = side < 0 ? "left edge" : "right edge",
                         .mesh = shapes::block({20_mm, 8_mm, 16_mm}, {10, 5, 8})};
        skin.pose.position = {side * 11_mm, -4_mm, 0};
        skin.material = FemMaterial{.youngModulus = 50_kPa, .poissonRatio = 0.45};
        skin.attachments = {{.box = Box{{-1, -1, -1}, {1, -7.9_mm, 1}}}}; // its lower side is held
        skin.collision = {{.proximity = 0.3_mm}};
        skin.puncture = PunctureDef{.force = 0.25, .cutting = 0.08, .friction = 6.0};
        sim.show(edges[side > 0] = sim.add(skin), {.subdivision = 1});
    }
    const auto line = shapes::arc(kRadius, 0, -200_deg, 20); // from the tip to the tail
    RigidBodyDef needle{.name = "needle", .elements = {{kMiddle, axisAngle({0, 0, 1}, 205_deg)}}, .dynamic = true};
    needle.mesh = shapes::tube(line, 0.4_mm, 8, true);
    needle.mass = Density{7800};
    needle.gravity = false;
    needle.collision = {{.proximity = 0.2_mm}};
    needle.needle = NeedleDef{.line = line, .radius = 0.4_mm};
    const BodyId steel = sim.add(needle);
    const Vec3 end{-20_mm, 12_mm, -6_mm};
    const BodyId hand = sim.add(RigidBodyDef{.name = "hand", .elements = {{end}}});
    RodBodyDef thread{.name = "thread", .spacing = 0.4_mm, .radius = 0.15_mm, .youngModulus = 50_MPa};
    thread.points = {transform(needle.elements[0], line.back()),
                     {14_mm, 7_mm, -7_mm},
                     {12_mm, 28_mm, -24_mm},
                     {-16_mm, 32_mm, -24_mm},
                     end};
    thread.straight = thread.gravity = false;
    thread.yieldStrain = 0.1;    // it keeps sharp bends
    thread.rayleigh.mass = 20.0; // the air
    thread.collision = RodCollision{};
    thread.dynamicTopology = true; // it may be cut
    thread.attachments = {{.nodes = {0}, .to = steel}, {.ball = Ball{end, 0.5_mm}, .to = hand}};
    const BodyId silk = sim.add(thread);
    prefab::ArticulatedInstrument driver(sim,
                                         {.kind = InstrumentKind::NeedleDriver, .pose = motion(0), .opening = 0.08});
    prefab::ArticulatedInstrument scissors(
        sim, {.kind = InstrumentKind::SutureScissors, .pose = cutting(0), .opening = 0.3});
    KnotHands knot(sim, {.thread = silk, .place = {0, 0.5_mm, 0}, .force = 0.6, .holding = 0.15, .speed = 0.15});
    sim.show(steel, {.material = MetalMaterial{}});
    sim.show(silk, {.material = ThreadMaterial{.baseColor = {0.1, 0.1, 0.5}, .pitch = 0.75_mm}});
    double tied = physics::kNever, last = 0.0; // [s] when the knot was tied; the last step
    sim.everyStep([&](double time) {
        driver.move(motion(time));
        const bool open = time > 2.3 && time < 4.0;
        if (open && driver.holding()) driver.open(0.2);
        if (!open && !driver.holding()) driver.close();
        const auto reached = [&](double at) { return last < at && time >= at; };
        if (reached(9.0)) knot.begin();
        if (reached(9.01)) // the knot's hands have the thread: the needle and the first hand let go
            for (const AttachmentId each : sim.physics().attachments(silk)) sim.physics().release(each);
        if (knot.done()) tied = std::min(tied, time);
        scissors.move(cutting(time - tied));
        if (reached(tied + 1.0)) scissors.close();
        if (reached(tied + 1.5)) knot.release();
        if (reached(tied + 1.6)) load(sim, edges);
        last = time;
    });

    if (const int problem = sim.run(argc, argv)) return problem; // --headless --steps 18000: see --help
    const auto frame = sim.physics().latest();
    if (!frame || frame->time < 17.9) return 0;
    double gap = 1.0; // between the edges
    for (const Vec3& left : frame->softBody(edges[0])->positions)
        for (const Vec3& right : frame->softBody(edges[1])->positions) gap = std::min(gap, distance(left, right));
    std::printf("%d throws; under load the edges of the wound are %.2f mm apart\n", knot.tied(), 1e3 * gap);
    const bool cut = frame->softBody(silk)->cutEdges.size() >= 2;
    return knot.tied() == 3 && cut && gap < 0.5_mm ? 0 : 1;
} catch (const Error& error) {
    return report(error);
}
