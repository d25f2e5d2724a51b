#include "apps/filasofia/bench/bunny_limits.h"

#include "filasofia/core/text.h"

#include <algorithm>
#include <map>
#include <set>

namespace filasofia::app {
namespace {

constexpr double kLowestRate = 196.0;  ///< [1/s] 2 % below the requested 200
constexpr double kRateSpread = 0.02;   ///< [-] spread of a paced median rate over the levels
constexpr double kCostSpread = 0.05;   ///< [-] spread of a free-running median cost over the levels
constexpr double kRealTimeCost = 5e-3; ///< [s] simulated time of one step

std::string nameOf(const CellResult& cell)
{
    return text(cell.tets, " tetrahedra, level ", cell.subdivision, ", ", cell.picture);
}

Verdict judgeRate(const std::vector<CellResult>& cells)
{
    Verdict verdict{.limit = text("every paced cell's median rate is at least ", kLowestRate, "/s"),
                    .met = {},
                    .measured = "no paced cell was measured"};
    const CellResult* worst = nullptr;
    for (const CellResult& cell : cells)
        if (!cell.freeRunning && (!worst || cell.rate.median < worst->rate.median)) worst = &cell;
    if (!worst) return verdict;
    verdict.met = worst->rate.median >= kLowestRate;
    verdict.measured = text("lowest ", rounded(worst->rate.median, 10), "/s (", nameOf(*worst), ")");
    return verdict;
}

/// Compares the medians of cells that differ only in their level: (highest - lowest) / lowest.
Verdict judgeLevels(const std::vector<CellResult>& cells, bool freeRunning, double bound, std::string limit)
{
    std::map<std::string, std::vector<double>> groups;
    for (const CellResult& cell : cells)
        if (cell.freeRunning == freeRunning)
            groups[text(cell.tets, " tetrahedra, ", cell.picture)].push_back(freeRunning ? cell.cost.median
                                                                                         : cell.rate.median);
    Verdict verdict{.limit = std::move(limit), .met = {}, .measured = "no mesh was measured at two levels"};
    double worst = -1.0;
    for (const auto& [name, medians] : groups) {
        const auto [low, high] = std::minmax_element(medians.begin(), medians.end());
        if (medians.size() < 2 || !(*low > 0.0) || *high / *low - 1.0 <= worst) continue;
        worst = *high / *low - 1.0;
        verdict.met = worst <= bound;
        verdict.measured = text("widest ", rounded(100.0 * worst, 100), " % (", name, ")");
    }
    return verdict;
}

} // namespace

std::vector<Verdict> judgeBunny(const std::vector<CellResult>& cells)
{
    return {
        judgeRate(cells),
        judgeLevels(cells, false, kRateSpread,
                    text("median rates within ", 100 * kRateSpread, " % over the levels of each mesh and picture")),
        judgeLevels(cells, true, kCostSpread,
                    text("free-running median costs within ", 100 * kCostSpread, " % over the levels of each mesh"))};
}

std::vector<int> slowerThanRealTime(const std::vector<CellResult>& cells)
{
    std::set<int> sizes;
    for (const CellResult& cell : cells)
        if (cell.freeRunning && cell.cost.median > kRealTimeCost) sizes.insert(cell.tets);
    return {sizes.begin(), sizes.end()};
}

} // namespace filasofia::app
