#include "filasofia/runtime/surface_layers.h"

#include "filasofia/core/log.h"
#include "filasofia/core/validate.h"
#include "filasofia/runtime/layer_effects.h"
#include "filasofia/runtime/surfaces.h"
#include "filasofia/runtime/told_and_kept.h"

#include <algorithm>
#include <cmath>

namespace filasofia::runtime {
namespace {

/// What differs between the layers.
template <class Layer> struct Kind;
template <> struct Kind<surface::Bleeding> {
    static constexpr const char *kDoing = "bleeding", *kDoes = "bleeds", *kOf = "blood", *kDo = "bleed";
    static double told(const surface::BloodBalance& balance) { return balance.welled; }
    static std::vector<float> film(const surface::Bleeding& layer) { return layer.thickness(); }
    static auto& reports(RunReport& report) { return report.blood; }
    static auto make(const surface::BleedingDef& def, const physics::SoftBodyDef& body, const std::string& object)
    {
        return std::make_shared<const surface::Bleeding>(def, skinOf(body, object), object);
    }
    static BloodReport report(const std::string& name, const surface::Bleeding& layer)
    {
        return {name, layer.balance()};
    }
};
template <> struct Kind<surface::Burning> {
    static constexpr const char *kDoing = "burning", *kDoes = "burns", *kOf = "heat", *kDo = "burn";
    static double told(const surface::HeatBalance& balance) { return balance.burnt; }
    static std::vector<float> film(const surface::Burning& layer) { return layer.levels(); }
    static auto& reports(RunReport& report) { return report.heat; }
    static auto make(const surface::BurningDef& def, const physics::SoftBodyDef& body, const std::string& object)
    {
        std::shared_ptr<const geometry::TetMesh> inside;
        if (def.tissue) {
            if (!std::holds_alternative<physics::FemMaterial>(body.material))
                fail(object, ": tissue needs a body with a FemMaterial");
            inside = std::make_shared<const geometry::TetMesh>(physics::worldMesh(body));
        }
        return std::make_shared<const surface::Burning>(def, skinOf(body, object), object, std::move(inside));
    }
    static HeatReport report(const std::string& name, const surface::Burning& layer)
    {
        return {name, layer.def().target, layer.balance()};
    }
};

} // namespace

template <class Layer> void SurfaceLayers<Layer>::Turn::run()
{
    if (boundary) layer.follow(*boundary);
    if constexpr (requires { layer.close({}); })
        if (closed) layer.close(*closed);
    if (layer.nodesNeeded() <= std::ssize(positions)) {
        for (const Command& each : commands) layer.apply(each, positions);
        if constexpr (requires { layer.touch({}); }) layer.touch(std::move(tips));
        layer.step(positions, gravity, dt);
    }
    film = std::make_shared<const std::vector<float>>(Kind<Layer>::film(layer));
    if constexpr (requires { layer.burnt(); }) {
        burnt = std::make_shared<const std::vector<std::uint8_t>>(layer.burnt());
        damage = std::make_shared<const std::vector<float>>(layer.damage());
    }
}

template <class Layer>
void SurfaceLayers<Layer>::add(BodyId id, const Def& def, Vec3 gravity, const physics::PhysicsServer& physics)
{
    const auto body = physics.def(id);
    const std::string object = text(Kind<Layer>::kDoing, " of ", physics::describeBody(*body));
    const auto* soft = std::get_if<physics::SoftBodyDef>(&*body);
    if (soft == nullptr) fail(object, ": needs a soft body with a surface");
    validate(def, object);
    std::shared_ptr<const Layer> start = Kind<Layer>::make(def, *soft, object);
    if constexpr (requires { def.tissue; })
        if (def.tissue) checkTissue(id, *body, physics.engine(), object);
    const std::lock_guard lock(mutex_);
    if (patients_.contains(id)) fail(object, ": it ", Kind<Layer>::kDoes, " already");
    patients_[id] = {
        .name = soft->name, .gravity = gravity, .start = start, .turn = std::make_shared<Turn>(Turn{.layer = *start})};
    any_ = true;
}

template <class Layer> auto SurfaceLayers<Layer>::patient(BodyId id) const -> const Patient&
{
    const auto found = patients_.find(id);
    if (found == patients_.end())
        fail(Kind<Layer>::kOf, ": body ", id.value, " does not ", Kind<Layer>::kDo, "; ", Kind<Layer>::kDo,
             "() makes it");
    return found->second;
}

template <class Layer>
void SurfaceLayers<Layer>::check(BodyId id, const Command& command, const physics::PhysicsServer& physics) const
{
    const std::lock_guard lock(mutex_);
    const std::string object = text(Kind<Layer>::kOf, " of '", patient(id).name, "'");
    if constexpr (requires { std::visit([](const auto&) {}, command); })
        std::visit(
            [&](const auto& each) {
                validate(each, object);
                if constexpr (requires { each.body; }) checkCarrier(each.body, each.element, physics, object);
            },
            command);
    else
        validate(command, object);
}

template <class Layer>
void SurfaceLayers<Layer>::treat(BodyId id, const Command& command, const physics::PhysicsServer& physics)
{
    check(id, command, physics);
    const std::lock_guard lock(mutex_);
    patients_.at(id).waiting.push_back(command);
}

template <class Layer> auto SurfaceLayers<Layer>::balance(BodyId id) const -> Balance
{
    const std::lock_guard lock(mutex_);
    return patient(id).balance;
}

template <class Layer> double SurfaceLayers<Layer>::told() const
{
    if (!any_) return 0.0;
    const std::lock_guard lock(mutex_);
    double sum = 0.0;
    for (const auto& [id, each] : patients_) sum += Kind<Layer>::told(each.balance);
    return sum;
}

template <class Layer> bool SurfaceLayers<Layer>::has(BodyId id) const
{
    const std::lock_guard lock(mutex_);
    return patients_.contains(id);
}

template <class Layer> NodeFilm SurfaceLayers<Layer>::damage(BodyId id) const
{
    const std::lock_guard lock(mutex_);
    return patient(id).damage;
}

template <class Layer> void SurfaceLayers<Layer>::restart()
{
    const std::lock_guard lock(mutex_);
    for (auto& [id, each] : patients_) {
        each.restart = true;
        each.waiting.clear();
        each.taken.clear();
        each.tissue.clear();
    }
}

template <class Layer> void SurfaceLayers<Layer>::finish(Patient& patient)
{
    if (!patient.job) return;
    patient.job->finish();
    patient.job = nullptr;
}

template <class Layer> void SurfaceLayers<Layer>::warnOfMisses(const frame::SoftBodyFrame& body, Patient& patient)
{
    if constexpr (std::is_same_v<Layer, surface::Bleeding>)
        for (const Command& command : patient.waiting) {
            const auto* injure = std::get_if<surface::Injure>(&command);
            if (!injure || patient.missed || reaches(*injure, patient.turn->layer, body)) continue;
            patient.missed = true;
            logWarning("blood of '", patient.name, "': Injure reaches nothing: no node of its surface is within ",
                       injure->radius, " m of (", injure->place.x, ", ", injure->place.y, ", ", injure->place.z,
                       ") m; later ones are not told");
        }
}

template <class Layer> void SurfaceLayers<Layer>::begin(Patient& patient, const frame::Frame& frame,
                                                        const frame::SoftBodyFrame& body, double time)
{
    Turn& turn = *patient.turn;
    if (std::exchange(patient.restart, false)) {
        turn.layer = *patient.start;
        patient.told.reset(); // the next event says from where it counts again
        patient.tellFrom = 0.0;
        patient.closed = nullptr;
        patient.carried = {};
    }
    warnOfMisses(body, patient);
    turn.commands = std::exchange(patient.waiting, {});
    if constexpr (std::is_same_v<Layer, surface::Bleeding>) patient.carried.follow(frame, turn.commands);
    turn.positions = body.positions;
    turn.boundary = body.boundary;
    turn.gravity = patient.gravity;
    turn.closed = patient.closed;
    turn.tips = std::exchange(patient.tips, {});
    turn.dt = patient.last < 0.0 ? 0.0 : time - patient.last;
    patient.last = time;
    patient.job = std::make_shared<BackgroundJob>([turn = patient.turn] { turn->run(); });
    thread_.submit(patient.job);
}

template <class Layer> bool SurfaceLayers<Layer>::tell(BodyId id, double time, Patient& patient, const Post& post)
{
    if (patient.restart) patient.tellFrom = 0.0; // what was before a reset is told before it is gone
    const double now = Kind<Layer>::told(patient.balance);
    if (patient.told == now || time < patient.tellFrom) return true;
    patient.told = now;
    patient.tellFrom = nextTelling(time);
    return post(id, patient.start->def(), patient.balance);
}

template <class Layer>
bool SurfaceLayers<Layer>::takeResults(BodyId id, double time, Patient& patient, const Post& post)
{
    finish(patient);
    if (!patient.turn->film) return true; // it had no turn yet
    patient.balance = patient.turn->layer.balance();
    patient.film = patient.turn->film;
    patient.fresh = true;
    if constexpr (requires { patient.turn->layer.taken(); })
        patient.taken = patient.restart ? std::map<int, double>() : patient.turn->layer.taken();
    if constexpr (requires { patient.turn->layer.takeFumes(); }) {
        patient.fumes = patient.turn->layer.takeFumes();
        if (patient.restart) patient.fumes.clear();
    }
    if constexpr (requires { patient.turn->layer.takeParts(); }) {
        patient.tissue.clear();
        for (surface::HeatedPart& each : patient.turn->layer.takeParts())
            if (!patient.restart) patient.tissue.push_back(changeOf(id, *patient.start->def().tissue, std::move(each)));
    }
    patient.burnt = patient.restart ? nullptr : patient.turn->burnt; // a reset heals
    patient.damage = patient.restart ? nullptr : patient.turn->damage;
    return tell(id, time, patient, post);
}

template <class Layer>
bool SurfaceLayers<Layer>::afterStep(std::uint64_t step, double time, physics::PhysicsServer& physics, const Post& post)
{
    if (!any_) return true;
    bool all = true;
    const std::lock_guard lock(mutex_);
    for (auto& [id, each] : patients_) {
        if (time < each.next - 1e-9) continue;
        const frame::FrameRef frame = physics.latest();
        if (!frame || frame->step != step) return all; // readers hold all frames: the next step has one
        const frame::SoftBodyFrame* body = frame->softBody(id);
        if (body == nullptr) continue; // not there yet, or removed
        all = takeResults(id, time, each, post) && all;
        begin(each, *frame, *body, time);
        const double rate = each.start->def().rate;
        each.next = (std::floor(time * rate + 1e-6) + 1.0) / rate;
    }
    return all;
}

template <class Layer> void SurfaceLayers<Layer>::close(const std::map<BodyId, NodeFlags>& closed)
{
    if (closed.empty() || !any_) return;
    const std::lock_guard lock(mutex_);
    for (const auto& [id, nodes] : closed)
        if (const auto found = patients_.find(id); found != patients_.end()) found->second.closed = nodes;
}

template <class Layer> std::map<BodyId, NodeFlags> SurfaceLayers<Layer>::takeBurnt()
{
    std::map<BodyId, NodeFlags> out;
    if (!any_) return out;
    const std::lock_guard lock(mutex_);
    for (auto& [id, each] : patients_)
        if (NodeFlags burnt = std::exchange(each.burnt, nullptr)) out[id] = std::move(burnt);
    return out;
}

template <class Layer> std::vector<surface::Fume> SurfaceLayers<Layer>::takeFumes()
{
    std::vector<surface::Fume> out;
    if (!any_) return out;
    const std::lock_guard lock(mutex_);
    for (auto& [id, each] : patients_)
        for (const surface::Fume& fume : std::exchange(each.fumes, {})) out.push_back(fume);
    return out;
}

template <class Layer> std::vector<physics::SetTissue> SurfaceLayers<Layer>::takeTissue()
{
    std::vector<physics::SetTissue> out;
    if (!any_) return out;
    const std::lock_guard lock(mutex_);
    for (auto& [id, each] : patients_)
        for (physics::SetTissue& change : std::exchange(each.tissue, {})) out.push_back(std::move(change));
    return out;
}

template <class Layer>
void SurfaceLayers<Layer>::check(const physics::PhysicsEngine& engine, const physics::PhysicsServer& physics) const
{
    const std::lock_guard lock(mutex_);
    for (const auto& patient : patients_) { // clang 14 takes no structured binding in a requires-expression
        const auto& each = patient.second;
        if constexpr (requires { each.start->def().tissue; })
            if (each.start->def().tissue && physics.has(patient.first))
                checkTissue(patient.first, *physics.def(patient.first), engine,
                            text(Kind<Layer>::kDoing, " of '", each.name, "'"));
    }
}

template <class Layer> auto SurfaceLayers<Layer>::surfaces(double time) const -> std::vector<Surface>
{
    std::vector<Surface> out;
    if (!any_) return out;
    const std::lock_guard lock(mutex_);
    for (const auto& [id, each] : patients_) {
        [[maybe_unused]] const bool begins = each.last >= 0.0 && time >= each.next - 1e-9;
        if constexpr (requires(const Layer& layer) { layer.skin(); })
            out.push_back({id, each.start->skin(), begins ? time - each.last : 0.0, spreadOf(each.start->def())});
    }
    return out;
}

template <class Layer> void SurfaceLayers<Layer>::touch(BodyId id, surface::TipHeat tip)
{
    const std::lock_guard lock(mutex_);
    if (const auto found = patients_.find(id); found != patients_.end()) found->second.tips.push_back(std::move(tip));
}

template <class Layer> double SurfaceLayers<Layer>::taken(int electrode, bool toTheEnd) const
{
    const std::lock_guard lock(mutex_);
    double sum = 0.0;
    for (const auto& [id, each] : patients_) {
        const std::map<int, double>* taken = &each.taken;
        if constexpr (requires(const Layer& layer) { layer.taken(); })
            if (toTheEnd) taken = &each.turn->layer.taken();
        if (const auto found = taken->find(electrode); found != taken->end()) sum += found->second;
    }
    return sum;
}

template <class Layer> std::map<BodyId, NodeFilm> SurfaceLayers<Layer>::takeFilms()
{
    std::map<BodyId, NodeFilm> out;
    if (!any_) return out;
    const std::lock_guard lock(mutex_);
    for (auto& [id, each] : patients_)
        if (std::exchange(each.fresh, false)) out[id] = each.film;
    return out;
}

template <class Layer> void SurfaceLayers<Layer>::fill(RunReport& report) const
{
    const std::lock_guard lock(mutex_);
    auto& reports = Kind<Layer>::reports(report);
    reports.clear();
    for (const auto& [id, each] : patients_) {
        if (each.job) each.job->finish(); // the layer's last step counts
        reports.push_back(Kind<Layer>::report(each.name, each.turn->layer));
    }
}

template <class Layer> auto SurfaceLayers<Layer>::copy() const -> Patients
{
    Patients out = patients_;
    for (auto& [id, each] : out) {
        finish(each);
        each.turn = std::make_shared<Turn>(*each.turn);
    }
    return out;
}

template <class Layer> Memory SurfaceLayers<Layer>::memory()
{
    return {.of = text("the ", Kind<Layer>::kOf),
            .save =
                [this] {
                    const std::lock_guard lock(mutex_);
                    return patients_.empty() ? std::any() : std::any(copy());
                },
            .restore =
                [this](const std::any& saved) {
                    const std::lock_guard lock(mutex_);
                    for (auto& [id, each] : patients_) finish(each);
                    patients_ = std::any_cast<const Patients&>(saved);
                    for (auto& [id, each] : patients_) {
                        each.turn = std::make_shared<Turn>(*each.turn); // the saved one stays as it is
                        each.fresh = each.film != nullptr;
                    }
                }};
}

template class SurfaceLayers<surface::Bleeding>;
template class SurfaceLayers<surface::Burning>;

} // namespace filasofia::runtime
