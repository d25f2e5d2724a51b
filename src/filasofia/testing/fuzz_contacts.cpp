#include "filasofia/testing/fuzz_contacts.h"

#include "filasofia/core/text.h"
#include "filasofia/geometry/mass_properties.h"
#include "filasofia/geometry/surface.h"
#include "filasofia/testing/fuzz_contact_scene.h"
#include "filasofia/testing/fuzz_stage.h"
#include "filasofia/testing/surface_overlap.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace filasofia::testing {
namespace {

constexpr int kContactKinds = static_cast<int>(ContactKind::count_);
constexpr std::size_t kContactExamples = 40; ///< that a report keeps
constexpr double kLookEvery = 0.01;          ///< [s]: the engine tests as often
constexpr int kSilentLooks = 3;              ///< looks in a row at an overlap that no flag tells
constexpr double kCalmSpeed = 1e-3;          ///< [m/s]
constexpr double kCalmFor = 0.2;             ///< [s] at the end of a scene
constexpr double kGravity = 9.81;            ///< [m/s^2]
// [-] More of the energy at the start than this is gained. Contacts keep surfaces apart by a hundredth of a millimetre,
// which lifts what lies on the floor.
constexpr double kGain = 0.01;
// [m] Contacts see surfaces whose edges and corners are round with the radius of their insets, a tenth of a millimetre
// each, and keep up with what moves from one step to the next only so far.
constexpr double kRounded = 2.5e-4;

/// What the checker needs of a body.
struct CheckedBody {
    std::vector<geometry::Tetrahedron> tetrahedra = {}; ///< soft bodies
    std::vector<double> volumes = {};                   ///< [m^3] at rest, per tetrahedron
    std::vector<double> masses = {};                    ///< [kg] per node; one for a dynamic rigid body
    PlacedSurface surface = {};                         ///< rigid: `rest` are its vertices in its own coordinates
    std::vector<Vec3> rest = {};
    std::vector<int> nodes = {}; ///< soft: the node of each vertex
    bool soft = false, told = false;
};

double volumeOf(const geometry::Tetrahedron& t, const std::vector<Vec3>& x)
{
    const auto at = [&](std::size_t k) { return x[static_cast<std::size_t>(t[k])]; };
    return geometry::signedVolume(at(0), at(1), at(2), at(3));
}

double valueOf(const physics::Mass& mass) { return std::get<physics::Density>(mass).value; }

CheckedBody checked(const physics::SoftBodyDef& def)
{
    CheckedBody body{.soft = true};
    const double density = valueOf(def.mass);
    if (const auto* mesh = std::get_if<std::shared_ptr<const geometry::TetMesh>>(&def.mesh)) {
        body.tetrahedra = (*mesh)->tetrahedra;
        geometry::Surface surface = geometry::extractSurface(**mesh);
        body.surface.triangles = std::move(surface.mesh.triangles);
        body.nodes = std::move(surface.nodes);
        body.masses.resize((*mesh)->nodes.size());
        for (const geometry::Tetrahedron& t : body.tetrahedra) {
            body.volumes.push_back(volumeOf(t, (*mesh)->nodes));
            const double part = 0.25 * density * body.volumes.back();
            for (const int node : t) body.masses[static_cast<std::size_t>(node)] += part;
        }
        return body;
    }
    const auto& sheet = *std::get<std::shared_ptr<const geometry::TriangleMesh>>(def.mesh);
    body.surface = {.triangles = sheet.triangles, .closed = false};
    body.masses.resize(sheet.vertices.size());
    for (std::size_t v = 0; v < sheet.vertices.size(); ++v) body.nodes.push_back(static_cast<int>(v));
    const double perArea = density * std::get<physics::ShellMaterial>(def.material).thickness;
    for (const geometry::Triangle& t : sheet.triangles) {
        const auto x = [&](std::size_t k) { return sheet.vertices[static_cast<std::size_t>(t[k])]; };
        for (const int node : t)
            body.masses[static_cast<std::size_t>(node)] += perArea / 6.0 * length(cross(x(1) - x(0), x(2) - x(0)));
    }
    return body;
}

CheckedBody checked(const physics::RigidBodyDef& def)
{
    const auto& mesh = *std::get<std::shared_ptr<const geometry::TriangleMesh>>(def.mesh);
    CheckedBody body{.surface = {.triangles = mesh.triangles}, .rest = mesh.vertices, .told = !def.dynamic};
    if (def.dynamic) body.masses = {std::get<physics::Density>(def.mass).value * geometry::enclosedVolume(mesh)};
    return body;
}

CheckedBody checked(const physics::BodyDef& def)
{
    if (const auto* soft = std::get_if<physics::SoftBodyDef>(&def)) return checked(*soft);
    return checked(std::get<physics::RigidBodyDef>(def));
}

/// A scene that runs, and what is counted of it.
class ContactRun {
public:
    ContactRun(const ContactFuzzDef& def, ContactKind kind, std::uint64_t seed, ContactFuzzReport& report)
        : def_(def), report_(report), random_(seed), scene_(contactScene(kind, random_)),
          stage_(scene_.bodies, scene_.period)
    {
        for (const physics::BodyDef& each : scene_.bodies) bodies_.push_back(checked(each));
        stage_.give(physics::SetGravity{{0, -kGravity, 0}});
        stage_.step(0.0);
        energyAtStart_ = energy();
    }
    /// Runs it to its end; returns its hash.
    std::uint64_t run(ContactFuzzKind& counts, IterationCount& iterations, const std::string& called)
    {
        const double end = scene_.acts + def_.calm;
        const long steps = std::lround(end / scene_.period);
        const long look = std::max(1L, std::lround(kLookEvery / scene_.period));
        double time = 0.0;
        const auto say = [&](const auto& what) {
            if (report_.examples.size() < kContactExamples)
                report_.examples.push_back(text(called, ", ", time, " s: ", what));
        };
        for (long step = 1; step <= steps; ++step) {
            time = static_cast<double>(step) * scene_.period;
            for (const ToldBody& told : scene_.told)
                stage_.give(physics::SetPose{FuzzStage::idOf(told.body), 0, told.at(std::min(time, scene_.acts))});
            const physics::StepReport report = stage_.step(scene_.period);
            follow(report, counts, iterations, say);
            if (step % look == 0) lookAt(report, say);
            if (time > end - kCalmFor) fastest_ = std::max(fastest_, speed());
        }
        finish(counts, steps);
        if (fastest_ > kCalmSpeed) say(text(1e3 * fastest_, " mm/s at the end"));
        return stage_.hash();
    }

private:
    template <class Say>
    void follow(const physics::StepReport& step, ContactFuzzKind& counts, IterationCount& iterations, const Say& say)
    {
        iterations.add(step);
        counts.notConverged += step.has(physics::StepFlag::NotConverged) ? 1 : 0;
        if (step.has(physics::StepFlag::Undone)) ++report_.undone, say("undone");
        if (!stage_.isFinite()) ++report_.notFinite, say("not finite");
        if (std::exchange(mustTell_, false) && step.inverted.count == 0) {
            ++report_.silentInverted;
            say("elements were inside out, without a flag");
        }
    }

