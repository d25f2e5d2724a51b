#pragma once

#include "filasofia/core/error.h"
#include "filasofia/core/log.h"
#include "filasofia/geometry/surface.h"
#include "filasofia/geometry/tet_mesh.h"

#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <random>
#include <stdexcept>
#include <string>

namespace filasofia::geometry {

/// Collects the log while it exists.
struct LogTrap {
    std::string lines, warnings; ///< all; those that are no information
    LogTrap()
    {
        setLogSink([this](LogLevel level, std::string_view line) {
            lines += text(line, "\n");
            if (level != LogLevel::Info) warnings += text(line, "\n");
        });
    }
    ~LogTrap() { setLogSink({}); }
};

/// The unit tetrahedron: a right corner at the origin; volume 1/6.
inline TetMesh unitTetrahedron() { return {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 1, 2, 3}}}; }

/// A cube of n^3 cells with edge 1, each of six tetrahedra around its diagonal (Kuhn); nodes inside are moved a little.
inline TetMesh cubeMesh(int n, unsigned seed, double jitter = 0.15)
{
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> shift(-jitter / n, jitter / n);
    TetMesh mesh;
    const auto nodeAt = [n](int i, int j, int k) { return (i * (n + 1) + j) * (n + 1) + k; };
    for (int i = 0; i <= n; ++i)
        for (int j = 0; j <= n; ++j)
            for (int k = 0; k <= n; ++k) {
                Vec3 p{double(i) / n, double(j) / n, double(k) / n};
                if (i % n != 0 && j % n != 0 && k % n != 0) p += {shift(random), shift(random), shift(random)};
                mesh.nodes.push_back(p);
            }
    constexpr int kOrders[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j)
            for (int k = 0; k < n; ++k)
                for (const auto& order : kOrders) {
                    std::array<int, 3> at{i, j, k};
                    Tetrahedron t{nodeAt(i, j, k)};
                    for (int step = 0; step < 3; ++step) {
                        ++at[order[step]];
                        t[step + 1] = nodeAt(at[0], at[1], at[2]);
                    }
                    const auto [a, b, c, d] = t;
                    if (signedVolume(mesh.nodes[a], mesh.nodes[b], mesh.nodes[c], mesh.nodes[d]) < 0)
                        std::swap(t[2], t[3]);
                    mesh.tetrahedra.push_back(t);
                }
    return mesh;
}

inline double volumeOf(const TetMesh& mesh)
{
    double sum = 0.0;
    for (int t = 0; t < static_cast<int>(mesh.tetrahedra.size()); ++t) sum += signedVolume(mesh, t);
    return sum;
}

/// The volume inside a closed surface, by the divergence theorem.
inline double volumeInside(const TriangleMesh& mesh)
{
    double sum = 0.0;
    for (auto [a, b, c] : mesh.triangles) sum += dot(mesh.vertices[a], cross(mesh.vertices[b], mesh.vertices[c])) / 6.0;
    return sum;
}

/// True if every edge is traversed exactly once in each direction.
inline bool isClosedManifold(const TriangleMesh& mesh)
{
    std::vector<std::array<int, 2>> there, back;
    for (const Triangle& t : mesh.triangles)
        for (int k = 0; k < 3; ++k) {
            there.push_back({t[k], t[(k + 1) % 3]});
            back.push_back({t[(k + 1) % 3], t[k]});
        }
    std::sort(there.begin(), there.end());
    std::sort(back.begin(), back.end());
    return there == back && std::adjacent_find(there.begin(), there.end()) == there.end();
}

inline Vec3 randomPoint(std::mt19937& random, double low, double high)
{
    std::uniform_real_distribution<double> number(low, high);
    const double x = number(random), y = number(random);
    return {x, y, number(random)};
}

/// The text with its first `from`, which must be in it, replaced.
inline std::string replaced(std::string text, std::string_view from, std::string_view to)
{
    const std::size_t at = text.find(from);
    if (at == std::string::npos) throw std::logic_error("nothing to replace");
    return text.replace(at, from.size(), to);
}

/// The message of the Error that `action` throws; empty if it throws none.
template <class Action> std::string errorOf(Action&& action)
{
    try {
        action();
    } catch (const Error& error) {
        return error.what();
    }
    return {};
}

/// A file that exists as long as this object.
class TemporaryFile {
public:
    TemporaryFile(const std::string& name, std::string_view bytes)
        : path_(std::filesystem::path(FILASOFIA_BINARY_DIR) / "test_files" / std::to_string(getpid()) / name)
    {
        std::filesystem::create_directories(path_.parent_path());
        std::ofstream(path_, std::ios::binary) << bytes;
    }
    ~TemporaryFile()
    {
        std::filesystem::remove(path_);
        std::error_code filled; // the directory may hold another file of this test
        std::filesystem::remove(path_.parent_path(), filled);
    }
    TemporaryFile(const TemporaryFile&) = delete;
    TemporaryFile& operator=(const TemporaryFile&) = delete;
    [[nodiscard]] const std::filesystem::path& path() const { return path_; }

private:
    std::filesystem::path path_;
};

/// A cube of n cells per edge with two labels.
inline TetMesh labelledCube(int n)
{
    TetMesh mesh = cubeMesh(n, 1);
    for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t) mesh.labels.push_back(t % 3 == 0 ? 12 : 5);
    return mesh;
}

/// Cuts a file off at every byte, and changes bytes at random: `parse` must return a mesh that passes check(), or throw
/// an Error that names the file.
template <class Parse> void damage(const std::string& whole, std::string_view name, const Parse& parse)
{
    const auto attempt = [&](const std::string& bytes) {
        try {
            check(parse(bytes), "what was read");
        } catch (const Error& error) {
            if (!Catch::contains(error.what(), std::string(name))) FAIL(error.what());
        }
    };
    for (std::size_t length = 0; length < whole.size(); ++length) attempt(whole.substr(0, length));
    std::mt19937 random(1);
    for (int i = 0; i < 2000; ++i) {
        std::string wrong = whole;
        wrong[random() % wrong.size()] = static_cast<char>(random());
        attempt(wrong);
    }
}

} // namespace filasofia::geometry
