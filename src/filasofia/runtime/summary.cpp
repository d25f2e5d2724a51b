#include "filasofia/runtime/run.h"

#include "filasofia/core/text.h"
#include "filasofia/core/word.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace filasofia::runtime {
namespace {

std::string formatted(const char* format, auto... values)
{
    char buffer[200];
    std::snprintf(buffer, sizeof buffer, format, values...);
    return buffer;
}

std::string line(const char* format, auto... values) { return formatted(format, values...) + "\n"; }

std::string steps(std::uint64_t count) { return text(count, count == 1 ? " step" : " steps"); }

constexpr std::size_t kMaxPairs = 12; ///< rows of the table

/// What the table of contacts leaves out: forces of solves that did not end at their tolerance.
std::string unsolvedLine(const std::vector<ContactPairReport>& pairs)
{
    const auto worst = std::ranges::max_element(pairs, {}, &ContactPairReport::maxUnsolvedForce);
    const auto most = std::ranges::max_element(pairs, {}, &ContactPairReport::unsolved);
    if (most == pairs.end() || most->unsolved == 0) return {};
    return text("not in these forces: up to ", steps(most->unsolved),
                " per pair in which a solver stopped short of its tolerance; the largest force there was ",
                line("%.4g N, between '%s' and '%s'", worst->maxUnsolvedForce, shortened(worst->first).c_str(),
                     shortened(worst->second).c_str()));
}

/// A table of who touched whom and how hard; empty if nothing touched.
std::string contactTable(const std::vector<ContactPairReport>& all)
{
    if (all.empty()) return {};
    std::vector<ContactPairReport> pairs = all;
    const std::size_t left = pairs.size() - std::min(pairs.size(), kMaxPairs);
    std::ranges::stable_sort(pairs, std::greater{}, &ContactPairReport::maxNormalForce);
    pairs.resize(pairs.size() - left);
    const std::string title = "contacts between";
    std::size_t width = title.size();
    std::vector<std::string> names;
    for (const ContactPairReport& pair : pairs) {
        names.push_back(oneLine(shortened(pair.first) + ", " + shortened(pair.second)));
        width = std::max(width, names.back().size());
    }
    const auto padded = [width](const std::string& name) {
        return name + std::string(width - std::min(width, name.size()), ' ');
    };
    std::string out = padded("") + "             normal force [N]        friction [N]    deepest\n";
    out += padded(title) + "    steps      mean       max      mean       max       [mm]\n";
    for (std::size_t i = 0; i < pairs.size(); ++i)
        out += padded(names[i]) + line("%9llu %9.4f %9.4f %9.4f %9.4f  %9.4f",
                                       static_cast<unsigned long long>(pairs[i].steps), pairs[i].meanNormalForce,
                                       pairs[i].maxNormalForce, pairs[i].meanFrictionForce, pairs[i].maxFrictionForce,
                                       pairs[i].deepest * 1e3);
    if (left > 0) out += text("and ", left, left == 1 ? " pair" : " pairs", " with smaller forces\n");
    return out + unsolvedLine(all);
}

std::string millimetres(Vec3 place)
{
    const Vec3 at = 1e3 * place;
    return formatted("(%.1f %.1f %.1f) mm", at.x, at.y, at.z);
}

/// A state that is not finite means that something was asked of the body that numbers cannot hold.
std::string undoneLine(const RunReport& report)
{
    std::string out = text("a new state was not finite and was rolled back in ", steps(report.undone));
    if (!report.undoneBody.empty()) out += text(", first of '", report.undoneBody, "'");
    if (report.damped > 0) out += text("; in ", report.damped, " of them it advanced again with damping");
    return out;
}

/// Elements inside out mean that something was asked of the tissue that it cannot do.
std::string invertedLine(const RunReport& report)
{
    const physics::InvertedElements& worst = report.worstInverted;
    return text("elements inside out in ", steps(report.inverted), ", at most ", worst.count,
                " at once; then the worst was in '", report.worstInvertedBody, "' at ", millimetres(worst.place));
}

const char* reasonOf(physics::IntersectionCause cause)
{
    switch (cause) {
    case physics::IntersectionCause::Start:
        return "they began so";
    case physics::IntersectionCause::Told:
        return "one was told to be there";
    case physics::IntersectionCause::Own:
        return "it does not collide with itself";
    case physics::IntersectionCause::Lost:
        break;
    }
    return "contacts did not hold them apart";
}

/// Surfaces that pass through each other mean that contact has lost them.
std::string intersectionLine(const RunReport& report)
{
    const physics::Intersection& deepest = report.deepestIntersection;
    const auto& [first, second] = report.deepestBodies;
    const std::string who = deepest.first == deepest.second
                                ? text("the surface of '", first, "' through itself")
                                : text("'", first, "' and '", second, "' through each other");
    return text("surfaces pass through each other in ", steps(report.intersecting), ": ", who, " by ",
                std::round(1e5 * deepest.depth) / 100.0, " mm (", reasonOf(deepest.cause), ", ",
                std::round(100.0 * deepest.force) / 100.0, " N) at ", millimetres(deepest.place));
}

/// Beyond the range in which its constants were measured, tissue is a guess.
std::string strainedLine(const RunReport& report)
{
    const physics::StrainedElements& worst = report.worstStrained;
    return text("tissue beyond the range of its material in ", steps(report.beyondStrain), ": strain ",
                std::round(1000.0 * worst.strain) / 1000.0, " in '", report.worstStrainedBody, "', valid up to ",
                std::round(1000.0 * worst.valid) / 1000.0, ", at ", millimetres(worst.place));
}

/// Something that never rests, or moves by energy from nowhere, is an error of the simulation or a body without
/// damping.
std::string unrestLine(const RunReport& report)
{
    const physics::Unrest& worst = report.worstUnrest;
    std::string out = text("not at rest in ", steps(report.restless), ": '", report.worstUnrestBody, "' moved at ",
                           std::round(1e4 * worst.speed) / 10.0, " mm/s, ", std::round(10.0 * worst.undriven) / 10.0,
                           " s after anything drove it");
    if (report.energyGained > 0) out += text("; energy from nowhere in ", report.energyGained, " of them");
    return out;
}

/// [mm^2], with two digits where a tenth would hide it: a thread's section.
std::string area(double squareMetres)
{
    const double shown = 1e6 * squareMetres;
    char words[32];
    std::snprintf(words, sizeof words, shown == 0.0 || shown >= 0.1 ? "%.1f" : "%.2g", shown);
    return words;
}

std::string openedLine(const OpenedSurfaces& opened)
{
    const std::string cavities = opened.cavities > 0 ? text("; cavities opened: ", opened.cavities) : std::string();
    return line("'%s': cut %s mm^2, torn %s mm^2, in %llu %s; pieces that came off: %llu%s",
                oneLine(shortened(opened.body)).c_str(), area(opened.cut).c_str(), area(opened.torn).c_str(),
                static_cast<unsigned long long>(opened.steps), opened.steps == 1 ? "step" : "steps",
                static_cast<unsigned long long>(opened.pieces), cavities.c_str());
}

/// A blade that has no path through the tissue, or is off, has cut nothing where it went.
std::string refusedLine(const RefusedBlades& refused)
{
    std::string out = text("blades that cut nothing in ", steps(refused.steps));
    if (refused.jumped > 0) out += text(", jumped in ", refused.jumped);
    if (refused.off > 0) out += text(", switched off and pushed on into tissue in ", refused.off);
    return out;
}

/// What is cut through and held by nothing falls out of the scene.
std::string lostLine(const LostPiecesReport& lost)
{
    return formatted("lost by '%s': %llu %s, %.3g g (%.3g %% of it), fallen farther than 10 m and removed",
                     oneLine(shortened(lost.body)).c_str(), static_cast<unsigned long long>(lost.pieces),
                     lost.pieces == 1 ? "piece" : "pieces", lost.mass * 1e3, lost.share * 100.0);
}

std::string bloodLine(const BloodReport& report)
{
    const surface::BloodBalance& b = report.balance;
    return line("blood of '%s': %.2f ml lost, %.2f ml on it, %.2f ml sucked, %.2f ml rinsed, %.2f ml dripped%s",
                oneLine(shortened(report.body)).c_str(), b.welled * 1e6, b.onTissue * 1e6, b.sucked * 1e6,
                b.rinsed * 1e6, b.dripped * 1e6,
                b.carriedOff > 0.0 ? text(", ", b.carriedOff * 1e6, " ml left with pieces").c_str() : "");
}

std::string heatLine(const HeatReport& report)
{
    const surface::HeatBalance& b = report.balance;
    return line("heat of '%s': %.0f J, hottest %.0f C, burnt %.1f mm^2%s, charred %.1f mm^2",
                oneLine(shortened(report.body)).c_str(), b.delivered, b.peak - 273.15, b.burnt * 1e6,
                !report.target && b.burnt > 0.0 ? " (an injury: it is no target)" : "", b.charred * 1e6);
}

std::string energyLine(const EnergyReport& report)
{
    const surface::EnergyBalance& b = report.balance;
    return line("energy of '%s' (%s): %.0f J in %.2f s of activation, %.2f s of them in air",
                oneLine(shortened(report.body)).c_str(),
                std::string(names(&report.mode)[static_cast<std::size_t>(report.mode)]).c_str(), b.delivered, b.active,
                b.inAir);
}

std::string smokeLine(const surface::SmokeBalance& balance)
{
    const surface::AerosolBalance& b = balance.smoke;
    return line("smoke: %.3g mg given off, %.3g mg in the air, %.3g mg sucked away, %.3g mg vented, %.3g mg settled",
                b.emitted * 1e6, b.inAir * 1e6, b.extracted * 1e6, b.vented * 1e6, b.settled * 1e6);
}

std::string distensionLine(const surface::DistensionBalance& b)
{
    return line(
        "distension: %.1f ml in, %.1f ml out, %.1f ml lost, deficit %.1f ml%s, %.2f ml of blood, %.1f %% of it now",
        b.in * 1e6, b.out * 1e6, b.lost * 1e6, surface::deficit(b) * 1e6, b.beyondLimit ? " (too high)" : "",
        b.bled * 1e6, 100.0 * surface::bloodShare(b));
}

std::string clipsLine(const physics::ClipReport& clips)
{
    std::string out = text("clips closed on tissue: ", clips.applied);
    if (clips.partial > 0) out += text(" (", clips.partial, " too small: tissue goes on beyond the legs)");
    if (clips.missed > 0) out += text(", on nothing: ", clips.missed);
    if (clips.slipped > 0) out += text(", pulled off: ", clips.slipped);
    return out + "\n";
}

std::string ductLine(const DuctReport& report)
{
    const surface::DuctBalance& b = report.balance;
    const std::string state(names(&b.state)[static_cast<std::size_t>(b.state)]);
    const std::string clips = isWhole(b.state) ? text(b.clipsBefore) : text(b.clipsBefore, " + ", b.clipsAfter);
    return line("duct '%s' of '%s': %s; clips %s, flow %.3g ml/s, leak %.3g ml/s, lost %.2f ml",
                oneLine(shortened(report.duct)).c_str(), oneLine(shortened(report.body)).c_str(), state.c_str(),
                clips.c_str(), b.flow * 1e6, b.leak * 1e6, b.lost * 1e6);
}

/// What went wrong and is more than a number.
std::vector<std::string> problemsOf(const RunReport& report)
{
    std::vector<std::string> out;
    if (report.undone > 0) out.push_back(undoneLine(report));
    if (report.inverted > 0) out.push_back(invertedLine(report));
    if (report.intersecting > 0) out.push_back(intersectionLine(report));
    if (report.beyondStrain > 0) out.push_back(strainedLine(report));
    if (report.restless > 0) out.push_back(unrestLine(report));
    for (const LostPiecesReport& lost : report.lost) out.push_back(lostLine(lost));
    if (report.refused.steps > 0) out.push_back(refusedLine(report.refused));
    if (report.refused.inVain > 0)
        out.push_back(text("strokes of blades that opened nothing: ", report.refused.inVain));
    if (report.refused.noPiece > 0) out.push_back(text("pieces that could not be removed: ", report.refused.noPiece));
    if (report.nothingChanged > 0)
        out.push_back(text("a change of tissue (SetTissue) found no element in ", steps(report.nothingChanged)));
    out.insert(out.end(), report.nothingHeld.begin(), report.nothingHeld.end());
    out.insert(out.end(), report.bluntBlades.begin(), report.bluntBlades.end());
    return out;
}

} // namespace

