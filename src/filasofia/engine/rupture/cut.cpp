#include "filasofia/engine/rupture/cut.h"

namespace filasofia::engine {

RuptureReport BladeStroke::step(EditableMesh& mesh, std::span<const BladeSegment> blade,
                                const CutParameters& parameters)
{
    RuptureReport report;
    if (const auto refusal = refusalOf(blade, mesh.diagonal())) {
        ++report.refused[static_cast<int>(*refusal)];
        report.pending = static_cast<long>(crossings_.size());
        return report;
    }
    const std::size_t waiting = crossings_.size();
    finder_.find(mesh, blade, crossings_);
    report.crossings = static_cast<long>(crossings_.size() - waiting);
    cutCrossings(mesh, sheet_, parameters, crossings_, report);
    finder_.addEdgesOfNewNodes(mesh);
    report.pending = static_cast<long>(crossings_.size());
    return report;
}

bool BladeStroke::finish(EditableMesh& mesh, const CutParameters& parameters, RuptureReport& report)
{
    cutCrossings(mesh, sheet_, parameters, crossings_, report);
    report.pending = static_cast<long>(crossings_.size());
    if (!crossings_.empty()) return false;
    openAll(mesh, openingLimits(parameters, mesh.meanEdge()), report);
    return true;
}

} // namespace filasofia::engine
