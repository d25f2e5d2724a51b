#include "filasofia/testing/fuzz_body.h"

#include "filasofia/core/text.h"
#include "filasofia/engine/rupture/pieces.h"
#include "filasofia/engine/rupture/tear.h"

#include <algorithm>
#include <cmath>

namespace filasofia::testing {
using namespace engine;
namespace {

void add(std::vector<CutFuzzCount>& counts, const std::string& name)
{
    const auto at = std::ranges::find(counts, name, &CutFuzzCount::name);
    if (at == counts.end())
        counts.push_back({name, 1});
    else
        ++at->count;
}

double worstOf(const MeshTopology& mesh)
{
    double worst = 1.0;
    for (int t = 0; t < static_cast<int>(mesh.tetrahedra.size()); ++t) worst = std::min(worst, restQuality(mesh, t));
    return worst;
}

} // namespace

Vec3 Waves::at(Vec3 p, double time) const
{
    if (amplitude == 0.0) return p;
    const Vec3 y = p + amplitude * std::sin(dot(k1, p) + omega * time) * a1 +
                   0.5 * amplitude * std::sin(dot(k2, p) - 1.7 * omega * time) * a2;
    const double turn = 0.1 * std::sin(omega * time);
    const Vec3 r = y - centre;
    return centre + std::cos(turn) * r + std::sin(turn) * cross(a1, r) + ((1.0 - std::cos(turn)) * dot(a1, r)) * a1;
}

FuzzBody::FuzzBody(EditableMesh given, const CutFuzzDef& def, CutFuzzReport& report, RuptureReport& sums,
                   std::string name)
    : mesh(std::move(given)), def_(def), report_(report), sums_(sums), name_(std::move(name)),
      parameters_(parametersFor(mesh)), mirror_(mesh.data().tetrahedra), positions_(mesh.data().rest),
      pieces_(mesh.data()), walked_(mesh.data())
{
    bound_ = std::min(worstOf(mesh.data()), parameters_.minQuality);
}

void FuzzBody::begin()
{
    std::vector<Vec3> x = mesh.data().rest;
    for (Vec3& p : x) p = waves.at(p, time);
    mesh.placeAt(x);
}

void FuzzBody::step(BladeStroke& stroke, std::span<const BladeSegment> blade)
{
    if (waves.amplitude > 0.0) {
        time += 0.002;
        std::vector<Vec3> x = mesh.data().rest;
        for (Vec3& p : x) p = waves.at(p, time);
        mesh.moveTo(x);
    }
    sums_ += stroke.step(mesh, blade, parameters_);
    ++report_.steps;
    follow();
}

void FuzzBody::finish(BladeStroke& stroke)
{
    bool done = false;
    while (!done) {
        done = stroke.finish(mesh, parameters_, sums_);
        ++report_.steps;
        follow();
    }
}

void FuzzBody::tear(int node, Vec3 direction)
{
    tearAt(mesh, node, direction, sums_);
    ++report_.steps;
    follow();
}

void FuzzBody::follow()
{
    if (!mesh.edited()) return;
    const frame::TopologyEdit edit = mesh.takeEdit({1});
    frame::followNodes(edit, positions_);
    mirror_.apply(edit);
    followPieces(edit);
    ++report_.edits;
    if (++edits_ % def_.checkEvery == 0) look();
}

void FuzzBody::followPieces(const frame::TopologyEdit& edit)
{
    const std::vector<DetachedPiece> loose = pieces_.update(mesh.data(), edit), all = walked_.walk(mesh.data(), edit);
    const bool same = std::ranges::equal(loose, all, [](const DetachedPiece& a, const DetachedPiece& b) {
        return a.id == b.id && a.from == b.from && a.tetrahedra == b.tetrahedra;
    });
    if (!same || pieces_.ofTetrahedron() != walked_.ofTetrahedron() || pieces_.count() != walked_.count())
        add(report_.faults, "pieces missed");
}

void FuzzBody::look()
{
    ++report_.checks;
    const TopologyBounds bounds{
        .quality = bound_, .volume = mesh.startVolume(), .volumeTolerance = mesh.isSheet() ? 1e-6 : 1e-3};
    std::vector<TopologyViolation> found =
        mesh.isSheet() ? checkSheetTopology(mesh.data(), bounds) : checkTopology(mesh.data(), bounds);
    for (TopologyViolation& v : checkMirror(mesh.data(), mirror_, positions_)) found.push_back(std::move(v));
    for (const TopologyViolation& v : found) {
        add(report_.faults, engine::name(v.fault));
        if (report_.examples.size() < 20)
            report_.examples.push_back(text(name_, ": ", engine::name(v.fault), ", ", v.where));
    }
    const double worst = worstOf(mesh.data());
    report_.worstQuality = std::min(report_.worstQuality, worst);
    report_.worstQualityShare = std::min(report_.worstQualityShare, worst / bound_);
    double volume = 0.0;
    for (int t = 0; t < mesh.tetrahedra(); ++t) volume += restVolume(mesh.data(), t);
    report_.volumeDrift = std::max(report_.volumeDrift, std::abs(volume / mesh.startVolume() - 1.0));
    report_.maxTetrahedra = std::max<long>(report_.maxTetrahedra, mesh.tetrahedra());
}

std::vector<int> FuzzBody::parts(int& count) const { return connectedParts(mesh.data(), count); }

double FuzzBody::secondPart() const
{
    int count = 0;
    const std::vector<int> part = parts(count);
    std::vector<double> volume(std::max(count, 2), 0.0);
    for (int t = 0; t < mesh.tetrahedra(); ++t) volume[part[t]] += restVolume(mesh.data(), t);
    std::ranges::sort(volume, std::greater<>());
    return volume[1] / mesh.startVolume();
}

} // namespace filasofia::testing