    template <class Say> void lookAt(const physics::StepReport& step, const Say& say)
    {
        place();
        overlapsNow_ = 0;
        for (std::size_t i = 0; i < bodies_.size(); ++i)
            for (std::size_t k = i + 1; k < bodies_.size(); ++k)
                if (!bodies_[i].told || !bodies_[k].told) lookAtPair(step, i, k, say);
        lookAtElements();
        if (scene_.acts > 0.0) return; // what is told does work
        const double gain = (energy() - energyAtStart_) / energyAtStart_;
        report_.mostGained = std::max(report_.mostGained, gain);
        if (gain > kGain && !std::exchange(gained_, true)) {
            ++report_.gained;
            say(text("energy has grown by ", 100.0 * gain, " %"));
        }
    }

    template <class Say> void lookAtPair(const physics::StepReport& step, std::size_t i, std::size_t k, const Say& say)
    {
        const auto found = overlapOf(bodies_[i].surface, bodies_[k].surface);
        int& silent = silent_[{i, k}];
        if (!found || found->depth < kRounded) {
            silent = std::min(silent, 0);
            return;
        }
        ++overlapsNow_;
        overlapped_ = true;
        report_.deepest = std::max(report_.deepest, found->depth);
        // Contacts that are still followed are told by how deep they are, only those that are lost by a flag.
        const bool followed = step.contacts.penetration + kRounded > found->depth;
        const bool told = followed || std::ranges::any_of(step.intersections, [&](const physics::Intersection& each) {
                              return each.first == FuzzStage::idOf(i) && each.second == FuzzStage::idOf(k);
                          });
        if (silent < 0) return; // the pair has been counted
        silent = told ? 0 : silent + 1;
        if (silent < kSilentLooks) return;
        silent = -1;
        ++report_.silentOverlaps;
        say(text("bodies ", i + 1, " and ", k + 1, " pass through each other by ", 1e3 * found->depth, " mm at (",
                 found->place.x, ", ", found->place.y, ", ", found->place.z, ") m, without a flag"));
    }

