#include "bench/peers/report.h"

#include "bench/peers/bullet_bunny.h"

#include <nlohmann/json.hpp>

#include <cmath>
#include <cstdio>
#include <string>

namespace filasofia::peers {
namespace {

using nlohmann::json;

const char* nameOf(Equations equations)
{
    if (equations == Equations::Ours) return "ours";
    return equations == Equations::OursInBullet ? "bullet, our equations" : "bullet";
}

/// "1.2e-03"; "-" if there is no value, "diverged" if it is not finite.
std::string error(const std::optional<double>& value)
{
    if (!value) return "-";
    if (!std::isfinite(*value) || *value > 1e3) return "diverged";
    char word[32];
    std::snprintf(word, sizeof word, "%.1e", *value);
    return word;
}

json orNull(const std::optional<double>& value) { return value && std::isfinite(*value) ? json(*value) : json(); }

json toJson(const Cell& cell)
{
    json rows = json::array(), verdicts = json::array();
    for (const Row& row : cell.rows)
        rows.push_back({{"engine", nameOf(row.equations)},
                        {"setting", row.name},
                        {"median_s", row.median},
                        {"p99_s", row.p99},
                        {"iterations", row.iterations},
                        {"unsolved", row.unsolved},
                        {"error", orNull(row.error)},
                        {"solver_error", orNull(row.solverError)}});
    for (const Verdict& verdict : cell.verdicts)
        verdicts.push_back(
            {{"question", verdict.question}, {"ratio", orNull(verdict.ratio)}, {"words", verdict.words}});
    return {{"tets", cell.tets}, {"dt_s", cell.dt}, {"rows", rows}, {"verdicts", verdicts}};
}

} // namespace

void printHeading()
{
    std::printf(
        "Bullet %.2f in %s precision, ours at its defaults; one thread each. Errors: distance from our model solved "
        "to\n"
        "1e-12 in double precision, relative to the bunny's motion; 'solver': distance from Bullet's own equations "
        "solved to "
        "convergence.\n",
        bulletVersion(), bulletPrecision());
}

void print(const Cell& cell)
{
    std::printf("\n%d tetrahedra, steps of %g ms\n%-22s %-34s %9s %9s %7s %9s %9s\n", cell.tets, cell.dt * 1e3,
                "engine", "setting", "step ms", "p99 ms", "iter", "error", "solver");
    for (const Row& row : cell.rows) {
        std::printf("%-22s %-34s %9.3f %9.3f %7.1f %9s %9s", nameOf(row.equations), row.name.c_str(), row.median * 1e3,
                    row.p99 * 1e3, row.iterations, error(row.error).c_str(), error(row.solverError).c_str());
        if (row.unsolved > 0) std::printf("  %d steps stopped at the iteration limit", row.unsolved);
        std::printf("\n");
    }
    for (const Verdict& verdict : cell.verdicts)
        std::printf("%s: %s\n", verdict.question.c_str(), verdict.words.c_str());
    std::fflush(stdout);
}

void print(const std::vector<RestCell>& rests)
{
    std::printf("\nat rest (error relative to ours by Cholesky)\n%6s %10s %10s %24s\n", "tets", "ours", "bullet",
                "bullet, our equations");
    for (const RestCell& rest : rests)
        std::printf("%6d %10s %10s %24s\n", rest.tets, error(rest.ours).c_str(), error(rest.bullet).c_str(),
                    error(rest.bulletOurRotations).c_str());
}

json toJson(const std::vector<Cell>& cells, const std::vector<RestCell>& rests, int steps)
{
    json all = {{"bench", "peers"},
                {"bullet_precision", bulletPrecision()},
                {"bullet_version", bulletVersion()},
                {"steps", steps},
                {"cells", json::array()},
                {"rest", json::array()}};
    for (const Cell& cell : cells) all["cells"].push_back(toJson(cell));
    for (const RestCell& rest : rests)
        all["rest"].push_back({{"tets", rest.tets},
                               {"ours", orNull(rest.ours)},
                               {"bullet", orNull(rest.bullet)},
                               {"bullet_our_rotations", orNull(rest.bulletOurRotations)}});
    return all;
}

} // namespace filasofia::peers
