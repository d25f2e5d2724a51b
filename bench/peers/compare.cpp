#include "bench/peers/compare.h"

#include "bench/peers/bullet_bunny.h"
#include "bench/peers/our_bunny.h"
#include "filasofia/core/text.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>

namespace filasofia::peers {
namespace {

struct Setting {
    Equations equations;
    std::string name;
    BulletSetting def;
};

const physics::ConjugateGradient kReference{.maxIterations = 100000, .tolerance = 1e-12, .assembled = true};

/// The tightest tolerance that Bullet's precision allows.
double converged() { return std::strcmp(bulletPrecision(), "single") == 0 ? 1e-14 : 1e-22; }

/// Each setting with the preconditioner that Bullet leaves empty, and with the filled one, at several tolerances.
std::vector<Setting> bulletSettings()
{
    std::vector<Setting> all;
    for (Equations equations : {Equations::OursInBullet, Equations::Bullets}) {
        const bool ours = equations == Equations::OursInBullet;
        for (bool filled : {false, true})
            for (const char* tolerance : {"", "1e-6", "1e-5", "1e-4", "1e-3"}) {
                const std::string asked = *tolerance ? text(", tolerance ", tolerance) : "";
                all.push_back({equations,
                               (filled ? "filled" : "as in its examples") + asked,
                               {.massPreconditioner = filled,
                                .rotationsOfStepStart = ours,
                                .tolerance = *tolerance ? std::stod(tolerance) : 0.0}});
            }
        if (!ours) {
            all.push_back(
                {equations, "filled, 5 Newton iterations", {.massPreconditioner = true, .newtonIterations = 5}});
            all.push_back(
                {equations, "filled, explicit elasticity", {.implicitElasticity = false, .massPreconditioner = true}});
        }
        all.push_back({equations,
                       "converged",
                       {.massPreconditioner = true,
                        .rotationsOfStepStart = ours,
                        .tolerance = converged(),
                        .maxIterations = 5000}});
    }
    return all;
}

Row summary(Equations equations, const std::string& name, const Run& run, const std::vector<Vec3>& exact,
            const Problem& problem)
{
    std::vector<double> sorted = run.seconds;
    std::sort(sorted.begin(), sorted.end());
    const auto rank = [&](double part) { // nearest rank
        return sorted[static_cast<std::size_t>(std::ceil(part * static_cast<double>(sorted.size()))) - 1];
    };
    return {.equations = equations,
            .name = name,
            .median = rank(0.5),
            .p99 = rank(0.99),
            .iterations = run.iterations,
            .unsolved = run.unsolved,
            .error = relativeError(run.positions, exact, problem)};
}

/// Whether a setting makes one linear solve of the implicit equations per step: the equations that "converged" solves
/// to the end.
bool sameEquations(const BulletSetting& def) { return def.implicitElasticity && def.newtonIterations == 0; }

std::string number(const char* format, double value)
{
    char word[32];
    std::snprintf(word, sizeof word, format, value);
    return word;
}

/// The error used for a verdict.
using ErrorOf = double (*)(const Row&);
double errorOf(const Row& row) { return row.error; }
double solverErrorOf(const Row& row) { return row.equations == Equations::Ours ? row.error : *row.solverError; }

Verdict judgeOne(std::string question, const Row& ours, const std::vector<const Row*>& bullets, ErrorOf of)
{
    Verdict verdict{.question = std::move(question)};
    const Row* fastest = nullptr; // among those at least as accurate as ours
    const Row* nearest = nullptr;
    for (const Row* row : bullets) {
        if (!std::isfinite(of(*row))) continue;
        if (of(*row) <= of(ours) && (!fastest || row->median < fastest->median)) fastest = row;
        if (!nearest || of(*row) < of(*nearest)) nearest = row;
    }
    const Row* shown = fastest ? fastest : nearest;
    if (!shown) {
        verdict.words = "no ratio: no setting of Bullet stayed finite";
        return verdict;
    }
    if (fastest) verdict.ratio = fastest->median / ours.median;
    verdict.words =
        text(fastest ? "ratio " + number("%.1f", *verdict.ratio) : "no ratio", ": Bullet (", shown->name, ") error ",
             number("%.1e", of(*shown)), " in ", number("%.3f", shown->median * 1e3), " ms, ours error ",
             number("%.1e", of(ours)), " in ", number("%.3f", ours.median * 1e3), " ms");
    return verdict;
}

} // namespace

std::vector<Verdict> judge(const std::vector<Row>& rows)
{
    const Row& ours = rows.front();
    std::vector<const Row*> ourEquations, bulletEquations, bulletSolver;
    for (const Row& row : rows) {
        if (row.equations == Equations::OursInBullet) ourEquations.push_back(&row);
        if (row.equations == Equations::Bullets) bulletEquations.push_back(&row);
        if (row.solverError) bulletSolver.push_back(&row);
    }
    return {judgeOne("the same equations", ours, ourEquations, errorOf),
            judgeOne("Bullet's own equations", ours, bulletEquations, errorOf),
            judgeOne("each against its own equations converged", ours, bulletSolver, solverErrorOf)};
}

Cell compare(int tets, double dt, int steps)
{
    Problem problem = hangingBunny(tets);
    problem.dt = dt;
    problem.steps = steps;
    Cell cell{.tets = tets, .dt = dt};
    const std::vector<Vec3> exact = runOurs(problem, kReference).positions;
    const auto measureOurs = [&](const char* name, const physics::Solver& solver) {
        cell.rows.push_back(summary(Equations::Ours, name, runOurs(problem, solver), exact, problem));
    };
    measureOurs("default", physics::ConjugateGradient{});
    measureOurs("tolerance 1e-4", physics::ConjugateGradient{.tolerance = 1e-4});

    // The last of Bullet's settings is the converged one: the exact solution for the others with the same equations.
    std::vector<std::pair<std::size_t, std::vector<Vec3>>> sameAsLast;
    for (const Setting& setting : bulletSettings()) {
        Run run = runBullet(problem, setting.def);
        cell.rows.push_back(summary(setting.equations, setting.name, run, exact, problem));
        if (setting.equations == Equations::Bullets && sameEquations(setting.def))
            sameAsLast.emplace_back(cell.rows.size() - 1, std::move(run.positions));
    }
    const std::vector<Vec3> bulletExact = std::move(sameAsLast.back().second);
    sameAsLast.pop_back();
    for (const auto& [row, positions] : sameAsLast)
        cell.rows[row].solverError = relativeError(positions, bulletExact, problem);
    cell.verdicts = judge(cell.rows);
    return cell;
}

RestCell compareRest(int tets)
{
    const Problem problem = restingBunny(hangingBunny(tets));
    const std::vector<Vec3> exact = runOurs(problem, physics::Cholesky{}).positions;
    const auto error = [&](const Run& run) { return relativeError(run.positions, exact, problem); };
    return {.tets = tets,
            .ours = error(runOurs(problem, physics::ConjugateGradient{})),
            .bullet = error(runBullet(problem, {.massPreconditioner = true})),
            .bulletOurRotations =
                error(runBullet(problem, {.massPreconditioner = true, .rotationsOfStepStart = true}))};
}

} // namespace filasofia::peers