    /// Looks for elements that the report of the next step must count. Those whose volume is hardly below 0 may go
    /// either way in single precision.
    void lookAtElements()
    {
        constexpr double surely = -1e-4; // [-] relative to the volume at rest
        for (std::size_t b = 0; b < bodies_.size() && !mustTell_; ++b) {
            if (bodies_[b].tetrahedra.empty()) continue;
            const std::vector<Vec3>& x = stage_.frame().softBody(FuzzStage::idOf(b))->positions;
            for (std::size_t t = 0; t < bodies_[b].tetrahedra.size(); ++t)
                mustTell_ = mustTell_ || volumeOf(bodies_[b].tetrahedra[t], x) < surely * bodies_[b].volumes[t];
        }
        inverted_ = inverted_ || mustTell_;
    }

    void place()
    {
        for (std::size_t b = 0; b < bodies_.size(); ++b) {
            CheckedBody& body = bodies_[b];
            std::vector<Vec3>& out = body.surface.vertices;
            out.clear();
            if (body.soft) {
                const std::vector<Vec3>& x = stage_.frame().softBody(FuzzStage::idOf(b))->positions;
                for (const int node : body.nodes) out.push_back(x[static_cast<std::size_t>(node)]);
            } else {
                const Pose& pose = stage_.frame().rigidBody(FuzzStage::idOf(b))->poses.front();
                for (const Vec3 p : body.rest) out.push_back(transform(pose, p));
            }
        }
    }

    /// Calls visit(mass, place, velocity) for every mass that moves.
    template <class Visit> void forEachMass(const Visit& visit) const
    {
        for (std::size_t b = 0; b < bodies_.size(); ++b) {
            const CheckedBody& body = bodies_[b];
            if (body.told) continue;
            const auto* soft = stage_.frame().softBody(FuzzStage::idOf(b));
            const auto* rigid = stage_.frame().rigidBody(FuzzStage::idOf(b));
            for (std::size_t i = 0; i < body.masses.size(); ++i)
                visit(body.masses[i], soft ? soft->positions[i] : rigid->poses[i].position,
                      soft ? soft->velocities[i] : rigid->velocities[i]);
        }
    }
    /// [J] Kinetic energy without spin, and weight times height above the floor.
    [[nodiscard]] double energy() const
    {
        double sum = 0.0;
        forEachMass([&](double mass, Vec3 x, Vec3 v) { sum += mass * (0.5 * dot(v, v) + kGravity * x.y); });
        return sum;
    }
    [[nodiscard]] double speed() const
    {
        double most = 0.0;
        forEachMass([&](double, Vec3, Vec3 v) { most = std::max(most, length(v)); });
        return most;
    }

    void finish(ContactFuzzKind& counts, long steps)
    {
        counts.steps += steps;
        report_.steps += steps;
        report_.seconds += static_cast<double>(steps) * scene_.period;
        counts.overlapping += overlapped_ ? 1 : 0;
        counts.inverted += inverted_ ? 1 : 0;
        counts.crowded += overlapsNow_ > 0 ? 1 : 0;
        counts.restless += fastest_ > kCalmSpeed ? 1 : 0;
    }

    const ContactFuzzDef& def_;
    ContactFuzzReport& report_;
    FuzzRandom random_;
    ContactScene scene_;
    FuzzStage stage_;
    std::vector<CheckedBody> bodies_;
    std::map<std::pair<std::size_t, std::size_t>, int> silent_; ///< per pair: looks in a row; -1: it has been counted
    int overlapsNow_ = 0;
    double energyAtStart_ = 0.0; ///< [J]
    double fastest_ = 0.0;       ///< [m/s] at the end
    bool overlapped_ = false, inverted_ = false, mustTell_ = false, gained_ = false;
};

} // namespace

ContactFuzzReport fuzzContacts(const ContactFuzzDef& def)
{
    ContactFuzzReport report;
    for (int i = 0; i < kContactKinds; ++i) report.kinds.push_back({name(static_cast<ContactKind>(i))});
    IterationCount iterations;
    Hasher all;
    for (int index = def.first; index < def.first + def.scenes; ++index) {
        runScene<ContactRun, ContactKind>(def, static_cast<std::uint64_t>(index), report, iterations, all);
        if (def.progress) def.progress(static_cast<int>(report.scenes));
    }
    summarise(iterations, all, report);
    return report;
}

} // namespace filasofia::testing
