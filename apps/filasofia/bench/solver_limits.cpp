#include "apps/filasofia/bench/solver_limits.h"

#include "filasofia/core/text.h"

#include <algorithm>
#include <cmath>

namespace filasofia::app {
namespace {

constexpr double kError = 1e-3, kTightError = 1e-5;         ///< [-] relative to the displacement
constexpr double kErrorAtLongSteps = 1e-4;                  ///< [-] the same at the longer of kSolverSteps
constexpr std::array kOverFloor{2.5, 4.0};                  ///< [-] at each of kSolverSteps
constexpr double kFloorAvx512 = 15e-9, kFloorAvx2 = 25e-9;  ///< [s] per tetrahedron
constexpr double kExponent = 1.1;                           ///< [-]
constexpr double kTwoThreads = 1.6, kDisturbed = 1.0 / 1.2; ///< [-] speed-up over one thread
constexpr int kLargeFrom = 29000;  ///< number of tetrahedra of "30000"; the true number is a little less
constexpr int kFirstForTwo = 9000; ///< number of tetrahedra of "10000"; the true number is a little less

std::string nameOf(const SolverCell& cell) { return text(cell.mesh.name, " tetrahedra, ", 1e3 * cell.dt, " ms"); }

/// The worst of many figures.
struct Worst {
    std::optional<double> value = {};
    std::string where = {};
    bool wantsHigh = false; ///< if true, the lowest value is the worst

