#include "filasofia/visual/subdivision.h"

#include "filasofia/core/assert.h"
#include "filasofia/core/error.h"
#include "filasofia/geometry/texture_seams.h"

#include <opensubdiv/far/primvarRefiner.h>
#include <opensubdiv/far/stencilTableFactory.h>
#include <opensubdiv/far/topologyDescriptor.h>
#include <opensubdiv/far/topologyRefinerFactory.h>

#include <algorithm>

namespace filasofia::visual {
namespace {

namespace Far = OpenSubdiv::Far;
namespace Sdc = OpenSubdiv::Sdc;

// OpenSubdiv takes some non-manifold meshes and refuses others; a rule that can be stated in advance is better.
void checkManifold(const geometry::TriangleMesh& mesh, std::string_view name)
{
    // Directed: a manifold mesh has none twice, and no undirected one three times.
    std::vector<std::array<int, 2>> edges;
    edges.reserve(3 * mesh.triangles.size());
    for (const geometry::Triangle& t : mesh.triangles)
        for (int k = 0; k < 3; ++k) edges.push_back({t[std::size_t(k)], t[std::size_t((k + 1) % 3)]});
    std::sort(edges.begin(), edges.end());
    const auto twice = std::adjacent_find(edges.begin(), edges.end());
    if (twice != edges.end())
        fail(name, ": subdivision needs a manifold surface of one orientation: two triangles run along edge (",
             (*twice)[0], ", ", (*twice)[1], ") in the same direction");
}

Float3 uvAsFloats(const std::array<double, 2>& uv)
{
    return {static_cast<float>(uv[0]), static_cast<float>(uv[1]), 0.0F};
}

} // namespace

struct Subdivision::CornerUv {
    std::vector<Float3> values;
    std::vector<int> ofCorners; ///< three per triangle

