#include "filasofia/engine/step/close_clips.h"

#include "filasofia/core/assert.h"
#include "filasofia/core/log.h"
#include "filasofia/engine/contact/attachments.h"
#include "filasofia/engine/contact/clip_holds.h"
#include "filasofia/engine/scene/find_body.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace filasofia::engine {
namespace {

using Change = physics::ClipChange::Kind;

// Pairs of points along the legs and across them: as near as the edges of the finest tissue that is clipped.
constexpr int kAlong = 12, kAcross = 3;
// [N/m] for each point by which a clip hangs on the tissue; it weighs little.
constexpr double kHold = 500.0;
constexpr double kNoPlace = std::numeric_limits<double>::infinity();

/// Where a line parallel to y leaves the tissue, or enters it.
struct Crossing {
    double y = 0.0; ///< [m]
    bool leaves = false;
    std::vector<NodeWeight> point = {};
};

/// Where a line along y crosses a triangle; none if it does not, or only along it.
std::optional<Crossing> crossingOf(const geometry::Triangle& t, const std::vector<Vec3>& local, double x, double z)
{
    const auto at = [&](std::size_t k) { return local[static_cast<std::size_t>(t[k])]; };
    const auto area = [](double ax, double az, double bx, double bz) { return ax * bz - az * bx; };
    std::array<double, 3> weights{};
    for (std::size_t k = 0; k < 3; ++k) {
        const Vec3 b = at((k + 1) % 3), c = at((k + 2) % 3);
        weights[k] = area(b.x - x, b.z - z, c.x - x, c.z - z);
    }
    const double all = weights[0] + weights[1] + weights[2];
    const bool above = weights[0] >= 0.0 && weights[1] >= 0.0 && weights[2] >= 0.0;
    const bool below = weights[0] <= 0.0 && weights[1] <= 0.0 && weights[2] <= 0.0;
    if (!(above || below) || all == 0.0) return {};
    Crossing out{.leaves = all < 0.0}; // outwards is then +y: z x x = y
    for (std::size_t k = 0; k < 3; ++k) {
        out.y += weights[k] / all * at(k).y;
        if (weights[k] != 0.0) out.point.push_back({t[k], weights[k] / all});
    }
    return out;
}

/// The tissue on a line along y between the legs.
struct Between {
    std::optional<Crossing> top, bottom;
    double above = kNoPlace, below = kNoPlace; ///< [m] where the line crosses it next beyond the legs
    bool aboveLeaves = false, belowLeaves = true;

    void add(Crossing&& found, double half)
    {
        const double y = found.y;
        if (y > half && y < above) above = y, aboveLeaves = found.leaves;
        if (-y > half && -y < below) below = -y, belowLeaves = found.leaves;
        if (std::abs(y) > half) return;
        if (!bottom || y < bottom->y) bottom = found;
        if (!top || y > top->y) top = std::move(found);
    }
    /// It is between the legs, from one side to the other.
    [[nodiscard]] bool whole() const { return top && top->leaves && !bottom->leaves && top->y > bottom->y; }
    /// It goes on beyond a leg.
    [[nodiscard]] bool beyond() const { return aboveLeaves || !belowLeaves; }
};

/// Finds the pairs of points that face each other between the legs of a clip at this pose. Lines whose tissue goes on
/// beyond the opening have none.
void findPairs(const Pose& pose, const SoftBody& body, Clip& clip)
{
    const physics::ClipDef& def = clip.def;
    std::vector<Vec3> local;
    local.reserve(body.state.x.size());
    const Pose back = inverse(pose);
    for (Vec3 each : body.state.x) local.push_back(transform(back, each));
    const double half = 0.5 * def.opening;
    const auto tissueAt = [&](double x, double z) {
        Between out;
        for (const geometry::Triangle& t : body.model.surface)
            if (auto found = crossingOf(t, local, x, z)) out.add(std::move(*found), half);
        return out;
    };
    for (int i = 0; i < kAlong; ++i)
        for (int j = 0; j < kAcross; ++j) {
            const double z = ((i + 0.5) / kAlong - 0.5) * def.length;
            const double x = ((j + 0.5) / kAcross - 0.5) * def.width;
            Between found = tissueAt(x, z);
            if (found.whole()) clip.pairs.push_back({std::move(found.top->point), std::move(found.bottom->point)});
            clip.partial = clip.partial || found.beyond();
        }
    for (const double end : {-0.5, 0.5}) { // it may also go on past the ends of the legs
        const Between found = tissueAt(0.0, end * def.length);
        clip.partial = clip.partial || found.whole() || found.beyond();
    }
}

/// [N] With which a clip can be pulled off whose legs press with this force: both rub. One without friction hangs on
/// nothing that counts, but an attachment must bear something.
double slipForce(const physics::ClipDef& def, double force) { return std::max(1e-9, 2.0 * def.friction * force); }

Attachment holdOf(const physics::ApplyClip& command, AttachedPairs points)
{
    Attachment hold{command.id, command.rigid, command.target, std::move(points), {}};
    hold.stiffness = kHold;
    hold.breakForce = slipForce(command.def, command.def.closingForce);
    return hold;
}

double distanceAcross(const ClipPair& pair, const SoftState& state)
{
    return distance(meanOf(pair[0], state.x), meanOf(pair[1], state.x));
}

/// [N] with which springs of these lengths press at a gap.
double pressAt(double gap, double stiffness, const std::vector<double>& lengths)
{
    double sum = 0.0;
    for (double each : lengths) sum += stiffness * std::max(0.0, each - gap);
    return sum;
}

/// [m] The gap at which springs of these lengths press with no more than `most` [N]. `lengths` descend.
double gapFor(double most, double stiffness, const std::vector<double>& lengths)
{
    double sum = 0.0;
    for (std::size_t n = 1; n <= lengths.size(); ++n) { // if only the n longest pull
        sum += lengths[n - 1];
        const double gap = (sum - most / stiffness) / static_cast<double>(n);
        if (n == lengths.size() || gap >= lengths[n]) return gap;
    }
    return 0.0;
}

/// `lengths`: scratch.
void closeLegs(double dt, const SoftState& state, std::vector<double>& lengths, Clip& clip)
{
    lengths.clear();
    for (const ClipPair& each : clip.pairs) lengths.push_back(distanceAcross(each, state));
    std::ranges::sort(lengths, std::greater{});
    const bool closing = clip.age < clip.def.closingTime;
    clip.age = std::min(clip.age + dt, clip.def.closingTime); // a sum that goes on would never rest
    const double most = clip.def.closingForce, k = clip.pairStiffness();
    if (closing) {
        const double speed = (clip.def.opening - clip.def.gap) / clip.def.closingTime;
        clip.gap = std::max(clip.def.gap, clip.gap - dt * speed);
    }
    if (pressAt(clip.gap, k, lengths) > most) clip.gap = gapFor(most, k, lengths); // the legs yield
    clip.force = pressAt(clip.gap, k, lengths);
}

bool hasAttachment(const Scene& scene, AttachmentId id)
{
    return std::ranges::binary_search(scene.attachments, id, {}, &Attachment::id);
}

} // namespace

