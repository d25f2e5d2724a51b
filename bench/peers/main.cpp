#include "bench/peers/compare.h"
#include "bench/peers/options.h"
#include "bench/peers/report.h"
#include "filasofia/core/error.h"

#include <nlohmann/json.hpp>

#include <cstdio>
#include <fstream>

namespace filasofia::peers {
namespace {

/// Opened before the minutes of measuring, so that a wrong name is reported at once.
std::ofstream open(const std::string& file)
{
    std::ofstream out;
    if (file.empty()) return out;
    out.open(file);
    if (!out) fail("--json: ", file, " cannot be written");
    return out;
}

void measure(const Options& options)
{
    std::ofstream out = open(options.json);
    printHeading();
    std::vector<Cell> cells;
    std::vector<RestCell> rests;
    for (int tets : options.tets)
        for (double dt : options.dt) {
            cells.push_back(compare(tets, dt, options.steps));
            print(cells.back());
        }
    for (int tets : options.tets) rests.push_back(compareRest(tets));
    print(rests);
    if (!out.is_open()) return;
    out << toJson(cells, rests, options.steps).dump(1) << '\n';
    if (!out.flush()) fail("--json: ", options.json, " cannot be written (disk full?)");
}

} // namespace
} // namespace filasofia::peers

int main(int argc, char** argv)
{
    using namespace filasofia;
    try {
        if (const std::optional<peers::Options> options = peers::readOptions(argc, argv)) peers::measure(*options);
        return 0;
    } catch (const std::exception& error) {
        std::fprintf(stderr, "filasofia_peers: %s\n", error.what());
        return 2;
    }
}