    void add(double figure, const std::string& name)
    {
        if (value && (wantsHigh ? figure >= *value : figure <= *value)) return;
        value = figure;
        where = name;
    }
    [[nodiscard]] Verdict against(double bound, std::string limit, double unit = 1.0) const
    {
        if (!value) return {std::move(limit), {}, "not measured"};
        return {std::move(limit), wantsHigh ? *value >= bound : *value <= bound,
                text(wantsHigh ? "lowest " : "highest ", fourDigits(*value / unit), " (", where, ")")};
    }
};

Verdict judgeErrors(const std::vector<SolverCell>& cells, bool tight)
{
    Worst worst;
    for (const SolverCell& cell : cells)
        for (std::size_t h = 0; h < 2; ++h)
            worst.add(tight ? cell.errors.tight[h] : cell.errors.standard[h],
                      text(nameOf(cell), h == 0 ? ", hanging, " : ", standing, ", cell.errors.steps, " steps"));
    const double bound = tight ? kTightError : kError;
    return worst.against(bound,
                         text("error at ", tight ? text("a tolerance of ", kTightTolerance) : "the default tolerance",
                              " is at most ", bound, " of the displacement"));
}

Verdict judgeErrorsAtLongSteps(const std::vector<SolverCell>& cells)
{
    std::vector<Measured> errors;
    for (const SolverCell& cell : cells)
        for (std::size_t h = 0; h < 2; ++h)
            if (cell.dt == kSolverSteps.back())
                errors.push_back({cell.errors.standard[h], text(nameOf(cell), h == 0 ? ", hanging" : ", standing")});
    return atMost(errors, kErrorAtLongSteps,
                  text("error at the default tolerance and steps of ", 1e3 * kSolverSteps.back(), " ms is at most ",
                       kErrorAtLongSteps, " of the displacement"));
}

Verdict judgeStep(const std::vector<SolverCell>& cells, const StepLimit& limit)
{
    std::vector<Measured> steps;
    double floor = 0.0;
    for (const SolverCell& cell : cells) {
        if (cell.dt != kSolverSteps.back()) continue;
        if (cell.mesh.name == limit.mesh) steps.push_back({cell.find({1, false})->step().median, nameOf(cell)});
        if (cell.mesh.name == "3004") floor = cell.find({1, false})->floorPerElement();
    }
    return judgeSteps(steps, limit, floor);
}

Verdict judgeFloor(const std::vector<SolverCell>& cells, std::size_t d)
{
    Worst worst;
    for (const SolverCell& cell : cells)
        if (cell.mesh.judged && cell.dt == kSolverSteps[d])
            worst.add(cell.find({1, false})->overFloor().median, nameOf(cell));
    return worst.against(kOverFloor[d], text("a step of ", 1e3 * kSolverSteps[d], " ms takes one thread at most ",
                                             kOverFloor[d], " times the lower bound, up to 30000 tetrahedra"));
}

Verdict judgeReference(const std::vector<SolverCell>& cells, const std::string& mesh, double bound)
{
    Worst worst{.wantsHigh = true};
    for (const SolverCell& cell : cells)
        if (cell.mesh.name == mesh && cell.dt == kSolverSteps.back())
            worst.add(cell.overReference().median, nameOf(cell));
    return worst.against(bound, text("one thread is at least ", bound, " times as fast as the reference solver at ",
                                     mesh, " tetrahedra and 5 ms"));
}

Verdict judgeFloorPerElement(const std::vector<SolverCell>& cells, const std::string& simdTarget)
{
    const bool avx512 = simdTarget.starts_with("AVX3") || simdTarget.starts_with("AVX10"), avx2 = simdTarget == "AVX2";
    const double bound = avx512 ? kFloorAvx512 : kFloorAvx2;
    const std::string limit = text("the lower bound at 3004 tetrahedra is at most ", std::round(1e9 * bound),
                                   " ns per tetrahedron with ", avx512 ? "AVX-512" : "AVX2");
    if (!avx512 && !avx2) return {limit, {}, text("this machine has ", simdTarget)};
    Worst worst;
    for (const SolverCell& cell : cells)
        if (cell.mesh.name == "3004") worst.add(cell.find({1, false})->floorPerElement(), nameOf(cell));
    return worst.against(bound, limit, 1e-9);
}

Verdict judgeGrowth(const std::vector<SolverCell>& cells)
{
    Worst worst;
    for (const SolverCell& small : cells)
        for (const SolverCell& large : cells) {
            if (small.dt != large.dt || small.mesh.name != "3004" || large.mesh.elements() < kLargeFrom) continue;
            const double growth = large.find({1, false})->step().median / small.find({1, false})->step().median;
            worst.add(std::log(growth) / std::log(static_cast<double>(large.mesh.elements()) / small.mesh.elements()),
                      nameOf(large));
        }
    return worst.against(kExponent, text("the cost of a step grows from 3004 to 30000 and more tetrahedra no faster "
                                         "than n^",
                                         kExponent));
}

Verdict judgeTwoThreads(const std::vector<SolverCell>& cells, bool othersBusy)
{
    const Crew two{2, othersBusy};
    Worst worst{.wantsHigh = true};
    int disturbed = 0;
    for (const SolverCell& cell : cells) {
        if (!cell.find(two) || (!othersBusy && cell.mesh.elements() < kFirstForTwo)) continue;
        if (const auto quiet = cell.quietSpeedUp(two))
            worst.add(quiet->median, nameOf(cell));
        else
            ++disturbed;
    }
    Verdict verdict =
        othersBusy ? worst.against(kDisturbed, "with the other cores busy, two threads take at most 1.2 times as long "
                                               "as one (are at least 0.833 times as fast)")
                   : worst.against(kTwoThreads, text("two threads are at least ", kTwoThreads,
                                                     " times as fast as one, from 10000 tetrahedra"));
    if (disturbed > 0) verdict.measured += text("; ", disturbed, " cells were not judged because other programs ran");
    return verdict;
}

Verdict judgeStiff(const std::vector<StiffRun>& runs)
{
    Verdict verdict{.limit = "E = 1 MPa, nu = 0.49, and both together converge within the default iteration limit",
                    .measured = "not measured"};
    const StiffRun* worst = nullptr;
    for (const StiffRun& run : runs) {
        const auto rank = [](const StiffRun& r) { return std::pair(r.flags != 0, r.maxIterations); };
        if (!worst || rank(run) > rank(*worst)) worst = &run;
    }
    if (!worst) return verdict;
    verdict.met = worst->flags == 0;
    verdict.measured =
        text("most iterations ", worst->maxIterations, " (", worst->mesh, " tetrahedra, ", 1e3 * worst->dt,
             " ms, E = ", 1e-3 * worst->youngModulus, " kPa, nu = ", worst->poissonRatio, "), flags ", worst->flags);
    return verdict;
}

Verdict judgeFlags(const std::vector<SolverCell>& cells)
{
    Verdict verdict{.limit = "no step raises a flag", .met = true, .measured = "no flag was raised"};
    for (const SolverCell& cell : cells) {
        std::uint32_t flags = cell.errors.flags | cell.referenceFlags;
        for (const CrewTimes& times : cell.crews) flags |= times.flags;
        if (flags == 0 || !*verdict.met) continue;
        verdict.met = false;
        verdict.measured = text("flags ", flags, " (", nameOf(cell), ")");
    }
    return verdict;
}

} // namespace

Verdict judgeSteps(const std::vector<Measured>& steps, const StepLimit& limit, double floorPerElement)
{
    const double slowness = std::max(1.0, floorPerElement / kFloorAvx512);
    return atMost(steps, slowness * limit.seconds,
                  text("a step of ", 1e3 * kSolverSteps.back(), " ms takes one thread at most ",
                       rounded(1e3 * limit.seconds, 100), " ms at ", limit.mesh, " tetrahedra, times ",
                       rounded(slowness, 100), " for this machine's lower bound"),
                  1e-3);
}

std::vector<Verdict> judgeSolver(const std::vector<SolverCell>& cells, const std::vector<StiffRun>& stiff,
                                 const std::string& simdTarget)
{
    std::vector<Verdict> verdicts{judgeErrors(cells, false), judgeErrors(cells, true), judgeErrorsAtLongSteps(cells),
                                  judgeFloor(cells, 0), judgeFloor(cells, 1)};
    for (const StepLimit& limit : kStepLimits) verdicts.push_back(judgeStep(cells, limit));
    for (Verdict& each : std::vector<Verdict>{judgeReference(cells, "3004", 8.0), judgeReference(cells, "10000", 12.0),
                                              judgeFloorPerElement(cells, simdTarget), judgeGrowth(cells),
                                              judgeTwoThreads(cells, false), judgeTwoThreads(cells, true),
                                              judgeStiff(stiff), judgeFlags(cells)})
        verdicts.push_back(std::move(each));
    return verdicts;
}

} // namespace filasofia::app