void applyClip(const physics::ApplyClip& command, Scene& scene, physics::StepReport& report)
{
    const auto rigid = findIn(scene.rigid, command.rigid), soft = findIn(scene.soft, command.target);
    FILASOFIA_ASSERT(rigid && soft);
    SoftBody& tissue = scene.soft[*soft];
    const Pose& pose = scene.rigid[*rigid].state.poses[static_cast<std::size_t>(command.def.element)];
    Clip clip{.id = command.id, .clip = command.rigid, .def = command.def, .pairs = {}};
    findPairs(pose, tissue, clip);
    const auto tell = [&](Change kind) {
        report.clipChanges.push_back({.kind = kind,
                                      .id = command.id,
                                      .clip = command.rigid,
                                      .tissue = command.target,
                                      .partial = kind == Change::Applied && clip.partial});
    };
    if (clip.pairs.empty()) {
        ++report.clips.missed;
        tell(Change::Missed);
        report.set(physics::StepFlag::NothingAttached);
        logWarning(describe(tissue.model),
                   clip.partial ? ": it reaches beyond the legs of clip '"
                                : ": nothing of it is between the legs of clip '",
                   scene.rigid[*rigid].model.name, clip.partial ? "' wherever it is between them" : "'");
        return;
    }
    ++report.clips.applied;
    tell(Change::Applied);
    if (clip.partial) {
        ++report.clips.partial;
        logWarning(describe(tissue.model), ": clip '", scene.rigid[*rigid].model.name,
                   "' is too small: tissue goes on beyond its legs, and may stay open there");
    }
    clip.gap = command.def.opening;
    addAttachment(holdOf(command, holdPoints(pose, tissue.state, clip)), {}, scene);
    const auto place = std::ranges::upper_bound(tissue.state.clips, clip.id, {}, &Clip::id);
    tissue.state.clips.insert(place, std::move(clip));
}

void closeClips(double dt, Scene& scene)
{
    std::vector<double> lengths;
    for (SoftBody& body : scene.soft) {
        if (body.state.clips.empty()) continue;
        std::erase_if(body.state.clips, [&](const Clip& each) { return !hasAttachment(scene, each.id); });
        if (dt > 0.0)
            for (Clip& each : body.state.clips) closeLegs(dt, body.state, lengths, each);
    }
}

void keepClips(Scene& scene, physics::StepReport& report)
{
    scene.clipReports.clear();
    for (SoftBody& body : scene.soft) {
        std::vector<Clip>& clips = body.state.clips;
        std::erase_if(clips, [&](const Clip& each) {
            if (hasAttachment(scene, each.id)) return false;
            ++report.clips.slipped;
            report.clipChanges.push_back({.kind = Change::Slipped,
                                          .id = each.id,
                                          .clip = each.clip,
                                          .tissue = body.model.id,
                                          .partial = each.partial});
            return true;
        });
        for (const Clip& each : clips) {
            Vec3 middle;
            for (const ClipPair& pair : each.pairs)
                middle += 0.5 * (meanOf(pair[0], body.state.x) + meanOf(pair[1], body.state.x));
            const bool closed = each.age >= each.def.closingTime;
            scene.clipReports.push_back({.id = each.id,
                                         .clip = each.clip,
                                         .tissue = body.model.id,
                                         .place = 1.0 / static_cast<double>(each.pairs.size()) * middle,
                                         .gap = each.gap,
                                         .force = each.force,
                                         .closed = closed,
                                         .partial = each.partial});
            if (!closed) continue; // as hard as it presses, it holds
            const auto hold = std::ranges::lower_bound(scene.attachments, each.id, {}, &Attachment::id);
            hold->breakForce = slipForce(each.def, each.force);
        }
    }
    std::ranges::sort(scene.clipReports, {}, &frame::Clip::id);
}

} // namespace filasofia::engine
