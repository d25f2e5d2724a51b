#include "filasofia/runtime/bleedings.h"

#include "filasofia/core/validate.h"
#include "filasofia/runtime/surfaces.h"

#include <cmath>

namespace filasofia::runtime {
namespace {

constexpr double kTelling = 1.0; ///< [s] between two events of a body

/// The triangles of a soft body by its nodes, before it is cut.
std::vector<geometry::Triangle> skinOf(const physics::SoftBodyDef& body, const std::string& object)
{
    mapping::MappedSurface skin = mapSoft(body, nullptr, object);
    const auto& nodes = std::get<mapping::IdentityMap>(skin.map).nodes;
    for (geometry::Triangle& each : skin.surface.triangles)
        for (int& corner : each) corner = nodes[static_cast<std::size_t>(corner)];
    return std::move(skin.surface.triangles);
}

} // namespace

void Bleedings::Turn::run()
{
    if (boundary) blood.follow(*boundary);
    if (blood.nodesNeeded() <= std::ssize(positions)) {
        for (const surface::BloodCommand& each : commands) blood.apply(each, positions);
        blood.step(positions, gravity, dt);
    }
    film = std::make_shared<const std::vector<float>>(blood.thickness());
}

void Bleedings::add(BodyId id, const surface::BleedingDef& def, Vec3 gravity, const physics::PhysicsServer& physics)
{
    const auto body = physics.def(id);
    const std::string object = text("bleeding of ", physics::describeBody(*body));
    const auto* soft = std::get_if<physics::SoftBodyDef>(&*body);
    if (soft == nullptr) fail(object, ": needs a soft body with a surface");
    auto start = std::make_shared<const surface::Bleeding>(def, skinOf(*soft, object), object);
    const std::lock_guard lock(mutex_);
    if (patients_.contains(id)) fail(object, ": it bleeds already");
    patients_[id] = {
        .name = soft->name, .gravity = gravity, .start = start, .turn = std::make_shared<Turn>(Turn{.blood = *start})};
    any_ = true;
}

const Bleedings::Patient& Bleedings::patient(BodyId id) const
{
    const auto found = patients_.find(id);
    if (found == patients_.end()) fail("blood: body ", id.value, " does not bleed; bleed() makes it");
    return found->second;
}

void Bleedings::treat(BodyId id, const surface::BloodCommand& command)
{
    const std::lock_guard lock(mutex_);
    std::visit([&](const auto& each) { validate(each, text("blood of '", patient(id).name, "'")); }, command);
    patients_.at(id).waiting.push_back(command);
}

surface::BloodBalance Bleedings::balance(BodyId id) const
{
    const std::lock_guard lock(mutex_);
    return patient(id).balance;
}

void Bleedings::restart()
{
    const std::lock_guard lock(mutex_);
    for (auto& [id, each] : patients_) {
        each.restart = true;
        each.waiting.clear();
    }
}

void Bleedings::finish(Patient& patient)
{
    if (!patient.job) return;
    patient.job->finish();
    patient.job = nullptr;
}

void Bleedings::begin(Patient& patient, const frame::SoftBodyFrame& body, double time)
{
    Turn& turn = *patient.turn;
    if (std::exchange(patient.restart, false)) {
        turn.blood = *patient.start;
        patient.told.reset(); // the next event says from where it counts again
        patient.tellFrom = 0.0;
    }
    turn.commands = std::exchange(patient.waiting, {});
    turn.positions = body.positions;
    turn.boundary = body.boundary;
    turn.gravity = patient.gravity;
    turn.dt = patient.last < 0.0 ? 0.0 : time - patient.last;
    patient.last = time;
    patient.job = std::make_shared<BackgroundJob>([turn = patient.turn] { turn->run(); });
    thread_.submit(patient.job);
}

bool Bleedings::tell(BodyId id, double time, Patient& patient, const Post& post)
{
    if (patient.told == patient.balance.welled || time < patient.tellFrom) return true;
    patient.told = patient.balance.welled;
    patient.tellFrom = std::floor(time / kTelling + 1e-6) * kTelling + kTelling;
    auto event = std::make_unique<BleedingEvent>();
    event->body = id;
    event->balance = patient.balance;
    return post(std::move(event));
}

bool Bleedings::afterStep(std::uint64_t step, double time, physics::PhysicsServer& physics, const Post& post)
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
        finish(each);
        if (each.turn->film) {
            each.balance = each.turn->blood.balance();
            each.film = each.turn->film;
            each.fresh = true;
            if (each.restart) each.tellFrom = 0.0; // what was lost before a reset is told before it is gone
            all = tell(id, time, each, post) && all;
        }
        begin(each, *body, time);
        const double rate = each.start->def().rate;
        each.next = (std::floor(time * rate + 1e-6) + 1.0) / rate;
    }
    return all;
}

std::map<BodyId, NodeFilm> Bleedings::takeFilms()
{
    std::map<BodyId, NodeFilm> out;
    if (!any_) return out;
    const std::lock_guard lock(mutex_);
    for (auto& [id, each] : patients_)
        if (std::exchange(each.fresh, false)) out[id] = each.film;
    return out;
}

void Bleedings::resendFilms()
{
    const std::lock_guard lock(mutex_);
    for (auto& [id, each] : patients_) each.fresh = each.film != nullptr;
}

void Bleedings::fill(RunReport& report) const
{
    const std::lock_guard lock(mutex_);
    report.blood.clear();
    for (const auto& [id, each] : patients_) {
        if (each.job) each.job->finish(); // the film's last step counts
        report.blood.push_back({each.name, each.turn->blood.balance()});
    }
}

Bleedings::Patients Bleedings::copy() const
{
    Patients out = patients_;
    for (auto& [id, each] : out) {
        finish(each);
        each.turn = std::make_shared<Turn>(*each.turn);
    }
    return out;
}

Memory Bleedings::memory()
{
    return {.of = "the blood",
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

} // namespace filasofia::runtime
