#include "filasofia/core/error.h"
#include "filasofia/core/log.h"
#include "filasofia/scene/import.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

namespace {

void write(const std::filesystem::path& file, std::string_view words)
{
    std::ofstream(file, std::ios::binary).write(words.data(), static_cast<long>(words.size()));
}

constexpr std::string_view kMeshRobot =
    "<robot><link name='a'><visual><geometry><mesh filename='mesh.dae'/></geometry></visual></link></robot>";

/// A folder with files that the input may name.
std::filesystem::path makeFolder()
{
    const auto made = std::filesystem::path("/dev/shm") / ("filasofia_import_fuzz_" + std::to_string(getpid()));
    std::filesystem::create_directories(made);
    write(made / "part.xml", "<mujoco><worldbody><geom size='1'/></worldbody></mujoco>");
    write(made / "loop.xml", "<mujoco><include file='model.xml'/></mujoco>");
    write(made / "mesh.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n");
    return made;
}

/// What is read must be finite, and its meshes must name their own nodes.
void check(const filasofia::scene::SceneDef& scene)
{
    using namespace filasofia;
    for (const scene::SceneBody& each : scene.bodies) {
        physics::check(each.def);
        const auto* soft = std::get_if<physics::SoftBodyDef>(&each.def);
        if (const auto* tets = soft ? std::get_if<std::shared_ptr<const geometry::TetMesh>>(&soft->mesh) : nullptr)
            for (const geometry::Tetrahedron& element : (*tets)->tetrahedra)
                for (const int node : element)
                    if (node < 0 || node >= static_cast<int>((*tets)->nodes.size())) std::abort();
        for (const runtime::ShowDef& show : each.show)
            if (const auto* mesh = std::get_if<std::shared_ptr<const geometry::TriangleMesh>>(&show.surface))
                if (*mesh)
                    for (const Vec3& vertex : (*mesh)->vertices)
                        if (!isFinite(vertex)) std::abort();
    }
}

} // namespace

// The input is a robot, a model of MuJoCo, a scene of SOFA or a mesh in Collada, whichever its first element says.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
    using namespace filasofia;
    setLogSink([](LogLevel, std::string_view) {});
    static const std::filesystem::path folder = makeFolder();
    const std::string_view words(reinterpret_cast<const char*>(data), size);
    const bool mesh = words.starts_with("<COLLADA"); // a mesh in that format, and a robot of it
    const bool robot = mesh || words.find("<robot") < words.find("<mujoco");
    const bool sofa = !mesh && words.find("<Node") < std::min(words.find("<robot"), words.find("<mujoco"));
    const std::filesystem::path file = folder / "model.xml";
    if (mesh) write(folder / "mesh.dae", words);
    write(file, mesh ? kMeshRobot : words);
    try {
        check((sofa ? scene::loadScn(file) : robot ? scene::loadUrdf(file) : scene::loadMjcf(file)).scene);
    } catch (const Error&) {
    }
    return 0;
}
