#include "filasofia/testing/fuzz_contacts.h"

#include "filasofia/core/text.h"
#include "filasofia/geometry/mass_properties.h"
#include "filasofia/geometry/surface.h"
#include "filasofia/testing/fuzz_contact_scene.h"
#include "filasofia/testing/fuzz_stage.h"
#include "filasofia/testing/linking.h"
#include "filasofia/testing/surface_overlap.h"
#include "filasofia/testing/tissue_strain.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

namespace filasofia::testing {
namespace {

constexpr std::size_t kContactExamples = 40; ///< that a report keeps
constexpr double kLookEvery = 0.01;          ///< [s]: the engine tests as often
constexpr int kSilentLooks = 3;              ///< looks in a row at an overlap that no flag tells
constexpr double kCalmSpeed = 1e-3;          ///< [m/s]
constexpr double kCalmFor = 0.2;             ///< [s] at the end of a scene
constexpr double kThreadsRollFor = 4.0;      ///< [-] threads, and needles' tails, have so much longer to come to rest
constexpr double kGravity = 9.81;            ///< [m/s^2]
// [-] More of the energy at the start than this is gained. Contacts keep surfaces apart by a hundredth of a millimetre,
// which lifts what lies on the floor.
constexpr double kGain = 0.01;
// [-] The same once tools have stopped; steps that end a solve at its tolerance make 1 %.
constexpr double kGainAfterTools = 0.05;
constexpr double kLeastEnergy = 1e-6; ///< [J] gains count relative to this at least
// [m] Contacts see surfaces whose edges and corners are round with the radius of their insets, a tenth of a millimetre
// each, and keep up with what moves from one step to the next only so far.
constexpr double kRounded = 2.5e-4;
// [m] Channels go in straight lines from point to point, and begin where the surface is pierced, not where the line
// crosses the triangle that is there.
constexpr double kBesideChannels = 2e-3;

constexpr std::size_t kNone = static_cast<std::size_t>(-1);

/// What the checker needs of a body.
struct CheckedBody {
    std::vector<geometry::Tetrahedron> tetrahedra = {}; ///< soft bodies
    std::vector<double> volumes = {};                   ///< [m^3] at rest, per tetrahedron
    std::vector<double> masses = {};                    ///< [kg] per node; one for a dynamic rigid body
    PlacedSurface surface = {};                         ///< rigid: `rest` are its vertices in its own coordinates
    std::vector<Vec3> rest = {};
    std::vector<int> nodes = {};  ///< soft: the node of each vertex
    double grip = physics::kHard; ///< [N/m] rods: stiffness of a hand's grip
    std::size_t needle = kNone;   ///< rods: the body of the needle that they hang from
    std::vector<Vec3> axis = {};  ///< needles: from the tip to the tail, in their own coordinates
    std::uint64_t revision = 0;   ///< the mesh that has been cut, in `surface`
    bool soft = false, told = false, cuttable = false, rod = false, closed = false;

