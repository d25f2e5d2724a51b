#include "filasofia/surface/heated_tissue.h"

#include "filasofia/core/sorted.h"
#include "filasofia/geometry/distance.h"

#include <algorithm>
#include <cmath>

namespace filasofia::surface {
namespace {

constexpr int kLevels = 8; ///< per tetrahedron: few, so that few commands are needed
/// [-] Tissue lies behind a triangle if the way from it to the nearest point runs as nearly along the normal: cosine.
/// All that does not lie behind an edge that points outwards does. Less would reach around such edges.
constexpr double kAlong = 0.98;
constexpr int kSteps = 16; ///< per vertex; after each, its triangles are looked at again

} // namespace

HeatedTissue::HeatedTissue(std::shared_ptr<const geometry::TetMesh> mesh, double depth)
    : mesh_(std::move(mesh)), depth_(depth)
{
    std::vector<geometry::Box> boxes;
    for (const geometry::Tetrahedron& nodes : mesh_->tetrahedra) {
        geometry::Box& box = boxes.emplace_back();
        for (const int node : nodes) box = geometry::merged(box, mesh_->nodes[static_cast<std::size_t>(node)]);
    }
    tetrahedra_ = std::make_shared<const geometry::Bvh>(boxes);
}

std::array<Vec3, HeatedTissue::kSamples> HeatedTissue::samplesOf(int tetrahedron) const
{
    const geometry::Tetrahedron& nodes = mesh_->tetrahedra[static_cast<std::size_t>(tetrahedron)];
    const auto corner = [&](int k) {
        return mesh_->nodes[static_cast<std::size_t>(nodes[static_cast<std::size_t>(k)])];
    };
    std::array<Vec3, kSamples> out;
    std::size_t count = 0;
    constexpr int kSides = 3; // a lattice with four points along an edge, drawn in from the faces
    for (int i = 0; i <= kSides; ++i)
        for (int j = 0; i + j <= kSides; ++j)
            for (int k = 0; i + j + k <= kSides; ++k)
                out[count++] = 1.0 / (kSides + 1) *
                               ((i + 0.25) * corner(0) + (j + 0.25) * corner(1) + (k + 0.25) * corner(2) +
                                (kSides - i - j - k + 0.25) * corner(3));
    return out;
}

/// Denatures what lies behind a triangle, within the depth.
void HeatedTissue::heat(const std::array<Vec3, 3>& corners, const std::array<double, 3>& denatured)
{
    const Vec3 outwards = cross(corners[1] - corners[0], corners[2] - corners[0]);
    const double size = length(outwards);
    if (!(size > 0.0)) return; // no side is behind it
    tetrahedra_->overlapping(geometry::grown(geometry::boxAround(corners), depth_), found_);
    for (const int tetrahedron : found_) {
        const std::array<Vec3, kSamples> samples = samplesOf(tetrahedron);
        std::array<float, kSamples> reached{};
        bool any = false;
        for (std::size_t s = 0; s < samples.size(); ++s) {
            const auto near = geometry::nearestOnTriangle(samples[s], corners[0], corners[1], corners[2]);
            const double far = std::sqrt(near.squaredDistance);
            if (far > depth_ || dot(near.point - samples[s], outwards) < kAlong * far * size) continue;
            double sum = 0.0;
            for (std::size_t k = 0; k < 3; ++k) sum += near.weights[k] * denatured[k];
            reached[s] = static_cast<float>(sum);
            any = any || sum > 0.0;
        }
        if (!any) continue;
        Heated& heated = heated_[tetrahedron];
        for (std::size_t s = 0; s < reached.size(); ++s)
            heated.denatured[s] = std::max(heated.denatured[s], reached[s]);
        changed_.push_back(tetrahedron);
    }
}

std::vector<HeatedPart> HeatedTissue::spread(std::span<const geometry::Triangle> triangles, std::span<const int> nodes,
                                             std::span<const Vec3> places, std::span<const double> intact)
{
    // Vertices that have gone a step further since the last call.
    std::vector<std::uint8_t> further(intact.size(), 0);
    bool any = false;
    for (std::size_t v = 0; v < intact.size(); ++v) {
        const auto step = static_cast<std::uint8_t>((1.0 - intact[v]) * kSteps + 0.5);
        if (step == 0) continue;
        const auto node = static_cast<std::size_t>(nodes[v]);
        if (node >= seen_.size()) seen_.resize(node + 1, 0);
        if (step > seen_[node]) {
            seen_[node] = step;
            further[v] = 1;
            any = true;
        }
    }
    if (!any) return {};

    // What they reach.
    changed_.clear();
    for (const geometry::Triangle& t : triangles) {
        const auto a = static_cast<std::size_t>(t[0]), b = static_cast<std::size_t>(t[1]),
                   c = static_cast<std::size_t>(t[2]);
        if (further[a] + further[b] + further[c] == 0) continue;
        heat({places[a], places[b], places[c]}, {1.0 - intact[a], 1.0 - intact[b], 1.0 - intact[c]});
    }
    sortUnique(changed_);

    // Which tetrahedra that brings to a higher level.
    std::array<HeatedPart, kLevels> parts;
    for (const int tetrahedron : changed_) {
        Heated& heated = heated_.at(tetrahedron);
        double sum = 0.0;
        for (const float each : heated.denatured) sum += each;
        const int level = static_cast<int>(std::lround(sum / kSamples * kLevels));
        if (level <= heated.level) continue;
        heated.level = level;
        parts[static_cast<std::size_t>(level - 1)].tetrahedra.push_back(tetrahedron);
    }
    std::vector<HeatedPart> out;
    for (int level = 1; level <= kLevels; ++level)
        if (HeatedPart& part = parts[static_cast<std::size_t>(level - 1)]; !part.tetrahedra.empty())
            out.push_back({static_cast<double>(level) / kLevels, std::move(part.tetrahedra)});
    return out;
}

} // namespace filasofia::surface
