#include "filasofia/sofa/soft_cuts.h"

#include "filasofia/core/hash.h"
#include "filasofia/engine/rupture/tet_shape.h"
#include "filasofia/sofa/sofa_vec.h"

#include <algorithm>
#include <map>
#include <numeric>

namespace filasofia::sofaengine {
namespace {

template <class Value>
void inherit(const std::vector<int>& origin, const std::vector<Value>& from, std::vector<Value>& to)
{
    if (from.empty()) return;
    to.resize(origin.size());
    for (std::size_t t = 0; t < origin.size(); ++t) to[t] = from[at(origin[t])];
}

std::shared_ptr<const frame::Boundary> boundaryOf(const SoftCuts& cuts)
{
    const engine::MeshTopology& mesh = cuts.mesh.data();
    auto out = std::make_shared<frame::Boundary>();
    out->revision = cuts.revision;
    out->rest = mesh.rest;
    for (std::size_t e = 0; e < mesh.tetrahedra.size(); ++e) {
        if (mesh.gone[e] != 0) continue;
        for (int f = 0; f < 4; ++f) {
            if (!engine::isBoundaryFace(mesh, static_cast<int>(e), f)) continue;
            out->triangles.push_back(engine::faceNodes(mesh.tetrahedra[e], f));
            out->opened.push_back(engine::has(mesh.opened[e], f) ? 1 : 0);
            out->behind.push_back(mesh.tetrahedra[e][at(f)]);
        }
    }
    return out;
}

} // namespace

SoftCuts::SoftCuts(const SoftPlan& plan)
    : mesh(plan.mesh), pieces(mesh.data()), start(plan), origin(plan.mesh.tetrahedra.size())
{
    std::iota(origin.begin(), origin.end(), 0);
    boundary = boundaryOf(*this);
}

void publishBoundary(SoftCuts& cuts)
{
    ++cuts.revision;
    cuts.boundary = boundaryOf(cuts);
}

void inheritTissue(const SoftCuts& cuts, SoftPlan& plan)
{
    inherit(cuts.origin, cuts.start.density, plan.density);
    inherit(cuts.origin, cuts.start.youngModulus, plan.youngModulus);
    inherit(cuts.origin, cuts.start.poissonRatio, plan.poissonRatio);
    plan.tearing.clear();
    inherit(cuts.origin, cuts.start.tearing, plan.tearing);
}

bool removePiece(int piece, SoftCuts& cuts, SoftPlan& plan)
{
    const std::vector<int>& pieces = cuts.pieces.ofTetrahedron();
    std::vector<int> elements;
    std::size_t left = 0;
    for (std::size_t e = 0; e < pieces.size(); ++e) {
        if (cuts.removed.contains(pieces[e])) continue;
        if (pieces[e] == piece)
            elements.push_back(static_cast<int>(e));
        else
            ++left;
    }
    if (elements.empty() || left == 0) return false;
    cuts.removed.insert(piece);
    cuts.mesh.remove(elements);
    plan.gone.resize(pieces.size());
    for (const int e : elements) plan.gone[at(e)] = 1;
    Hasher hash;
    hash.add(cuts.history);
    hash.add(static_cast<std::uint64_t>(piece));
    cuts.history = hash.value();
    shapePlan(plan);
    publishBoundary(cuts);
    return true;
}

std::vector<char> goneNodes(const SoftPlan& plan)
{
    std::vector<char> gone(plan.mesh.nodes.size());
    for (std::size_t t = 0; t < plan.gone.size(); ++t)
        if (plan.gone[t] != 0)
            for (const int node : plan.mesh.tetrahedra[t]) gone[at(node)] = 1; // pieces share no nodes
    return gone;
}

std::vector<int> piecesBeyond(double far, const SoftCuts& cuts, const std::vector<Vec3>& positions)
{
    const engine::MeshTopology& mesh = cuts.mesh.data();
    const std::vector<int>& pieces = cuts.pieces.ofTetrahedron();
    std::vector<int> ofNode(mesh.rest.size(), -1); // pieces share no nodes
    for (std::size_t e = 0; e < pieces.size(); ++e)
        if (!cuts.removed.contains(pieces[e]))
            for (const int node : mesh.tetrahedra[e]) ofNode[at(node)] = pieces[e];
    std::map<int, engine::PiecePlace> found;
    for (std::size_t i = 0; i < ofNode.size(); ++i)
        if (ofNode[i] >= 0)
            ++found.try_emplace(ofNode[i], engine::PiecePlace{ofNode[i], 0, positions[i], mesh.rest[i]})
                  .first->second.nodes;
    std::vector<engine::PiecePlace> places;
    for (const auto& [number, place] : found) places.push_back(place);
    return engine::piecesBeyond(far, places);
}

} // namespace filasofia::sofaengine