    [[nodiscard]] bool touches() const { return rod || !surface.triangles.empty(); }
};

double volumeOf(const geometry::Tetrahedron& t, const std::vector<Vec3>& x)
{
    const auto at = [&](std::size_t k) { return x[static_cast<std::size_t>(t[k])]; };
    return geometry::signedVolume(at(0), at(1), at(2), at(3));
}

double valueOf(const physics::Mass& mass) { return std::get<physics::Density>(mass).value; }

CheckedBody checked(const physics::SoftBodyDef& def)
{
    CheckedBody body{.soft = true, .cuttable = def.dynamicTopology};
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

CheckedBody checked(const physics::RodBodyDef& def)
{
    CheckedBody body{.soft = true, .rod = true, .closed = def.closed};
    const std::vector<Vec3> nodes = physics::centreLine(def);
    const double perLength = def.density * std::numbers::pi * def.radius * def.radius;
    body.masses.resize(nodes.size());
    for (std::size_t i = def.closed ? 0 : 1; i < nodes.size(); ++i) {
        const std::size_t before = i == 0 ? nodes.size() - 1 : i - 1;
        for (const std::size_t node : {before, i})
            body.masses[node] += 0.5 * perLength * distance(nodes[before], nodes[i]);
    }
    for (const physics::AttachmentDef& each : def.attachments) {
        body.grip = each.stiffness;
        if (each.stiffness == physics::kHard) body.needle = each.to.value - 1; // hands hold by springs
    }
    return body;
}

CheckedBody checked(const physics::RigidBodyDef& def)
{
    CheckedBody body{.told = !def.dynamic};
    if (def.needle) body.axis = def.needle->line;
    const auto* mesh = std::get_if<std::shared_ptr<const geometry::TriangleMesh>>(&def.mesh);
    if (mesh == nullptr || *mesh == nullptr) return body; // hands and blades
    body.surface.triangles = (*mesh)->triangles;
    body.rest = (*mesh)->vertices;
    if (def.dynamic) body.masses = {std::get<physics::Density>(def.mass).value * geometry::enclosedVolume(**mesh)};
    return body;
}

/// A scene that runs, and what is counted of it.
class ContactRun {
public:
    ContactRun(const ContactFuzzDef& def, ContactKind kind, std::uint64_t seed, ContactFuzzReport& report)
        : def_(def), report_(report), random_(seed), scene_(contactScene(kind, random_)),
          stage_(scene_.bodies, scene_.period)
    {
        for (const physics::BodyDef& each : scene_.bodies)
            bodies_.push_back(std::visit([](const auto& body) { return checked(body); }, each));
        stage_.give(physics::SetGravity{{0, -kGravity, 0}});
        stage_.step(0.0);
        energyAtStart_ = energy();
        readLines();
    }
    /// Runs it to its end; returns its hash.
    std::uint64_t run(ContactFuzzKind& counts, IterationCount& iterations, const std::string& called)
    {
        double end = scene_.acts + def_.calm;
        const double latest = scene_.tools ? scene_.acts + kThreadsRollFor * def_.calm : end;
        long steps = std::lround(end / scene_.period);
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
            lookAtLines(counts, say);
            if (step % look == 0) {
                lookAt(report, say);
                lookAtEnergy(time, say);
            }
            if (time > end - kCalmFor) fastest_ = std::max(fastest_, speed());
            if (step == steps && fastest_ > kCalmSpeed && end < latest) {
                end += def_.calm;
                steps = std::lround(end / scene_.period);
                fastest_ = 0.0;
            }
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
        for (const auto flag :
             {physics::StepFlag::Intersecting, physics::StepFlag::Inverted, physics::StepFlag::NotConverged})
            flagged_ = flagged_ || step.has(flag);
        counts.notConverged += step.has(physics::StepFlag::NotConverged) ? 1 : 0;
        if (step.has(physics::StepFlag::Undone)) ++report_.undone, say("undone");
        if (!stage_.isFinite()) ++report_.notFinite, say("not finite");
        if (std::exchange(mustTell_, false) && step.inverted.count == 0) {
            ++report_.silentInverted;
            say("elements were inside out, without a flag");
        }
    }

    void readLines()
    {
        std::swap(before_, after_);
        after_.resize(bodies_.size());
        for (std::size_t b = 0; b < bodies_.size(); ++b)
            if (bodies_[b].rod) after_[b] = stage_.frame().softBody(FuzzStage::idOf(b))->positions;
    }
    template <class Say> void lookAtLines(ContactFuzzKind& counts, const Say& say)
    {
        readLines();
        for (std::size_t i = 0; i < bodies_.size(); ++i)
            for (std::size_t k = i; k < bodies_.size(); ++k) {
                if (!bodies_[i].rod || !bodies_[k].rod) continue;
                const int passed = std::abs(passes_.count({before_[i], after_[i], bodies_[i].closed},
                                                          {before_[k], after_[k], bodies_[k].closed}));
                if (passed == 0) continue;
                counts.passes += passed;
                report_.passes += passed;
                say(text("body ", i + 1, " passes through ", k + 1));
            }
    }

    template <class Say> void lookAt(const physics::StepReport& step, const Say& say)
    {
        place();
        overlapsNow_ = 0;
        for (std::size_t i = 0; i < bodies_.size(); ++i)
            for (std::size_t k = i + 1; k < bodies_.size(); ++k)
                if (bodies_[i].touches() && bodies_[k].touches() && (!bodies_[i].told || !bodies_[k].told))
                    lookAtPair(step, i, k, say);
        lookAtElements();
    }

    template <class Say> void lookAtEnergy(double time, const Say& say)
    {
        if (scene_.tools) return lookAfterTools(time, say);
        if (scene_.acts > 0.0) return; // what is told does work
        const double gain = (energy() - energyAtStart_) / energyAtStart_;
        report_.mostGained = std::max(report_.mostGained, gain);
        if (gain > kGain && !std::exchange(gained_, true)) {
            ++report_.gained;
            say(text("energy has grown by ", 100.0 * gain, " %"));
        }
    }
    /// Tissue, threads and the grips of hands hold strain when tools stop, by the engine's own account. It bounds the
    /// energy of places and velocities from then on. Strain may grow: a stiff thread that turns far in a step is
    /// stretched. Contacts that part what was pressed together do work, so nothing is judged once a flag has said so.
    template <class Say> void lookAfterTools(double time, const Say& say)
    {
        double motion = 0.0, strain = gripEnergy();
        for (std::size_t b = 0; b < bodies_.size(); ++b) {
            if (bodies_[b].told) continue;
            const physics::MechanicalEnergy energy = stage_.energyOf(b);
            motion += energy.kinetic + energy.gravitational;
            strain += energy.elastic;
        }
        if (time <= scene_.acts + 2.0 * scene_.period || scaleAfterTools_ == 0.0) {
            energyAtStart_ = motion + strain;
            scaleAfterTools_ = std::max(std::abs(motion) + std::abs(strain), kLeastEnergy);
            return;
        }
        const double gain = (motion - energyAtStart_) / scaleAfterTools_;
        if (flagged_) return;
        report_.mostGained = std::max(report_.mostGained, gain);
        if (gain <= kGainAfterTools || std::exchange(gained_, true)) return;
        ++report_.gained;
        say(text("energy has grown by ", 100.0 * gain, " % after tools have stopped"));
    }
    /// [J] What the springs hold by which hands hold threads, one node each.
    [[nodiscard]] double gripEnergy() const
    {
        double sum = 0.0;
        for (const frame::Attachment& each : stage_.frame().attachments) {
            const CheckedBody& body = bodies_[each.body.value - 1];
            if (body.rod && std::isfinite(body.grip)) sum += 0.5 * dot(each.force, each.force) / body.grip;
        }
        return sum;
    }

    /// How deep two bodies are in each other.
    [[nodiscard]] std::optional<SurfaceOverlap> overlapOfPair(std::size_t i, std::size_t k)
    {
        const CheckedBody &one = bodies_[i], &two = bodies_[k];
        if (one.rod && two.rod) return std::nullopt; // lookAtLines() does
        if (pierces(i, k)) return overlapBesideChannels(i, k);
        if (!one.rod && !two.rod) return overlapOf(one.surface, two.surface);
        if (one.needle == k || two.needle == i) return std::nullopt; // the thread begins in the needle's tail
        const auto line = one.rod ? overlapOf(after_[i], two.surface) : overlapOf(after_[k], one.surface);
        return line ? std::optional(SurfaceOverlap{line->depth, line->place}) : std::nullopt;
    }
    /// Whether one is a needle in the other, or the thread that follows it.
    [[nodiscard]] bool pierces(std::size_t i, std::size_t k) const
    {
        const auto lineIn = [&](std::size_t line, std::size_t tissue) {
            const BodyId needle = FuzzStage::idOf(bodies_[line].needle == kNone ? line : bodies_[line].needle);
            return std::ranges::any_of(stage_.frame().channels, [&](const frame::Channel& each) {
                return each.tissue == FuzzStage::idOf(tissue) &&
                       (each.needle == needle || each.inside == FuzzStage::idOf(line));
            });
        };
        return lineIn(i, k) || lineIn(k, i);
    }
    /// By how much more of needle and thread is in the tissue than its channels are long, judged once, by the thread.
    [[nodiscard]] std::optional<SurfaceOverlap> overlapBesideChannels(std::size_t i, std::size_t k) const
    {
        const std::size_t thread = bodies_[i].rod ? i : bodies_[k].rod ? k : kNone;
        if (thread == kNone) return std::nullopt;
        const std::size_t tissue = thread == i ? k : i;
        std::vector<Vec3> line;
        if (const std::size_t needle = bodies_[thread].needle; needle != kNone) {
            const Pose& pose = stage_.frame().rigidBody(FuzzStage::idOf(needle))->poses.front();
            for (const Vec3 p : bodies_[needle].axis) line.push_back(transform(pose, p));
            line.pop_back(); // the thread's first node
        }
        line.insert(line.end(), after_[thread].begin(), after_[thread].end());
        const auto found = overlapOf(line, bodies_[tissue].surface);
        if (!found) return std::nullopt;
        const double beside = found->inside - kBesideChannels - stage_.lengthOfChannels(tissue);
        if (beside <= 0.0) return std::nullopt;
        return SurfaceOverlap{std::min(beside, found->depth), found->place};
    }

    template <class Say> void lookAtPair(const physics::StepReport& step, std::size_t i, std::size_t k, const Say& say)
    {
        const auto found = overlapOfPair(i, k);
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
            if (bodies_[b].cuttable) {
                mustTell_ = surelyInverted(stage_.soft(b)) > 0;
                continue;
            }
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
            if (!body.touches() || body.rod) continue;
            if (body.soft) {
                if (body.cuttable) followCuts(b);
                const std::vector<Vec3>& x = stage_.frame().softBody(FuzzStage::idOf(b))->positions;
                for (const int node : body.nodes) out.push_back(x[static_cast<std::size_t>(node)]);
            } else {
                const Pose& pose = stage_.frame().rigidBody(FuzzStage::idOf(b))->poses.front();
                for (const Vec3 p : body.rest) out.push_back(transform(pose, p));
            }
        }
    }

    /// The surface of a body that may have been cut, and its masses.
    void followCuts(std::size_t b)
    {
        CheckedBody& body = bodies_[b];
        const auto& boundary = stage_.frame().softBody(FuzzStage::idOf(b))->boundary;
        if (!boundary || boundary->revision == body.revision) return;
        body.revision = boundary->revision;
        body.surface.triangles = boundary->triangles;
        body.nodes.resize(boundary->rest.size());
        for (std::size_t i = 0; i < body.nodes.size(); ++i) body.nodes[i] = static_cast<int>(i);
        body.masses = stage_.soft(b).model.masses;
    }

    /// Calls visit(mass, place, velocity) for every mass that moves.
    template <class Visit> void forEachMass(const Visit& visit) const
    {
        for (std::size_t b = 0; b < bodies_.size(); ++b) {
            const CheckedBody& body = bodies_[b];
            if (body.told) continue;
            const auto* soft = stage_.frame().softBody(FuzzStage::idOf(b));
            const auto* rigid = stage_.frame().rigidBody(FuzzStage::idOf(b));
            const std::size_t count = soft ? std::min(body.masses.size(), soft->positions.size()) : body.masses.size();
            for (std::size_t i = 0; i < count; ++i)
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
    std::vector<std::vector<Vec3>> before_, after_; ///< per body, of rods: nodes before and after the step
    PassCounter passes_;
    double energyAtStart_ = 0.0;   ///< [J] or when tools stopped
    double scaleAfterTools_ = 0.0; ///< [J]
    double fastest_ = 0.0;         ///< [m/s] at the end
    bool overlapped_ = false, inverted_ = false, mustTell_ = false, gained_ = false, flagged_ = false;
};

} // namespace

ContactFuzzReport fuzzContacts(const ContactFuzzDef& def)
{
    ContactFuzzReport report;
    const ContactKind first = def.tools ? kFirstToolKind : ContactKind{},
                      end = def.tools ? ContactKind::count_ : kFirstToolKind;
    for (auto kind = static_cast<int>(first); kind < static_cast<int>(end); ++kind)
        report.kinds.push_back({name(static_cast<ContactKind>(kind))});
    IterationCount iterations;
    Hasher all;
    for (int index = def.first; index < def.first + def.scenes; ++index) {
        runScene<ContactRun>(def, first, static_cast<std::uint64_t>(index), report, iterations, all);
        if (def.progress) def.progress(static_cast<int>(report.scenes));
    }
    summarise(iterations, all, report);
    return report;
}

} // namespace filasofia::testing
