#include "filasofia/engine/elastic/volume_blocks.h"

#include "filasofia/linalg/simd_targets.h"

#include <algorithm>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "filasofia/engine/elastic/volume_blocks.cpp"
#include <hwy/foreach_target.h>

#include "filasofia/engine/elastic/element_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace filasofia::engine::HWY_NAMESPACE {
using linalg::HWY_NAMESPACE::addGroup;

/// The change of an element's volume for changes of its edges.
HWY_INLINE V changeOf(const V3 (&gradients)[3], const V3 (&edges)[3])
{
    return hn::Add(hn::Add(dot(gradients[0], edges[0]), dot(gradients[1], edges[1])), dot(gradients[2], edges[2]));
}

HWY_ATTR void updateVolumeBlocks(const ElementBlock* HWY_RESTRICT elements, const float* HWY_RESTRICT shares,
                                 const BlockInput& input, linalg::Blocks blocks, const VolumeOutput& output)
{
    const float *HWY_RESTRICT x = input.x.data(), *HWY_RESTRICT v = input.v.data();
    VolumeBlock* HWY_RESTRICT volumes = output.volumes.data();
    float* HWY_RESTRICT changes = output.changes.data();
    const Lanes d;
    const V one = hn::Set(d, 1.0f), force = hn::Set(d, input.weights.force);
    const V stiffness = hn::Set(d, input.weights.volumeStiffness);
    for (int block = blocks.begin; block < blocks.end; ++block) {
        const ElementBlock& element = elements[block];
        VolumeBlock& out = volumes[block];
        std::copy_n(element.nodes[0], 4 * kBlock, out.nodes[0]);
        for (std::size_t part = 0; part < kBlock; part += kLanes) {
            V3 edges[3], rates[3], g[3], gradients[3];
            loadEdges(x, element.nodes, part, edges);
            loadEdges(v, element.nodes, part, rates);
            loadGradients(element.gradients, part, g);
            const M3 f = gradientOf(edges, g);
            const V share = hn::LoadU(d, shares + kBlock * block + part);
            const V3 rows[3] = {{f.m[0][0], f.m[0][1], f.m[0][2]},
                                {f.m[1][0], f.m[1][1], f.m[1][2]},
                                {f.m[2][0], f.m[2][1], f.m[2][2]}};
            const V3 c0 = cross(rows[1], rows[2]), c1 = cross(rows[2], rows[0]), c2 = cross(rows[0], rows[1]);
            for (int k = 0; k < 3; ++k) {
                gradients[k] = share * V3{dot(c0, g[k]), dot(c1, g[k]), dot(c2, g[k])};
                hn::Store(gradients[k].x, d, out.gradients[3 * k] + part);
                hn::Store(gradients[k].y, d, out.gradients[3 * k + 1] + part);
                hn::Store(gradients[k].z, d, out.gradients[3 * k + 2] + part);
            }
            const V grown = hn::Mul(share, hn::Sub(dot(rows[0], c0), one));
            const V change = hn::MulAdd(force, grown, hn::Mul(stiffness, changeOf(gradients, rates)));
            hn::StoreU(change, d, changes + kBlock * block + part);
        }
    }
}

HWY_ATTR void multiplyVolumeBlocks(const VolumeBlock* HWY_RESTRICT volumes, const float* HWY_RESTRICT p,
                                   linalg::Blocks blocks, float* HWY_RESTRICT changes)
{
    for (int block = blocks.begin; block < blocks.end; ++block)
        for (std::size_t part = 0; part < kBlock; part += kLanes) {
            V3 edges[3], gradients[3];
            loadEdges(p, volumes[block].nodes, part, edges);
            loadGradients(volumes[block].gradients, part, gradients);
            hn::StoreU(changeOf(gradients, edges), Lanes(), changes + kBlock * block + part);
        }
}

HWY_ATTR void addVolumeBlocks(const VolumeBlock* HWY_RESTRICT volumes, const float* HWY_RESTRICT pressures,
                              linalg::Blocks blocks, float* HWY_RESTRICT corners)
{
    const Lanes d;
    const hn::RebindToSigned<Lanes> whole;
    for (int block = blocks.begin; block < blocks.end; ++block)
        for (std::size_t part = 0; part < kBlock; part += kLanes) {
            const VolumeBlock& volume = volumes[block];
            const auto at = [&](int corner) HWY_ATTR { // nodes are given by the index of their vectors, 4 * node
                const auto index = hn::ShiftRight<2>(hn::Load(whole, volume.nodes[corner] + part));
                return hn::GatherIndex(d, pressures, index);
            };
            const V sum = hn::Add(hn::Add(at(0), at(1)), hn::Add(at(2), at(3)));
            V3 gradients[3];
            loadGradients(volume.gradients, part, gradients);
            float* out = corners + static_cast<long>(kElementCorners) * block;
            for (int k = 0; k < 3; ++k) {
                gradients[k] = sum * gradients[k];
                addGroup(gradients[k], out + 64 * (k + 1), part);
            }
            addGroup(negative(gradients[0] + gradients[1] + gradients[2]), out, part);
        }
}

} // namespace filasofia::engine::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace filasofia::engine {

HWY_EXPORT(updateVolumeBlocks);
HWY_EXPORT(multiplyVolumeBlocks);
HWY_EXPORT(addVolumeBlocks);

void updateVolumes(std::span<const ElementBlock> elements, std::span<const float> shares, const BlockInput& input,
                   linalg::Blocks blocks, const VolumeOutput& output)
{
    HWY_DYNAMIC_DISPATCH(updateVolumeBlocks)(elements.data(), shares.data(), input, blocks, output);
}

void multiplyVolumes(std::span<const VolumeBlock> volumes, const linalg::NodeArray& p, linalg::Blocks blocks,
                     std::span<float> changes)
{
    HWY_DYNAMIC_DISPATCH(multiplyVolumeBlocks)(volumes.data(), p.data(), blocks, changes.data());
}

void addVolumeForces(std::span<const VolumeBlock> volumes, std::span<const float> pressures, linalg::Blocks blocks,
                     std::span<float> corners)
{
    HWY_DYNAMIC_DISPATCH(addVolumeBlocks)(volumes.data(), pressures.data(), blocks, corners.data());
}

} // namespace filasofia::engine
#endif
