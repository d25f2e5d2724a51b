#include "apps/filasofia/bench/contact_limits.h"

#include "filasofia/core/text.h"

#include <algorithm>
#include <cmath>
#include <functional>

namespace filasofia::app {
namespace {

using Figure = std::function<double(const ContactCell&)>;
using Which = std::function<bool(const ContactCell&)>;

double shown(double value, double digits = 3.0) // rounds to `digits` significant digits
{
    const double unit = std::pow(10.0, digits - 1.0 - std::floor(std::log10(std::max(std::abs(value), 1e-300))));
    return std::round(value * unit) / unit;
}

/// A bound on a figure of some cells.
struct Limit {
    Which which; ///< selects the cells
    Figure figure;
    double bound;
    std::string text;      ///< the limit as a sentence
    std::string unit = {}; ///< with a space before it
    bool isLower = false;  ///< the figure must be at least, not at most, the bound
};

/// Compares the worst figure of the selected cells with the bound.
Verdict judge(const std::vector<ContactCell>& cells, const Limit& limit)
{
    const auto worse = [&](const ContactCell& a, const ContactCell& b) {
        return limit.isLower ? limit.figure(a) < limit.figure(b) : limit.figure(a) > limit.figure(b);
    };
    const ContactCell* worst = nullptr;
    for (const ContactCell& cell : cells)
        if (limit.which(cell) && (!worst || worse(cell, *worst))) worst = &cell;
    if (!worst) return {limit.text, {}, "not measured"};
    const double value = limit.figure(*worst);
    return {limit.text, limit.isLower ? value >= limit.bound : value <= limit.bound,
            text(limit.isLower ? "lowest " : "highest ", shown(value), limit.unit, " (", worst->label(), ")")};
}

double medianMs(const ContactCell& cell) { return 1e3 * cell.alone().step().median; }
double p99Ms(const ContactCell& cell) { return 1e3 * cell.alone().step().p99; }
double found(const ContactCell& cell) { return runtime::spreadOf(cell.found).median; }
double pushing(const ContactCell& cell) { return runtime::spreadOf(cell.pushing).median; }

bool scraped(const ContactCell& cell) { return cell.scene.name.starts_with("scraped"); }
bool slow(const ContactCell& cell) { return cell.scene.name == "scraped at 0.1 m/s"; }
bool tied(const ContactCell& cell) { return cell.scene.name.starts_with("tied"); }
double overCompared(const ContactCell& cell) { return cell.overFree().median; }
bool plate(const ContactCell& cell) { return cell.scene.name.starts_with("plate"); }

Verdict judgeFlags(const std::vector<ContactCell>& cells)
{
    Verdict verdict{.limit = "no step raises a flag", .met = true, .measured = "no flag was raised"};
    for (const ContactCell& cell : cells)
        for (const ContactTimes& run : cell.runs) {
            if (run.flags == 0 || !*verdict.met) continue;
            verdict.met = false;
            verdict.measured = text("flags ", run.flags, ", in ", run.flagged, " of ", run.steps.size(),
                                    " counted steps (", cell.label(), ")");
        }
    return verdict;
}

} // namespace

std::vector<Verdict> judgeContact(const std::vector<ContactCell>& cells)
{
    const auto bunny = [](const std::string& tets) {
        return [tets](const ContactCell& cell) { return scraped(cell) && cell.scene.body == "bunny " + tets; };
    };
    const auto of = [](const std::string& body) {
        return [body](const ContactCell& cell) { return cell.scene.body == body; };
    };
    const auto thousand = [](const ContactCell& cell) { return plate(cell) && cell.scene.asked == 1000; };
    const Limit limits[] = {
        {slow, found, 60, "the median number of contacts is at least 60 while the bunny is scraped at 0.1 m/s", "",
         true},
        {tied, overCompared, 1.3, "three tied blocks: at most 1.3 times the step of one block of their tissues",
         " times"},
        {of("grip"), overCompared, 1.5, "a grip at rest: at most 1.5 times the step of the organ alone", " times"},
        {bunny("3004"), medianMs, 0.15, "3004 tetrahedra, scraped: median at most 0.15 ms, one thread", " ms"},
        {bunny("3004"), p99Ms, 0.5, "3004 tetrahedra, scraped: p99 at most 0.5 ms", " ms"},
        {bunny("10000"), medianMs, 0.45, "10000 tetrahedra, scraped: median at most 0.45 ms", " ms"},
        {bunny("10000"), p99Ms, 2.0, "10000 tetrahedra, scraped: p99 at most 2 ms", " ms"},
        {thousand, pushing, 1000, "the median number of pushing contacts under the largest plate is at least 1000", "",
         true},
        {thousand, medianMs, 3.5, "1000 contacts on 30000 tetrahedra: median at most 3.5 ms", " ms"},
        {thousand, overCompared, 1.5, "1000 contacts on 30000 tetrahedra: at most 1.5 times the contact-free step",
         " times"},
        {of("64 boxes"), medianMs, 1.0, "64 rigid boxes at rest: median at most 1 ms", " ms"},
        {of("heap"), medianMs, 5.0, "50 soft blocks of 480 tetrahedra in a heap: median at most the step of 5 ms",
         " ms"}};
    std::vector<Verdict> verdicts;
    for (const Limit& limit : limits) verdicts.push_back(judge(cells, limit));
    verdicts.push_back(judgeFlags(cells));
    return verdicts;
}

} // namespace filasofia::app
