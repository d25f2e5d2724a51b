#include "apps/laparoscopy/gallbladder.h"

#include <filasofia/core/random.h>

#include <utility>

using namespace filasofia;

namespace operation {
namespace {

/// The bodies in the order of the scene file.
enum Body { Omentum, Wall, Ligament, Assistant, Liver, Gallbladder, Duct, Artery, Layer };
constexpr int kDuctAround = 8, kDuctAlong = 24, kArteryAround = 6, kArteryAlong = 22; // as their meshes were made
enum Group { OnTool = 1, InBag = 40 };
constexpr double kLevel = 90_deg; // the roll at which the bag hangs down
constexpr Vec3 kLeftPort = {-120_mm, -70_mm, 150_mm}, kRightPort = {115_mm, 70_mm, 150_mm};

/// The same organ, moved in the patient.
void place(const Pose& pose, scene::SceneBody& body)
{
    if (auto* soft = std::get_if<SoftBodyDef>(&body.def)) soft->pose = pose;
    for (DuctDef& each : body.ducts)
        for (Vec3& point : each.path) point = transform(pose, point);
}

TissueMaterial black()
{
    const Color color = {0.03, 0.03, 0.03};
    return {.baseColor = color, .subsurfaceColor = color, .mottling = 0.0, .vessels = 0.0, .bump = 0.0};
}

LaparoscopicInstrumentDef inTrocar(const char* name, Vec3 port, const ArticulatedInstrumentDef& tool)
{
    const Vec3 work = {10_mm, -5_mm, 5_mm};
    LaparoscopicInstrumentDef def{.name = name, .tool = tool};
    def.tool.shaftMaterial = black();
    def.tool.shaftCollision = shapes::box({1_mm, 1_mm, 1_mm}); // shafts wait in the same cannula
    def.trocar = {
        .fulcrum = port, .axis = work - port, .mostTilt = 0.8, .leastInsertion = 20_mm, .mostInsertion = 270_mm};
    def.hand = {.length = 0.42, .strength = 12.0};
    def.start = {.insertion = length(work - port) - 90_mm};
    return def;
}

LaparoscopicInstrumentDef grasper()
{
    ArticulatedInstrumentDef tool{.kind = InstrumentKind::LaparoscopicGrasper, .groups = {OnTool}, .opening = 0.55};
    tool.proximity = 0.3_mm;
    tool.gripStiffness = 200.0;
    return inTrocar("left grasper", kLeftPort, tool);
}

LaparoscopicInstrumentDef hook() { return inTrocar("hook", kRightPort, {.kind = InstrumentKind::Hook}); }
LaparoscopicInstrumentDef tube() { return inTrocar("tube", kRightPort, {.kind = InstrumentKind::SuctionIrrigator}); }

/// It waits, open, where nobody looks.
LaparoscopicInstrumentDef holder()
{
    LaparoscopicInstrumentDef def =
        inTrocar("bag", kRightPort, {.kind = InstrumentKind::SpecimenBag, .groups = {}, .opening = 1.0});
    def.start = {.insertion = def.trocar.leastInsertion, .roll = kLevel};
    return def;
}

LaparoscopeDef camera()
{
    const Vec3 at = {18_mm, -40_mm, 104_mm}, view = normalized(Vec3{5_mm, 3_mm, 4_mm} - at);
    LaparoscopeDef def{.inclination = 0.0, .fieldOfView = 52_deg, .intensity = 75.0};
    def.surroundings = {
        .intensity = 1500.0, .above = {0.62, 0.40, 0.34}, .below = {0.5, 0.26, 0.2}, .background = {0.05, 0.012, 0.01}};
    def.trocar = {.fulcrum = at - 50_mm * view, .axis = view};
    def.start = {.insertion = 50_mm};
    return def;
}

} // namespace

Vec3 PatientTube::at(const FrameRef& frame, double part) const
{
    const auto& x = frame->softBody(body)->positions;
    const double place = std::clamp(part, 0.0, 1.0) * along;
    const int ring = std::min(static_cast<int>(place), along - 1);
    Vec3 sum;
    for (int i = 0; i < 2 * around; ++i) {
        const auto node = static_cast<std::size_t>(2 * around * ring + i);
        const Vec3 here = x[node], next = x[node + static_cast<std::size_t>(2 * around)];
        sum += 1.0 / (2 * around) * (here + (place - ring) * (next - here));
    }
    return sum;
}
Vec3 PatientTube::along_(const FrameRef& frame, double part) const
{
    return normalized(at(frame, part + 0.04) - at(frame, part - 0.04));
}

GallbladderPatient addGallbladder(Simulation& sim, std::uint64_t seed)
{
    scene::SceneDef scene = scene::loadScene(asset("scenes/gallbladder.json"));
    Random random(seed);
    const Pose patient{{random.between(-2.5_mm, 2.5_mm), random.between(-2.5_mm, 2.5_mm), 0},
                       axisAngle({0, 0, 1}, random.between(-4_deg, 4_deg))};
    const double firmness = random.between(0.8, 1.25); // how the layer between liver and gall bladder holds
    for (scene::SceneBody& each : scene.bodies) place(patient, each);
    auto& gallbladder = std::get<SoftBodyDef>(scene.bodies[Gallbladder].def);
    gallbladder.collision.push_back({.proximity = 0.3_mm, .group = InBag});
    GallbladderPatient out;
    for (std::size_t i = 0; i < out.bed.size(); ++i) {
        out.bed[i] = gallbladder.attachments[i].nodes;
        gallbladder.attachments[i].pointBreakForce *= firmness;
    }
    const scene::AddedScene added = scene::addScene(sim, scene);
    out.assistant = added.bodies[Assistant];
    out.liver = added.bodies[Liver];
    out.gallbladder = added.bodies[Gallbladder];
    out.layer = added.bodies[Layer];
    out.duct = {added.bodies[Duct], kDuctAround, kDuctAlong};
    out.artery = {added.bodies[Artery], kArteryAround, kArteryAlong};
    return out;
}

GallbladderTools::GallbladderTools(Simulation& sim, const GallbladderPatient& patient)
    : left(sim, grasper()), scope(sim, camera()),
      right{std::make_unique<LaparoscopicInstrument>(sim, hook()),
            std::make_unique<LaparoscopicInstrument>(
                sim, inTrocar("clip applier", kRightPort,
                              {.kind = InstrumentKind::ClipApplier, .groups = {}, .opening = 1.0})),
            std::make_unique<LaparoscopicInstrument>(
                sim, inTrocar("scissors", kRightPort, {.kind = InstrumentKind::LaparoscopicScissors, .opening = 0.6})),
            std::make_unique<LaparoscopicInstrument>(sim, holder()),
            std::make_unique<LaparoscopicInstrument>(sim, tube())},
      clips(sim, right[Applier]->tool(),
            {.clip = {.gap = 0.5_mm},
             .clips = 8,
             .targets = {patient.duct.body, patient.artery.body},
             .onClip = [this](BodyId tissue) { return onClip ? onClip(tissue) : void(); }}),
      bag(sim, right[Bag]->tool(), {.cells = 6, .groups = {InBag}}), suction(sim, right[Tube]->tool()),
      hands(sim, left, *right[Hook], scope), sim_(sim)
{
    const ElectrodeTip tip{.from = {0, 0, -10_mm}, .to = {0, 0, -15_mm}};
    sim.addElectrode(right[Hook]->body(), {.mode = EnergyMode::Cut, .power = 30.0, .radius = 1.5_mm, .tip = tip});
    sim.everyStep([this](double) { step(); });
}

/// After the hands have moved the hook: the chosen tool goes where they want the right one, and closes as they say.
void GallbladderTools::step()
{
    const InHand now = chosen_;
    const TrocarPose wanted = hands.wanted().right;
    for (const InHand each : {Hook, Applier, Scissors, Bag, Tube}) {
        TrocarPose pose = wanted;
        if (each == Bag) pose.roll += kLevel;
        if (each != now) pose.insertion = right[each]->def().trocar.leastInsertion;
        if (each != now && each == Bag) pose = right[Bag]->def().start; // it would swing
        right[each]->move(pose);
    }
    const bool closed = right[Hook]->tool().opening() < 0.5;
    if (std::exchange(held_, now) == now && was_[0] == closed) return;
    was_[0] = closed;
    const bool pressed = now == Hook && closed;
    if (std::exchange(was_[1], pressed) != pressed) sim_.activate(right[Hook]->body(), pressed);
    if (now == Hook) return;
    if (closed)
        right[now]->tool().close();
    else
        right[now]->tool().open(now == Scissors ? 0.6 : 1.0);
}

} // namespace operation
