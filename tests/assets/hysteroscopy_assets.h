#pragma once

#include "filasofia/geometry/bvh.h"
#include "filasofia/geometry/distance.h"
#include "filasofia/geometry/mesh_file.h"
#include "filasofia/geometry/surface.h"
#include "geometry/sample_meshes.h"

#include <nlohmann/json.hpp>

#include <filesystem>
#include <fstream>

namespace filasofia {

inline std::filesystem::path meshFolder(const std::string& name)
{
    return std::filesystem::path(FILASOFIA_SOURCE_DIR) / "assets/meshes" / name;
}
inline std::filesystem::path hysteroscopyFolder() { return meshFolder("hysteroscopy"); }

inline geometry::TetMesh tets(const std::string& name)
{
    return geometry::loadTetMesh(hysteroscopyFolder() / (name + ".msh"));
}

inline geometry::TriangleMesh triangles(const std::string& file, const std::string& folder = "hysteroscopy")
{
    return geometry::loadTriangleMesh(meshFolder(folder) / file);
}

inline nlohmann::json facts(const std::string& file, const std::string& folder = "hysteroscopy")
{
    return nlohmann::json::parse(std::ifstream(meshFolder(folder) / file));
}

/// A list of such a file, by value: a loop over facts()[key] would use a destroyed temporary.
inline std::vector<nlohmann::json> listed(const std::string& file, const std::string& key)
{
    return facts(file).at(key).get<std::vector<nlohmann::json>>();
}

inline Vec3 toVec3(const nlohmann::json& numbers)
{
    REQUIRE(numbers.size() == 3);
    return {numbers[0], numbers[1], numbers[2]};
}

/// Distances to a surface.
class Surroundings {
public:
    explicit Surroundings(geometry::TriangleMesh mesh) : mesh_(std::move(mesh))
    {
        std::vector<geometry::Box> boxes;
        for (const auto& [a, b, c] : mesh_.triangles) {
            geometry::Box box;
            for (int corner : {a, b, c}) box = geometry::merged(box, mesh_.vertices[corner]);
            boxes.push_back(box);
        }
        tree_ = geometry::Bvh(boxes);
    }
    [[nodiscard]] double distanceTo(Vec3 p) const
    {
        return std::sqrt(tree_.nearest(p, [&](int triangle) { return nearest(p, triangle).squaredDistance; }).value);
    }
    /// Whether a point lies inside: a ray from p then crosses the surface an odd number of times.
    [[nodiscard]] bool holds(Vec3 p) const
    {
        const Vec3 direction{0.0123, 0.0371, 1.0};
        int crossings = 0;
        for (const auto& [a, b, c] : mesh_.triangles) {
            const auto& v = mesh_.vertices;
            const double at = geometry::rayTriangle(p, direction, v[a], v[b], v[c]);
            crossings += at >= 0.0 && std::isfinite(at);
        }
        return crossings % 2 == 1;
    }

private:
    [[nodiscard]] geometry::Nearest<3> nearest(Vec3 p, int triangle) const
    {
        const auto [a, b, c] = mesh_.triangles[triangle];
        return geometry::nearestOnTriangle(p, mesh_.vertices[a], mesh_.vertices[b], mesh_.vertices[c]);
    }
    geometry::TriangleMesh mesh_;
    geometry::Bvh tree_;
};

inline geometry::Box boundsOf(const geometry::TriangleMesh& mesh)
{
    geometry::Box box;
    for (Vec3 v : mesh.vertices) box = geometry::merged(box, v);
    return box;
}

} // namespace filasofia
