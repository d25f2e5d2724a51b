#include "filasofia/geometry/assimp_reader.h"

#include "filasofia/core/error.h"
#include "filasofia/core/log.h"
#include "filasofia/core/user_file.h"
#include "filasofia/geometry/texture_seams.h"

#include <assimp/DefaultIOSystem.h>
#include <assimp/Importer.hpp>
#include <assimp/MemoryIOWrapper.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace filasofia::geometry {
namespace {

// The content of the file before vertices are merged: one vertex per corner, as assimp reads it.
struct Soup {
    TriangleMesh mesh; ///< uv is always filled
    bool anyUv = false, anyWithout = false;
    std::size_t notTriangles = 0; ///< points and lines
};

Vec3 placed(const aiMatrix4x4& m, const aiVector3D& p)
{
    // In double, so that the file's numbers lose nothing further.
    const double x = p.x, y = p.y, z = p.z;
    return {m.a1 * x + m.a2 * y + m.a3 * z + m.a4, m.b1 * x + m.b2 * y + m.b3 * z + m.b4,
            m.c1 * x + m.c2 * y + m.c3 * z + m.c4};
}

// assimp's triangulation trusts its parsers, and ends the process if a face has no corners.
void checkMesh(const aiMesh& mesh, std::string_view name)
{
    for (unsigned i = 0; i < mesh.mNumVertices; ++i) {
        const aiVector3D p = mesh.mVertices[i],
                         uv = mesh.HasTextureCoords(0) ? mesh.mTextureCoords[0][i] : aiVector3D();
        if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z))
            fail(name, ": vertex ", i, " must be finite, got ", p.x, " ", p.y, " ", p.z);
        if (!std::isfinite(uv.x) || !std::isfinite(uv.y))
            fail(name, ": the texture coordinates of vertex ", i, " must be finite, got ", uv.x, " ", uv.y);
    }
    for (unsigned i = 0; i < mesh.mNumFaces; ++i) {
        const aiFace& face = mesh.mFaces[i];
        if (face.mNumIndices == 0) fail(name, ": face ", i, " must have at least 1 vertex, got 0");
        for (unsigned k = 0; k < face.mNumIndices; ++k)
            if (face.mIndices[k] >= mesh.mNumVertices)
                fail(name, ": face ", i, " names vertex ", face.mIndices[k], "; it must be in [0, ", mesh.mNumVertices,
                     ")");
    }
}

void appendMesh(const aiMesh& mesh, const aiMatrix4x4& place, std::string_view name, Soup& soup)
{
    constexpr std::size_t kMaxCount = 500'000'000;
    const std::size_t first = soup.mesh.vertices.size();
    if (first + mesh.mNumVertices > kMaxCount) fail(name, ": has more than ", kMaxCount, " vertices");
    const bool hasUv = mesh.HasTextureCoords(0);
    (hasUv ? soup.anyUv : soup.anyWithout) = true;
    for (unsigned i = 0; i < mesh.mNumVertices; ++i) {
        const Vec3 p = placed(place, mesh.mVertices[i]);
        if (!isFinite(p)) fail(name, ": vertex ", i, " must be finite after the transformation of its node");
        soup.mesh.vertices.push_back(p);
        const aiVector3D uv = hasUv ? mesh.mTextureCoords[0][i] : aiVector3D();
        soup.mesh.uv.push_back({uv.x, uv.y});
    }
    const bool mirrored =
        place.Determinant() < 0; // a mirrored mesh would be inside out: reverse the order of the corners
    for (unsigned i = 0; i < mesh.mNumFaces; ++i) {
        const aiFace& face = mesh.mFaces[i];
        if (face.mNumIndices != 3) {
            ++soup.notTriangles;
            continue;
        }
        Triangle triangle{};
        for (int k = 0; k < 3; ++k) {
            triangle[k] = static_cast<int>(first + face.mIndices[mirrored ? 2 - k : k]);
        }
        soup.mesh.triangles.push_back(triangle);
    }
}

void appendNodes(const aiScene& scene, std::string_view name, Soup& soup)
{
    struct Placed {
        const aiNode* node;
        aiMatrix4x4 place;
    };
    std::vector<Placed> open{{scene.mRootNode, {}}};
    while (!open.empty()) {
        const Placed now = open.back();
        open.pop_back();
        const aiMatrix4x4 place = now.place * now.node->mTransformation;
        for (unsigned i = 0; i < now.node->mNumMeshes; ++i)
            appendMesh(*scene.mMeshes[now.node->mMeshes[i]], place, name, soup);
        for (unsigned i = now.node->mNumChildren; i-- > 0;) open.push_back({now.node->mChildren[i], place});
    }
}

