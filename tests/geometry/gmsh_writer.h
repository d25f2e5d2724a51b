#pragma once

#include "filasofia/core/text.h"
#include "filasofia/geometry/tet_mesh.h"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <string>

namespace filasofia::geometry {

enum class GmshForm { Ascii, Binary, SwappedBinary };

struct GmshOptions {
    bool version4 = false;
    GmshForm form = GmshForm::Ascii;
    std::int64_t gap = 1; ///< between the numbers of neighbouring nodes
};

/// Writes what Gmsh would write, as input for the reader.
class GmshWriter {
public:
    explicit GmshWriter(GmshOptions options) : options_(options) {}

    std::string write(const TetMesh& mesh)
    {
        out_ = text("$MeshFormat\n", options_.version4 ? "4.1 " : "2.2 ", ascii() ? 0 : 1, " 8\n");
        if (!ascii()) put(std::int32_t{1}), out_ += '\n';
        out_ += "$EndMeshFormat\n";
        labels_ = mesh.labels;
        if (!mesh.labelNames.empty()) names(mesh);
        if (options_.version4 && !labels_.empty()) entities();
        out_ += "$Nodes\n";
        options_.version4 ? nodes4(mesh) : nodes2(mesh);
        out_ += "\n$EndNodes\n$Elements\n";
        options_.version4 ? elements4(mesh) : elements2(mesh);
        out_ += "\n$EndElements\n";
        return out_;
    }

private:
    [[nodiscard]] bool ascii() const { return options_.form == GmshForm::Ascii; }
    [[nodiscard]] std::int64_t tag(std::size_t node) const { return 5 + options_.gap * std::int64_t(node); }

    template <class Number> void put(Number number)
    {
        if (ascii()) {
            out_ += text(number, ' ');
            return;
        }
        char raw[sizeof number];
        std::memcpy(raw, &number, sizeof number);
        if (options_.form == GmshForm::SwappedBinary) std::reverse(raw, raw + sizeof number);
        out_.append(raw, sizeof number);
    }
    void putInt(std::int64_t number) { put(static_cast<std::int32_t>(number)); }
    void putSize(std::int64_t number) { put(number); }

    void names(const TetMesh& mesh)
    {
        out_ += text("$PhysicalNames\n", mesh.labelNames.size() + 1, "\n2 1 \"a surface\"\n");
        for (const MeshLabel& each : mesh.labelNames) out_ += text("3 ", each.label, " \"", each.name, "\"\n");
        out_ += "$EndPhysicalNames\n";
    }
    /// A point, a surface and a volume per label; the volume with number 10 + i is in the group of the i-th label.
    void entities()
    {
        volumes_ = labels_;
        std::ranges::sort(volumes_);
        volumes_.erase(std::unique(volumes_.begin(), volumes_.end()), volumes_.end());
        out_ += "$Entities\n";
        putSize(1), putSize(0), putSize(1), putSize(std::int64_t(volumes_.size()));
        putInt(1), bounds(3), putSize(0);
        putInt(1), bounds(6), putSize(1), putInt(77), putSize(0);
        for (std::size_t i = 0; i < volumes_.size(); ++i)
            putInt(10 + std::int64_t(i)), bounds(6), putSize(2), putInt(volumes_[i]), putInt(99), putSize(1),
                putInt(-1);
        out_ += "\n$EndEntities\n";
    }
    void bounds(int count)
    {
        for (int k = 0; k < count; ++k) put(0.5);
    }

    void nodes2(const TetMesh& mesh)
    {
        out_ += text(mesh.nodes.size(), "\n");
        for (std::size_t i = 0; i < mesh.nodes.size(); ++i) {
            const Vec3 p = mesh.nodes[i];
            putInt(tag(i)), put(p.x), put(p.y), put(p.z);
        }
    }
    // Two blocks, so that the second block's numbers do not begin where the file's do.
    void nodes4(const TetMesh& mesh)
    {
        const std::size_t count = mesh.nodes.size(), half = count / 2;
        putSize(2), putSize(std::int64_t(count)), putSize(tag(0)), putSize(tag(count - 1));
        for (auto [first, last] : {std::pair{std::size_t{0}, half}, {half, count}}) {
            putInt(3), putInt(1), putInt(0), putSize(std::int64_t(last - first));
            for (std::size_t i = first; i < last; ++i) putSize(tag(i));
            for (std::size_t i = first; i < last; ++i) {
                const Vec3 p = mesh.nodes[i];
                put(p.x), put(p.y), put(p.z);
            }
        }
    }
    // A triangle comes first, which must be skipped; then the tetrahedra in one run.
    void elements2(const TetMesh& mesh)
    {
        const std::int64_t count = std::int64_t(mesh.tetrahedra.size());
        out_ += text(count + 1, "\n");
        const auto head = [&](std::int64_t number, int type, std::int64_t run) {
            const bool solid = type == 4 && !labels_.empty();
            const std::int64_t group = solid ? labels_[static_cast<std::size_t>(number - 1)] : 0;
            if (ascii())
                putInt(number), putInt(type), putInt(2), putInt(group), putInt(1);
            else if (run > 0)
                putInt(type), putInt(run), putInt(2);
            if (!ascii()) putInt(number), putInt(group), putInt(1);
        };
        head(count + 1, 2, 1);
        for (std::size_t i = 0; i < 3; ++i) putInt(tag(i));
        for (std::int64_t t = 0; t < count; ++t) {
            head(t + 1, 4, t == 0 ? count : 0);
            for (int node : mesh.tetrahedra[t]) putInt(tag(node));
        }
    }
    void elements4(const TetMesh& mesh)
    {
        const std::int64_t count = std::int64_t(mesh.tetrahedra.size());
        // Without labels all tetrahedra are in one block; with labels each is in one of its own.
        putSize(labels_.empty() ? 2 : 1 + count), putSize(count + 1), putSize(1), putSize(count + 1);
        putInt(2), putInt(1), putInt(2), putSize(1), putSize(count + 1);
        for (std::size_t i = 0; i < 3; ++i) putSize(tag(i));
        for (std::int64_t t = 0; t < count; ++t) {
            if (t == 0 || !labels_.empty())
                putInt(3), putInt(volumeOf(t)), putInt(4), putSize(labels_.empty() ? count : 1);
            putSize(t + 1);
            for (int node : mesh.tetrahedra[t]) putSize(tag(node));
        }
    }
    [[nodiscard]] std::int64_t volumeOf(std::int64_t t) const
    {
        if (labels_.empty()) return 1;
        return 10 + (std::ranges::find(volumes_, labels_[static_cast<std::size_t>(t)]) - volumes_.begin());
    }

    GmshOptions options_;
    std::vector<int> labels_, volumes_; ///< per tetrahedron; those of the volumes
    std::string out_;
};

inline std::string writeGmsh(const TetMesh& mesh, GmshOptions options) { return GmshWriter(options).write(mesh); }

} // namespace filasofia::geometry