std::vector<std::string> warnings(const RunReport& report)
{
    std::vector<std::string> out = problemsOf(report);
    if (report.notConverged > 0)
        out.push_back(text("a solver stopped at its iteration limit, or left apart what is tied, in ",
                           steps(report.notConverged)));
    if (report.outOfTime > 0) out.push_back(text("a solver stopped at the deadline in ", steps(report.outOfTime)));
    return out;
}

double RunReport::cutArea() const
{
    double sum = 0.0;
    for (const OpenedSurfaces& each : opened) sum += each.cut;
    return sum;
}

double RunReport::tornArea() const
{
    double sum = 0.0;
    for (const OpenedSurfaces& each : opened) sum += each.torn;
    return sum;
}

std::string summary(const RunReport& report)
{
    const Spread cost = report.timing.cost(), rate = report.timing.rate();
    std::string out = line("%llu %s, %.3f s simulated in %.3f s (%.2f x real time); ended: %s",
                           static_cast<unsigned long long>(report.timing.stepCount),
                           report.timing.stepCount == 1 ? "step" : "steps", report.timing.simulatedSeconds,
                           report.timing.wallSeconds, report.timing.realTimeFactor(), report.finished.c_str());
    if (!report.timing.steps.empty()) { // a stepped run keeps none: it may be one of hundreds
        out += line("one step takes [ms]    median %8.3f   p1 %8.3f   p99 %8.3f", cost.median * 1e3, cost.p1 * 1e3,
                    cost.p99 * 1e3);
        out += line("physics rate [1/s]     median %8.1f   p1 %8.1f   p99 %8.1f", rate.median, rate.p1, rate.p99);
    }
    const std::string again = report.damped > 0 ? text(" (", report.damped, " advanced again with damping)") : "";
    const std::string behind = report.timing.clamped > 0
                                   ? text(" (slower than real time for at most ", report.timing.longestBehind, " s)")
                                   : "";
    out += text("late steps ", report.timing.late, ", clamped to period + slack ", report.timing.clamped, behind,
                ", rolled back ", report.undone, again, ", solver at its iteration limit ", report.notConverged,
                ", at the deadline ", report.outOfTime, "\n");
    if (report.undoneAtEnd > 0)
        out += text("physics failed: in the last ", steps(report.undoneAtEnd),
                    " of the run a body had no finite state and was rolled back\n");
    for (const std::string& problem : problemsOf(report)) out += problem + "\n";
    for (const OpenedSurfaces& opened : report.opened) out += openedLine(opened);
    out += contactTable(report.contacts);
    for (const BloodReport& blood : report.blood) out += bloodLine(blood);
    for (const HeatReport& heat : report.heat) out += heatLine(heat);
    for (const EnergyReport& energy : report.energy) out += energyLine(energy);
    if (report.smoke) out += smokeLine(*report.smoke);
    if (report.distension) out += distensionLine(*report.distension);
    if (report.clips.applied + report.clips.missed > 0) out += clipsLine(report.clips);
    for (const DuctReport& duct : report.ducts) out += ductLine(duct);
    for (const std::string& broke : report.broke) out += broke + "\n";
    if (report.visual.framesDrawn > 0 && report.timing.wallSeconds > 0.0)
        out += line("pictures drawn %ld", report.visual.framesDrawn);
    for (const std::string& picture : report.pictures) out += "wrote " + picture + "\n";
    for (const std::string& problem : report.callbackProblems) out += "a script ended early: " + problem + "\n";
    for (const std::string& problem : report.fileProblems) out += "incomplete: " + problem + "\n";
    out += line("state hash %016llx", static_cast<unsigned long long>(report.hash));
    return out;
}

} // namespace filasofia::runtime