// For each vertex the first one at the same position, found by sorting: no hash decides an order.
std::vector<int> firstAtSamePlace(const std::vector<Vec3>& vertices)
{
    std::vector<int> order(vertices.size());
    std::iota(order.begin(), order.end(), 0);
    const auto before = [&](int a, int b) {
        const Vec3 p = vertices[a], q = vertices[b];
        return p.x != q.x ? p.x < q.x : p.y != q.y ? p.y < q.y : p.z != q.z ? p.z < q.z : a < b;
    };
    std::ranges::sort(order, before);
    std::vector<int> firsts(vertices.size());
    for (std::size_t i = 0; i < order.size(); ++i) {
        const bool same = i > 0 && vertices[order[i]] == vertices[order[i - 1]];
        firsts[order[i]] = same ? firsts[order[i - 1]] : order[i];
    }
    return firsts;
}

// Vertices are numbered as triangles first use them, so vertices that no triangle uses are dropped. Where corners of
// one vertex differ in their texture coordinates, all corners keep their own.
TriangleMesh joined(const Soup& soup, std::size_t& dropped)
{
    const std::vector<int> firsts = firstAtSamePlace(soup.mesh.vertices);
    std::vector<int> renumbered(firsts.size(), -1);
    TriangleMesh mesh;
    std::vector<std::array<double, 2>> ofCorners;
    bool seams = false;
    const auto vertexOf = [&](int corner) {
        const int first = firsts[corner];
        int& vertex = renumbered[first];
        if (vertex < 0) {
            vertex = static_cast<int>(mesh.vertices.size());
            mesh.vertices.push_back(soup.mesh.vertices[first]);
            mesh.uv.push_back(soup.mesh.uv[corner]);
        }
        ofCorners.push_back(soup.mesh.uv[corner]);
        seams = seams || mesh.uv[vertex] != ofCorners.back();
        return vertex;
    };
    for (const auto [a, b, c] : soup.mesh.triangles) {
        if (firsts[a] == firsts[b] || firsts[b] == firsts[c] || firsts[c] == firsts[a]) {
            ++dropped;
            continue;
        }
        const int i = vertexOf(a), j = vertexOf(b), k = vertexOf(c);
        mesh.triangles.push_back({i, j, k});
    }
    if (seams) setUvOfCorners(mesh, std::move(ofCorners));
    if (!soup.anyUv) mesh.uv.clear();
    return mesh;
}

// A mesh file names other files (materials, buffers). What assimp opens must be regular: a pipe would wait for its
// writer. The mesh file itself may have another content.
class RegularFiles : public Assimp::DefaultIOSystem {
public:
    RegularFiles(std::string mesh, const std::optional<std::string>& text) : mesh_(std::move(mesh)), text_(text) {}

    [[nodiscard]] bool Exists(const char* file) const override // assimp's own version opens the file
    {
        std::error_code problem;
        return std::filesystem::is_regular_file(file, problem);
    }
    Assimp::IOStream* Open(const char* file, const char* mode) override
    {
        if (text_ && mesh_ == file)
            return new Assimp::MemoryIOStream(reinterpret_cast<const std::uint8_t*>(text_->data()), text_->size());
        if (!Exists(file)) return nullptr;
        checkRegularFile(file, file);
        return Assimp::DefaultIOSystem::Open(file, mode);
    }

private:
    std::string mesh_;
    const std::optional<std::string>& text_;
};

Soup readSoup(const std::filesystem::path& file, const std::optional<std::string>& text)
{
    const std::string name = file.string();
    Soup soup;
    try {
        Assimp::Importer importer;
        importer.SetIOHandler(new RegularFiles(name, text)); // the importer owns it
        const aiScene* scene = importer.ReadFile(name, 0);
        if (scene == nullptr) fail(name, ": cannot be read: ", std::string_view(importer.GetErrorString()));
        if (scene->mRootNode == nullptr || (scene->mFlags & AI_SCENE_FLAGS_INCOMPLETE) != 0)
            fail(name, ": has no complete mesh");
        for (unsigned i = 0; i < scene->mNumMeshes; ++i) checkMesh(*scene->mMeshes[i], name);
        scene = importer.ApplyPostProcessing(aiProcess_Triangulate);
        if (scene == nullptr) fail(name, ": cannot be triangulated: ", std::string_view(importer.GetErrorString()));
        appendNodes(*scene, name, soup);
    } catch (const Error&) {
        throw;
    } catch (const std::exception& problem) { // also out of memory
        fail(name, ": cannot be read: ", std::string_view(problem.what()));
    }
    return soup;
}

} // namespace

TriangleMesh readWithAssimp(const std::filesystem::path& file, const std::optional<std::string>& text)
{
    const std::string name = file.string();
    const Soup soup = readSoup(file, text);
    if (soup.mesh.triangles.empty()) fail(name, ": must have at least 1 triangle, got 0");
    std::size_t dropped = 0;
    TriangleMesh mesh = joined(soup, dropped);
    if (dropped > 0) logWarning(name, ": dropped ", dropped, " triangles with two corners at the same place");
    if (soup.notTriangles > 0) logWarning(name, ": dropped ", soup.notTriangles, " points and lines");
    if (soup.anyUv && soup.anyWithout) logWarning(name, ": a part without texture coordinates gets (0, 0)");
    check(mesh, name);
    return mesh;
}

} // namespace filasofia::geometry