    explicit CornerUv(const geometry::TriangleMesh& mesh)
    {
        if (!geometry::perCorner(mesh)) return;
        std::vector<int> last(mesh.vertices.size(), -1), before; // the values of a vertex, as lists
        for (std::size_t corner = 0; corner < mesh.uv.size(); ++corner) {
            int& newest = last[static_cast<std::size_t>(mesh.triangles[corner / 3][corner % 3])];
            const Float3 uv = uvAsFloats(mesh.uv[corner]);
            int value = newest;
            while (value >= 0 && values[std::size_t(value)] != uv) value = before[std::size_t(value)];
            if (value < 0) {
                value = static_cast<int>(values.size());
                values.push_back(uv);
                before.push_back(std::exchange(newest, value));
            }
            ofCorners.push_back(value);
        }
    }
};

namespace {

std::unique_ptr<Far::TopologyRefiner> refinerOf(const geometry::TriangleMesh& mesh, std::span<const int> uvOfCorners,
                                                std::size_t uvCount, std::string_view name)
{
    const std::vector<int> corners(mesh.triangles.size(), 3);
    Far::TopologyDescriptor descriptor;
    descriptor.numVertices = static_cast<int>(mesh.vertices.size());
    descriptor.numFaces = static_cast<int>(mesh.triangles.size());
    descriptor.numVertsPerFace = corners.data();
    descriptor.vertIndicesPerFace = mesh.triangles.front().data();
    Far::TopologyDescriptor::FVarChannel uv;
    uv.numValues = static_cast<int>(uvCount);
    uv.valueIndices = uvOfCorners.data();
    descriptor.numFVarChannels = uvCount > 0 ? 1 : 0;
    descriptor.fvarChannels = &uv;

    using Factory = Far::TopologyRefinerFactory<Far::TopologyDescriptor>;
    Sdc::Options rules;
    rules.SetVtxBoundaryInterpolation(Sdc::Options::VTX_BOUNDARY_EDGE_ONLY);
    rules.SetFVarLinearInterpolation(Sdc::Options::FVAR_LINEAR_CORNERS_PLUS1);
    std::unique_ptr<Far::TopologyRefiner> refiner(
        Factory::Create(descriptor, Factory::Options(Sdc::SCHEME_LOOP, rules)));
    if (!refiner) fail(name, ": the surface cannot be subdivided: its triangles do not form a surface");
    return refiner;
}

} // namespace

struct Subdivision::Stencils {
    std::unique_ptr<const Far::StencilTableReal<float>> table; // its derived class only adds a name
};

Subdivision::Subdivision(const geometry::TriangleMesh& mesh, int level, std::string_view name)
    : controlCount_(static_cast<int>(mesh.vertices.size())), vertexCount_(controlCount_)
{
    geometry::check(mesh, name);
    if (level < 0 || level > 3) fail(name, ": subdivision must be in [0, 3], got ", level);
    const CornerUv corners(mesh);
    if (level == 0) {
        indices_.reserve(3 * mesh.triangles.size());
        for (const geometry::Triangle& t : mesh.triangles)
            for (int v : t) indices_.push_back(static_cast<std::uint32_t>(v));
        copySeams(corners.values, corners.ofCorners);
        refineUv(mesh);
        return;
    }
    checkManifold(mesh, name);
    const auto refiner = refinerOf(mesh, corners.ofCorners, corners.values.size(), name);
    Far::TopologyRefiner::UniformOptions uniform(level);
    uniform.fullTopologyInLastLevel = true; // the triangles of the last level are drawn
    refiner->RefineUniform(uniform);

    using Factory = Far::StencilTableFactoryReal<float>;
    Factory::Options options;
    options.generateIntermediateLevels = false;
    options.generateOffsets = true;
    stencils_ = std::make_unique<Stencils>();
    stencils_->table.reset(Factory::Create(*refiner, options));

    const Far::TopologyLevel& last = refiner->GetLevel(level);
    vertexCount_ = last.GetNumVertices();
    if (!stencils_->table || stencils_->table->GetNumStencils() != vertexCount_)
        fail(name, ": the surface cannot be subdivided");
    indices_.reserve(3 * std::size_t(last.GetNumFaces()));
    for (int face = 0; face < last.GetNumFaces(); ++face)
        for (int v : last.GetFaceVertices(face)) indices_.push_back(static_cast<std::uint32_t>(v));
    refineUv(mesh);
    if (corners.values.empty()) return;
    std::vector<Float3> values = corners.values;
    const Far::PrimvarRefinerReal<float> interpolation(*refiner);
    for (int step = 1; step <= level; ++step) {
        std::vector<Float3> finer(static_cast<std::size_t>(refiner->GetLevel(step).GetNumFVarValues()));
        interpolation.InterpolateFaceVarying(step, values, finer);
        values = std::move(finer);
    }
    std::vector<int> ofCorners;
    ofCorners.reserve(indices_.size());
    for (int face = 0; face < last.GetNumFaces(); ++face)
        for (int value : last.GetFaceFVarValues(face)) ofCorners.push_back(value);
    copySeams(values, ofCorners);
}

void Subdivision::refineUv(const geometry::TriangleMesh& mesh)
{
    if (mesh.uv.empty() || geometry::perCorner(mesh)) return;
    std::vector<Float3> control(mesh.uv.size());
    std::ranges::transform(mesh.uv, control.begin(), uvAsFloats);
    for (const Float3& refined : refine(control)) uv_.push_back({refined.x, refined.y});
}

void Subdivision::copySeams(std::span<const Float3> values, std::span<const int> ofCorners)
{
    if (values.empty()) return;
    constexpr std::uint32_t kNone = ~0u;
    std::vector<std::uint32_t> drawnAs(values.size(), kNone);
    std::vector<std::uint8_t> taken(static_cast<std::size_t>(vertexCount_), 0);
    uv_.resize(taken.size());
    drawn_.reserve(indices_.size());
    for (std::size_t corner = 0; corner < indices_.size(); ++corner) {
        const std::uint32_t vertex = indices_[corner];
        const auto value = static_cast<std::size_t>(ofCorners[corner]);
        if (drawnAs[value] == kNone) {
            const std::array<float, 2> uv{values[value].x, values[value].y};
            if (std::exchange(taken[vertex], 1) == 0) { // the first pair of a vertex is its own
                drawnAs[value] = vertex;
                uv_[vertex] = uv;
            } else {
                drawnAs[value] = static_cast<std::uint32_t>(uv_.size());
                copies_.push_back(vertex);
                uv_.push_back(uv);
            }
        }
        drawn_.push_back(drawnAs[value]);
    }
}

Subdivision::~Subdivision() = default;
Subdivision::Subdivision(Subdivision&&) noexcept = default;
Subdivision& Subdivision::operator=(Subdivision&&) noexcept = default;

std::vector<Float3> Subdivision::refine(std::span<const Float3> control) const
{
    FILASOFIA_ASSERT(control.size() == std::size_t(controlCount_));
    if (!stencils_) return {control.begin(), control.end()};
    std::vector<Float3> refined(static_cast<std::size_t>(vertexCount_));
    // The templated product is three to five times faster than OpenSubdiv's evaluators on arrays.
    stencils_->table->UpdateValues(control.data(), refined.data());
    return refined;
}

} // namespace filasofia::visual
